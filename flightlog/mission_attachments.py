"""Mission and plans of a closed-loop flight, from its attachments."""

import json
from dataclasses import dataclass
from math import pi
from typing import TypeVar

from pydantic import BaseModel, ConfigDict, FiniteFloat, NonNegativeFloat, TypeAdapter, ValidationError

from flight.errors import BadFileError
from flight.mission.destination import Destination
from flight.schema import first_problem
from flight.se2 import SE2

from .attachment_names import MISSION_ATTACHMENT, PLANS_ATTACHMENT, SPECIFICATION_ATTACHMENT
from .log import FlightLog

Content = TypeVar("Content")


@dataclass(frozen=True, slots=True)
class LoggedPlan:
    """One plan of a receding-horizon flight.

    Attributes:
        time: time of the plan, seconds since the flight's start.
        gamma: gamma of the slowest scenario.
        cost: duration of the slowest scenario, seconds.
        sequence: trim ids.
        coasting_times: coasting times of the slowest scenario, seconds.
        policy: policy of the planner; empty if not logged.
        status: status of the plan; empty if not logged.
        level: gamma planned for; 0 for a nominal plan.
    """

    time: float
    gamma: float
    cost: float
    sequence: tuple[int, ...]
    coasting_times: tuple[float, ...]
    policy: str = ""
    status: str = ""
    level: float = 0.0


@dataclass(frozen=True, slots=True)
class FailedPlanning:
    """Replan without a plan: time and reason."""

    time: float
    reason: str


@dataclass(frozen=True, slots=True)
class LoggedSequence:
    """Sequence to fly: trim ids, coasting times, start pose, height."""

    trims: tuple[int, ...]
    coasting_times: tuple[float, ...]
    start: SE2
    altitude: float


class _Part(BaseModel):
    """Part of an attachment; other keys are ignored."""

    model_config = ConfigDict(extra="ignore", frozen=True, allow_inf_nan=False)


class _Settings(_Part):
    final_tolerance: NonNegativeFloat | None = None


class _Mission(_Part):
    goal: tuple[FiniteFloat, FiniteFloat]
    tolerance: NonNegativeFloat
    goal_heading: FiniteFloat | None = None
    heading_tolerance: NonNegativeFloat = pi
    settings: _Settings = _Settings()


class _Scenario(_Part):
    gamma: FiniteFloat
    cost: FiniteFloat
    coasting_times: tuple[NonNegativeFloat, ...]


class _Plan(_Part):
    time: NonNegativeFloat
    sequence: tuple[int, ...] = ()
    scenarios: tuple[_Scenario, ...] = ()
    policy: str = ""
    status: str = ""
    reason: str | None = None
    gamma: FiniteFloat = 0.0


class _Pose(_Part):
    north: FiniteFloat = 0.0
    east: FiniteFloat = 0.0
    heading: FiniteFloat = 0.0


class _Specification(_Part):
    trims: tuple[int, ...] = ()
    coasting_times: tuple[NonNegativeFloat, ...] = ()
    start: _Pose = _Pose()
    altitude: FiniteFloat = 0.0


def logged_sequence(log: FlightLog) -> LoggedSequence | None:
    """Returns the specified sequence; None if the log has none.

    Raises:
        BadFileError: the attachment is invalid.
    """
    flight = _attachment(log, SPECIFICATION_ATTACHMENT, TypeAdapter(_Specification))
    if flight is None or not flight.trims:
        return None
    start = SE2(flight.start.north, flight.start.east, flight.start.heading)
    return LoggedSequence(flight.trims, flight.coasting_times, start, flight.altitude)


def logged_goal(log: FlightLog) -> Destination | None:
    """Returns the goal of a flight; None if the log has none.

    Raises:
        BadFileError: the attachment is invalid.
    """
    mission = _attachment(log, MISSION_ATTACHMENT, TypeAdapter(_Mission))
    if mission is None:
        return None
    # The tolerance of the closed loop overrides that of the mission's file.
    tolerance = mission.settings.final_tolerance or mission.tolerance
    return Destination(mission.goal, tolerance, mission.goal_heading, mission.heading_tolerance)


def logged_plans(log: FlightLog) -> tuple[LoggedPlan, ...]:
    """Returns the plans with scenarios, in order.

    Raises:
        BadFileError: the attachment is invalid.
    """
    return tuple(plan for plan in logged_plannings(log) if isinstance(plan, LoggedPlan))


def logged_plannings(log: FlightLog) -> tuple[LoggedPlan | FailedPlanning, ...]:
    """Returns all replans in order, with or without a plan.

    Raises:
        BadFileError: the attachment is invalid.
    """
    plans = _attachment(log, PLANS_ATTACHMENT, TypeAdapter(tuple[_Plan, ...])) or ()
    return tuple(
        _deciding_plan(plan)
        if plan.scenarios
        else FailedPlanning(plan.time, plan.reason or "no reason given")
        for plan in plans
    )


def _deciding_plan(plan: _Plan) -> LoggedPlan:
    scenario = max(plan.scenarios, key=lambda scenario: scenario.cost)
    return LoggedPlan(
        time=plan.time,
        gamma=scenario.gamma,
        cost=scenario.cost,
        sequence=plan.sequence,
        coasting_times=scenario.coasting_times,
        policy=plan.policy,
        status=plan.status,
        level=plan.gamma if any(part.gamma for part in plan.scenarios) else 0.0,
    )


def _attachment(log: FlightLog, name: str, content: TypeAdapter[Content]) -> Content | None:
    if name not in log.attachments:
        return None
    try:
        return content.validate_python(json.loads(log.attachments[name]))
    except ValidationError as error:
        raise BadFileError(name, first_problem(error)) from None
    except ValueError as error:
        raise BadFileError(name, f"is not JSON: {error}") from None
