"""Logs with topics or attachments changed, added or removed."""

import json
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flight.mission.mission import Mission
from flight.plan.plan import Plan, Scenario
from flight.schema import json_content
from flight.se2 import SE2
from flightlog.attachment_names import MISSION_ATTACHMENT, PLANS_ATTACHMENT
from flightlog.log import FlightLog
from flightlog.mission_attachments import LoggedPlan, plannings_text
from flightlog.series import Topic


def with_changed_topic(
    log: FlightLog, topic: Topic, change: Callable[[NDArray[np.float64]], None]
) -> FlightLog:
    """Returns the log with the values of a topic changed in place."""
    values = log[topic].values.copy()
    change(values)
    return replace(log, series={**log.series, topic.name: replace(log[topic], values=values)})


def with_added_offset(log: FlightLog, topic: Topic, field: str, amount: float) -> FlightLog:
    def change(values: NDArray[np.float64]) -> None:
        values[:, topic.field_names.index(field)] += amount

    return with_changed_topic(log, topic, change)


def with_attachment(log: FlightLog, name: str, content: object) -> FlightLog:
    return replace(log, attachments={**log.attachments, name: json.dumps(content).encode()})


def without_topics(log: FlightLog, *topics: Topic) -> FlightLog:
    gone = {topic.name for topic in topics}
    return replace(log, series={name: part for name, part in log.series.items() if name not in gone})


def bound_for(
    log: FlightLog, goal: tuple[float, float], tolerance: float, **settings: float | None
) -> FlightLog:
    """Returns the log as one of a mission, with these settings of its loop."""
    mission = Mission("there", SE2.identity(), 1, goal, tolerance)
    content = json_content(mission, exclude_none=False) | {"settings": settings}
    return with_attachment(log, MISSION_ATTACHMENT, content)


def planned(log: FlightLog, plannings: Sequence[LoggedPlan]) -> FlightLog:
    return replace(log, attachments={**log.attachments, PLANS_ATTACHMENT: plannings_text(plannings)})


def planning(
    time: float,
    trims: tuple[int, ...] = (),
    coasting_times: tuple[float, ...] = (),
    *,
    gammas: tuple[float, ...] = (),
    cost: float = 20.0,
    reason: str = "",
) -> LoggedPlan:
    """Returns an answer at a time: a walk at some levels, slower by a second a level, or none."""
    plan = Plan(
        status="feasible" if gammas else "infeasible",
        reason=reason,
        library="synthetic",
        library_hash="",
        mission="there",
        policy="worst-case",
        gamma=max(map(abs, gammas), default=1.0),
        tolerance=2.0,
        sequence=trims,
        scenarios=tuple(Scenario(gamma, cost - gamma, coasting_times, SE2.identity()) for gamma in gammas),
    )
    return LoggedPlan(time, 0.05, plan)
