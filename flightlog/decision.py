"""Decisions of the receding horizon, a topic of the flight log."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from math import isfinite

import numpy as np

from .series import Field, Series, Topic


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
            "0 plan adopted, 1 current plan kept, 2 no plan found, 3 plan too late, 4 plan failed its check, "
            "5 safe stop begun, 6 arrival declared by the vehicle, 7 mission ended by an alarm",
        ),
        Field("activation", "-", "number of the replan, from 1"),
        Field("cost", "s", "predicted time of the plan from its start; 0 without a plan"),
        Field("latency", "s", "planning time charged to the flight"),
        Field("tolerance", "m", "goal tolerance given to the planner"),
        Field("level", "-", "gamma of the coasting times flown"),
    ),
)


@dataclass(frozen=True, slots=True)
class Decision:
    """One decision: time in seconds, kind, and the numbers of `/decision`."""

    time: float
    kind: DecisionKind
    activation: int
    cost: float
    latency: float
    tolerance: float
    level: float


def decision_series(decisions: Sequence[Decision]) -> Series:
    """Returns decisions, in the order of their times, as messages."""
    rows = [
        (d.kind, d.activation, d.cost if isfinite(d.cost) else 0.0, d.latency, d.tolerance, d.level)
        for d in decisions
    ]
    values = np.array(rows, dtype=np.float64).reshape(len(rows), len(DECISION.fields))
    return Series(DECISION, np.array([d.time for d in decisions], dtype=np.float64), values)
