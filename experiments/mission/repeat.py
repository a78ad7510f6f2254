"""Repetition of a logged flight from the log's attachments."""

from dataclasses import replace

from flight.errors import BadFileError, FlightError
from flight.mission.mission import Mission
from flight.plan.policy_statement import PolicyStatement
from flight.schema import parse_json
from flightlog.attachment_names import (
    MISSION_ATTACHMENT,
    POLICY_ATTACHMENT,
    SPECIFICATION_ATTACHMENT,
    VEHICLE_ATTACHMENT,
)
from flightlog.log import FlightLog
from planner.kernel.build import SEARCH_BACKEND
from planner.recourse.statement import feedback_policy
from sim.campaign_flight import fly_specification
from sim.loop.backend import Backend
from sim.loop.specification import FlightSpecification, parse_specification
from sim.replay import VehicleMismatchError, backend_named, check_air_matches, check_vehicle_matches
from sim.vehicle.parameters import Parameters, parse_parameters

from .fly import fly_helicopter
from .mission_log import PlanningSettings, mission_specification, recorded_latency
from .mission_task import MissionTask


def repeat_flight(log: FlightLog) -> FlightLog:
    """Repeats a logged flight with the log's vehicle and numeric back-end.

    Planning latencies are an input: those of the log are applied again.

    Raises:
        VehicleMismatchError: the vehicle or the back-end of the log is not available.
        FlightError: the log is not of this program's simulator, or lacks something.
    """
    for name in (SPECIFICATION_ATTACHMENT, VEHICLE_ATTACHMENT):
        if name not in log.attachments:
            raise FlightError(
                f"expected a log of this program's simulator with {name}, got one of kind "
                f"{log.header.kind!r} without it"
            )
    check_vehicle_matches(log)
    backend = backend_named(log.header.vehicle_backend)
    specification = parse_specification(log.attachments[SPECIFICATION_ATTACHMENT], SPECIFICATION_ATTACHMENT)
    check_air_matches(log, specification)
    parameters = parse_parameters(log.attachments[VEHICLE_ATTACHMENT], VEHICLE_ATTACHMENT)
    if MISSION_ATTACHMENT in log.attachments:
        return _fly_mission(log, specification, parameters, backend)
    return fly_specification(specification, log.library(), parameters=parameters, backend=backend)


def _fly_mission(
    log: FlightLog, specification: FlightSpecification, parameters: Parameters, backend: Backend
) -> FlightLog:
    task = mission_task(log, specification)
    if log.header.search_backend != SEARCH_BACKEND:
        raise VehicleMismatchError("search for plans", log.header.search_backend or "unnamed", SEARCH_BACKEND)
    if mission_specification(task) != specification:
        raise BadFileError(
            SPECIFICATION_ATTACHMENT,
            f"expected the flight of the mission in {MISSION_ATTACHMENT}, got another",
        )
    if POLICY_ATTACHMENT in log.attachments:
        _check_table(log, task)
    return fly_helicopter(task, parameters=parameters, backend=backend)[1]


def _check_table(log: FlightLog, task: MissionTask) -> None:
    """Checks that the table of costs is the one flown with."""
    text = log.attachments[POLICY_ATTACHMENT]
    flown = parse_json(text, POLICY_ATTACHMENT, PolicyStatement)
    made = feedback_policy(task.library, task.stated_mission).table.digest
    if flown.table != made:
        raise VehicleMismatchError("table of costs", flown.table, made)


def mission_task(log: FlightLog, specification: FlightSpecification) -> MissionTask:
    """Returns the closed-loop flight of a log.

    Raises:
        BadFileError: the log's description of it is broken.
    """
    text = log.attachments[MISSION_ATTACHMENT]
    mission = parse_json(text, MISSION_ATTACHMENT, Mission, extra="ignore")
    logged = parse_json(text, MISSION_ATTACHMENT, PlanningSettings, extra="ignore")
    settings = logged.settings
    if settings.latency.measured:
        settings = replace(settings, latency=recorded_latency(log, source=MISSION_ATTACHMENT))
    return MissionTask(
        mission=mission,
        library=log.library(),
        policy=logged.policy,
        gamma=logged.gamma,
        wind=specification.wind,
        seed=specification.seed,
        settings=settings,
        max_nodes=logged.max_nodes,
        flight_options=specification.flight_options,
    )
