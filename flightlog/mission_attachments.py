"""Mission and plans of a closed-loop flight, from its attachments."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

from pydantic import FiniteFloat, NonNegativeFloat

from flight.mission.destination import Destination
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from flight.schema import FileModel, json_content, parse_json
from flight.se2 import SE2

from .attachment_names import (
    MISSION_ATTACHMENT,
    MISSION_PLAN_ATTACHMENT,
    PLANS_ATTACHMENT,
    SPECIFICATION_ATTACHMENT,
)
from .log import FlightLog

Content = TypeVar("Content")


@dataclass(frozen=True, slots=True)
class LoggedPlan:
    """One planning of a receding-horizon flight.

    Attributes:
        time: seconds since the flight's start of the request.
        latency: seconds that it took, as charged.
        plan: its answer, which may be that there is none.
    """

    time: float
    latency: float
    plan: Plan


@dataclass(frozen=True, slots=True)
class LoggedSequence:
    """Sequence to fly: trim ids, coasting times, start pose, height."""

    trims: tuple[int, ...]
    coasting_times: tuple[float, ...]
    start: SE2
    altitude: float


class _LoggedPlanning(FileModel):
    time: NonNegativeFloat
    latency: NonNegativeFloat


class _Settings(FileModel):
    final_tolerance: NonNegativeFloat | None = None


class _Closed(FileModel):
    settings: _Settings = _Settings()


class _Pose(FileModel):
    north: FiniteFloat = 0.0
    east: FiniteFloat = 0.0
    heading: FiniteFloat = 0.0


class _Specification(FileModel):
    trims: tuple[int, ...] = ()
    coasting_times: tuple[NonNegativeFloat, ...] = ()
    start: _Pose = _Pose()
    altitude: FiniteFloat = 0.0


def logged_sequence(log: FlightLog) -> LoggedSequence | None:
    """Returns the specified sequence; None if the log has none.

    Raises:
        BadFileError: the attachment is invalid.
    """
    flight = _attached(log, SPECIFICATION_ATTACHMENT, _Specification)
    if flight is None or not flight.trims:
        return None
    start = SE2(flight.start.north, flight.start.east, flight.start.heading)
    return LoggedSequence(flight.trims, flight.coasting_times, start, flight.altitude)


def logged_goal(log: FlightLog) -> Destination | None:
    """Returns the goal of a flight; None if the log has none.

    Raises:
        BadFileError: the attachment is invalid.
    """
    mission = _attached(log, MISSION_ATTACHMENT, Mission)
    closed = _attached(log, MISSION_ATTACHMENT, _Closed)
    if mission is None or closed is None:
        return None
    # The settings of the loop come before those of the mission's file.
    return replace(mission.destination, tolerance=closed.settings.final_tolerance or mission.tolerance)


def logged_goal_trim(log: FlightLog) -> int | None:
    """Returns the id of the goal's trim; None for any trim.

    Raises:
        BadFileError: the attachment is there, but broken.
    """
    mission = _attached(log, MISSION_ATTACHMENT, Mission)
    return None if mission is None else mission.goal_trim


def logged_plans(log: FlightLog) -> tuple[LoggedPlan, ...]:
    """Returns the plans with scenarios, in order.

    Raises:
        BadFileError: the attachment is invalid.
    """
    return tuple(planning for planning in logged_plannings(log) if planning.plan.found)


def logged_plannings(log: FlightLog) -> tuple[LoggedPlan, ...]:
    """Returns all replans in order, with or without a plan.

    Raises:
        BadFileError: the attachment is invalid.
    """
    plannings = _attached(log, PLANS_ATTACHMENT, tuple[_LoggedPlanning, ...]) or ()
    plans = _attached(log, PLANS_ATTACHMENT, tuple[Plan, ...]) or ()
    return tuple(LoggedPlan(one.time, one.latency, plan) for one, plan in zip(plannings, plans, strict=True))


def logged_planned_time(log: FlightLog) -> float | None:
    """Returns the planned time in seconds; None without a plan.

    Raises:
        BadFileError: the attachment is there, but broken.
    """
    plan = _attached(log, MISSION_PLAN_ATTACHMENT, Plan)
    return None if plan is None or not plan.found else plan.cost


def plannings_text(plannings: Sequence[LoggedPlan]) -> bytes:
    """Returns the plannings of a flight as its log carries them."""
    content = [{"time": one.time, "latency": one.latency, **json_content(one.plan)} for one in plannings]
    return json.dumps(content, indent=1).encode()


def _attached(log: FlightLog, name: str, kind: type[Content]) -> Content | None:
    """Returns a value of one kind from an attachment; None without it.

    Raises:
        BadFileError: the attachment is there, but broken.
    """
    if name not in log.attachments:
        return None
    return parse_json(log.attachments[name], name, kind, extra="ignore")
