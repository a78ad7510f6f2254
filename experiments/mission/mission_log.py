"""Attachments of a closed-loop flight's log: mission and plans."""

import json
from dataclasses import dataclass, replace

from flight.errors import BadFileError
from flight.file_value import FileValue
from flight.plan.plan import Plan, plan_text, with_mission
from flight.schema import json_content, parse_json
from flightlog.attachment_names import MISSION_ATTACHMENT, PLANS_ATTACHMENT
from flightlog.identity.flight_identity import flight_identity
from flightlog.log import FlightLog
from flightlog.mission_attachments import LoggedPlan, logged_plannings, plannings_text
from planner.closed_loop.flight_record import FlightRecord
from planner.closed_loop.latency import Latency
from planner.closed_loop.settings import Settings
from planner.kernel.build import SEARCH_BACKEND
from sim.flight_header import flight_attachments, flight_header
from sim.loop.backend import Backend
from sim.loop.specification import DEFAULT_ALTITUDE, FlightSpecification, specified_pose
from sim.vehicle.parameters import read_parameters

from .mission_task import MissionTask
from .policies import FlownPolicy


def mission_specification(task: MissionTask) -> FlightSpecification:
    """Returns the flight specification of a mission, without its planner."""
    mission = task.mission
    return FlightSpecification(
        kind="mission",
        name=mission.name,
        seed=task.seed,
        wind=task.wind,
        altitude=task.library.conditions.altitude or DEFAULT_ALTITUDE,
        start=specified_pose(mission.start),
        start_trim=mission.start_trim,
    ).with_options(task.flight_options)


def mission_identity(task: MissionTask) -> dict[str, str]:
    """Returns the identity of a mission's flight."""
    specification, parameters = mission_specification(task), read_parameters()
    header = flight_header(specification, parameters, backend=Backend.INTERPRETED)
    inputs = flight_attachments(specification, task.library, parameters)
    return flight_identity(
        header.with_search_backend(SEARCH_BACKEND), {**inputs, MISSION_ATTACHMENT: mission_json(task)}
    )


@dataclass(frozen=True, slots=True)
class PlanningSettings(FileValue):
    """Planner and loop settings of a flight, logged beside its mission.

    Attributes:
        policy: planning policy.
        gamma: uncertainty level of the worst-case policy.
        max_nodes: limit of each replan in walks solved at one gamma; None without a limit.
        settings: settings of the closed loop. Recorded latencies of a repeated flight are left out: the
            applied ones are logged with the plans, so that a flight and its repetition have the same log.
    """

    policy: FlownPolicy
    gamma: float
    max_nodes: int | None
    settings: Settings


def mission_json(task: MissionTask) -> bytes:
    """Returns mission, planner and loop settings as JSON."""
    settings = replace(task.settings, latency=replace(task.settings.latency, recorded=None))
    logged = PlanningSettings(task.policy, task.gamma, task.max_nodes, settings)
    content = json_content(task.mission, exclude_none=False) | json_content(logged, exclude_none=False)
    return json.dumps(content, indent=1).encode()


def mission_plan_json(task: MissionTask, plan: Plan) -> bytes:
    """Returns the plan for the mission as stated, without its solve time."""
    return plan_text(with_mission(replace(plan, solve_time=0.0), task.stated_mission)).encode()


def plans_json(flown: FlightRecord) -> bytes:
    """Returns the plans with their times and applied latencies as JSON.

    Measured solve times would differ in a repetition, so only applied latencies are stored.
    """
    plans = [replace(plan, solve_time=0.0) for plan in flown.plans]
    return plannings_text(list(map(LoggedPlan, flown.times, flown.latencies, plans)))


def recorded_latency(log: FlightLog, *, source: str) -> Latency:
    """Returns the latencies of a logged flight, for a repetition.

    Raises:
        BadFileError: the log has no mission with settings, or no plans with latencies.
    """
    for name in (MISSION_ATTACHMENT, PLANS_ATTACHMENT):
        if name not in log.attachments:
            raise BadFileError(source, f"expected the log of a mission's flight, got one without {name}")
    logged = parse_json(
        log.attachments[MISSION_ATTACHMENT], MISSION_ATTACHMENT, PlanningSettings, extra="ignore"
    )
    recorded = tuple(planning.latency for planning in logged_plannings(log))
    return replace(logged.settings.latency, recorded=recorded)
