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
    OVERDUE = 8


DECISION = Topic(
    "/decision",
    "maneuver.Decision",
    "one message at every decision of the receding horizon",
    (
        Field(
            "kind",
            "-",
            "0 plan adopted, 1 current plan kept, 2 no plan found, 3 plan too late, 4 plan failed its check, "
            "5 safe stop begun, 6 arrival declared by the vehicle, 7 mission ended by an alarm, "
            "8 stated 99.9 % time of the policy with feedback exceeded, nominal plans from here",
        ),
        Field("activation", "-", "number of the replan, from 1"),
        Field("cost", "s", "predicted time of the plan from its start; 0 without a plan"),
        Field("latency", "s", "planning time charged to the flight"),
        Field("tolerance", "m", "goal tolerance given to the planner"),
        Field("level", "-", "gamma of the coasting times flown"),
        Field(
            "choice", "-", "maneuver that the policy with feedback performs; 0 for a coast or another policy"
        ),
        Field("runner_up", "-", "maneuver that would have been second best; 0 for a coast or another policy"),
        Field("runner_up_cost", "s", "expected time by it; 0 where there is none"),
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
    choice: int = 0
    runner_up: int = 0
    runner_up_cost: float = 0.0


def decision_series(decisions: Sequence[Decision]) -> Series:
    """Returns decisions, in the order of their times, as messages."""
    rows = [
        (
            *(d.kind, d.activation, _finite(d.cost), d.latency, d.tolerance, d.level),
            *(d.choice, d.runner_up, _finite(d.runner_up_cost)),
        )
        for d in decisions
    ]
    values = np.array(rows, dtype=np.float64).reshape(len(rows), len(DECISION.fields))
    return Series(DECISION, np.array([d.time for d in decisions], dtype=np.float64), values)


def _finite(time: float) -> float:
    return time if isfinite(time) else 0.0
