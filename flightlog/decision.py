"""What the receding horizon decided, and when: a topic of the flight log."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import isfinite

import numpy as np

from .topic import Field, Series, Topic


class DecisionKind(IntEnum):
    """Values of `/decision` `kind`."""

    ADOPTED = 0
    KEPT = 1
    FAILED = 2
    LATE = 3
    REFUSED = 4
    FALLBACK = 5
    ARRIVED = 6
    ALARM = 7


DECISION = Topic(
    "/decision",
    "maneuver.Decision",
    "one message at every decision of the receding horizon",
    (
        Field(
            "kind",
            "-",
            "0 plan adopted, 1 plan under way kept, 2 planning found no plan, 3 plan too late, 4 plan failed "
            "its check, 5 way to rest begun, 6 goal reached as far as the vehicle knows, 7 mission given up "
            "for an alarm",
        ),
        Field("activation", "-", "number of the planning, from 1"),
        Field("cost", "s", "promised by the plan from where it begins; 0 without one"),
        Field("latency", "s", "charged to the vehicle for thinking"),
        Field("tolerance", "m", "around the goal, that the planner was handed"),
        Field("level", "-", "uncertainty level whose coasting times are flown"),
    ),
)


@dataclass(frozen=True, slots=True)
class Decision:
    """One decision: seconds since the start, what kind, and the numbers of `/decision`."""

    time: float
    kind: DecisionKind
    activation: int
    cost: float
    latency: float
    tolerance: float
    level: float


def decision_series(decisions: Sequence[Decision]) -> Series:
    """Returns the decisions as a topic's messages; they come in the order of their times."""
    rows = [
        (d.kind, d.activation, d.cost if isfinite(d.cost) else 0.0, d.latency, d.tolerance, d.level)
        for d in decisions
    ]
    values = np.array(rows, dtype=np.float64).reshape(len(rows), len(DECISION.fields))
    return Series(DECISION, np.array([d.time for d in decisions], dtype=np.float64), values)
