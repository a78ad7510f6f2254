"""Closed-loop mission flights for `fly`, `validate` and `demo`."""

import hashlib
from collections.abc import Iterator
from dataclasses import replace
from math import isfinite

import numpy as np

from experiments.campaign.fly_campaign import derived_seed
from flight.automaton.library import Library
from flight.automaton.vehicle import Vehicle
from flight.plan.plan import Plan
from flightlog.alarm import ALARM, Alarm, alarms_from_series
from flightlog.arrival import arrival_text
from flightlog.attachment_names import (
    ARRIVAL_ATTACHMENT,
    MISSION_ATTACHMENT,
    MISSION_PLAN_ATTACHMENT,
    PLANS_ATTACHMENT,
)
from flightlog.decision import DECISION, decision_series
from flightlog.fault_record import fault_effects
from flightlog.file.writer import write_log
from flightlog.log import FlightLog
from planner.closed_loop.automaton_vehicle import AutomatonVehicle, independent_gammas
from planner.closed_loop.flight_record import FlightRecord
from planner.closed_loop.receding_horizon import fly_closed_loop
from planner.closed_loop.tube import tube_exit_time
from planner.kernel.build import SEARCH_BACKEND
from planner.policies.adaptive_gamma import AdaptiveGammaPlanner
from planner.policies.policy import Planner
from sim.loop.backend import Backend
from sim.simulated_helicopter import SimulatedHelicopter
from sim.vehicle.parameters import Parameters

from .error_attribution import Performance, performances
from .mission_log import mission_json, mission_plan_json, mission_specification, plans_json
from .mission_task import MissionTask, Plant
from .policies import planner_of
from .result import MissionResult, downsample_leg
from .safe_envelope import EnvelopeExit, first_exit
from .sensor_tolerance import check_tolerance
from .timed_planner import TimedPlanner

# Distinct from the stream keys of `fly_campaign`.
_MISSION_STREAM = 102
_GAMMA_STREAM = 103

TUBES = (1.0, 0.7)
"""Scales of the library's errors for tubes: the claim, and a control with smaller errors."""


def mission_seed(seed: int, mission: str, number: int) -> int:
    """Returns the seed of one flight of a mission.

    It differs from the seeds of campaigns and other missions; policies share it, so that they are compared in
    the same wind.
    """
    name = int.from_bytes(hashlib.sha256(mission.encode()).digest()[:4], "little")
    return derived_seed(seed, _MISSION_STREAM, name, number)


def fly_mission(task: MissionTask) -> MissionResult:
    """Flies a mission once and writes its log if requested."""
    result, log = fly_and_log(task)
    if log is not None and task.log is not None:
        write_log(log, task.log, force=task.force)
    return result


def fly_and_log(task: MissionTask) -> tuple[MissionResult, FlightLog | None]:
    """Flies a mission once; returns its result and the helicopter's log.

    Raises:
        ToleranceTooFineError: the sensors cannot tell the goal.
    """
    check_tolerance(task)
    flown_primitives: tuple[Performance, ...] = ()
    log: FlightLog | None = None
    alarms: tuple[Alarm, ...] = ()
    left: EnvelopeExit | None = None
    effects: tuple[float, ...] = ()
    left_tube: tuple[tuple[float, float | None], ...] = ()
    stated = plan_as_stated(task)
    planner = TimedPlanner(_planner(task), task.library)
    planner.warm_up(task.mission)
    if task.plant == "helicopter":
        flown, log = fly_helicopter(task, planner, stated=stated)
        flown_primitives, left = performances(log), first_exit(log, task.envelope)
        alarms = alarms_from_series(log[ALARM]) if ALARM.name in log.series else ()
        effects = fault_effects(log)
        left_tube = tuple((share, _left_tube(task.library, flown, share)) for share in TUBES)
    else:
        flown = fly_automaton(task, planner)
    result = MissionResult(
        mission=task.mission.name,
        policy=task.policy,
        gamma=task.gamma,
        plant=plant_name(task.plant),
        wind=task.wind,
        seed=task.seed,
        reached=flown.reached,
        claimed=flown.claimed,
        flown_time=flown.flown_time,
        planned_time=stated.cost if stated.found else None,
        predicted_time=flown.predicted_time if isfinite(flown.predicted_time) else None,
        closest=flown.closest if isfinite(flown.closest) else None,
        replans=flown.replans,
        failures=flown.failures,
        safe_stops=flown.safe_stops,
        reason=flown.reason,
        log=task.log,
        planning_times=tuple(planner.times),
        performances=flown_primitives,
        legs=tuple(downsample_leg(step, leg) for step, leg in zip(flown.steps, flown.legs, strict=True)),
        alarms=alarms,
        left=left,
        effects=effects,
        left_tube=left_tube,
    )
    return result, log


def plan_as_stated(task: MissionTask) -> Plan:
    """Returns the plan for the mission as stated, without latency."""
    return _planner(task).plan(task.stated_mission)


def plant_name(plant: Plant) -> str:
    """Returns the name of a plant."""
    return plant if isinstance(plant, str) else f"gamma {plant:+g}"


def fly_automaton(task: MissionTask, planner: Planner | None = None) -> FlightRecord:
    """Flies a mission by the automaton with its errors (thesis, chapter 7)."""
    mission = task.mission
    gamma: float | Iterator[float]
    if isinstance(task.plant, float):
        gamma = task.plant
    else:
        rng = np.random.default_rng(np.random.SeedSequence(task.seed, spawn_key=(_GAMMA_STREAM,)))
        gamma = independent_gammas(rng)
    vehicle = AutomatonVehicle(task.library, start=mission.start, trim=mission.start_trim, gamma=gamma)
    return _close_loop(vehicle, task, planner)


def fly_helicopter(
    task: MissionTask,
    planner: Planner | None = None,
    *,
    stated: Plan | None = None,
    parameters: Parameters | None = None,
    backend: Backend | None = None,
) -> tuple[FlightRecord, FlightLog]:
    """Flies a mission by the simulated helicopter; returns record and log.

    Args:
        task: the flight.
        planner: planner; that of the task where None.
        stated: plan for the mission as stated; made where None.
        parameters: vehicle parameters; those of `models/gtmax.toml` where None.
        backend: backend of the vehicle's expressions; the best available where None.
    """
    mission = task.mission
    task.library.trim(mission.start_trim)
    specification = mission_specification(task)
    helicopter = SimulatedHelicopter(specification, task.library, parameters=parameters, backend=backend)
    flown = _close_loop(helicopter, task, planner)
    log = helicopter.log(
        {
            MISSION_ATTACHMENT: mission_json(task),
            MISSION_PLAN_ATTACHMENT: mission_plan_json(task, stated or plan_as_stated(task)),
            PLANS_ATTACHMENT: plans_json(flown),
            ARRIVAL_ATTACHMENT: arrival_text(flown.arrival),
        }
    )
    series = {**log.series, DECISION.name: decision_series(flown.decisions)}
    return flown, replace(log, header=log.header.with_search_backend(SEARCH_BACKEND), series=series)


def _planner(task: MissionTask) -> Planner:
    return planner_of(task.policy, task.library, gamma=task.gamma, max_nodes=task.max_nodes)


def _close_loop(vehicle: Vehicle, task: MissionTask, planner: Planner | None) -> FlightRecord:
    planner = planner or _planner(task)
    learn = planner.learn if isinstance(planner, TimedPlanner | AdaptiveGammaPlanner) else None
    return fly_closed_loop(
        vehicle,
        task.mission,
        planner=planner,
        library=task.library,
        settings=task.settings,
        on_leg=learn,
    )


def _left_tube(library: Library, flown: FlightRecord, share: float) -> float | None:
    return tube_exit_time(library, flown.steps, flown.legs, flown.times, share=share)
