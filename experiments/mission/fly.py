"""Closed-loop mission flights for `fly`, `validate` and `demo`."""

import hashlib
from collections.abc import Iterator
from dataclasses import replace
from math import isfinite

import numpy as np

from experiments.campaign.fly_campaign import derived_seed
from flight.automaton.library import Library
from flightlog.alarm import ALARM, Alarm, alarms_from_series
from flightlog.arrival import arrival_text
from flightlog.attachment_names import (
    ARRIVAL_ATTACHMENT,
    MISSION_ATTACHMENT,
)
from flightlog.decision import DECISION, decision_series
from flightlog.fault_record import fault_effects
from flightlog.file.writer import write_log
from flightlog.log import FlightLog
from planner.closed_loop.automaton_vehicle import AutomatonVehicle, independent_gammas
from planner.closed_loop.flight_record import FlightRecord
from planner.closed_loop.joint_law_vehicle import JointLawVehicle
from planner.closed_loop.tube import tube_exit_time
from planner.kernel.build import SEARCH_BACKEND
from sim.loop.backend import Backend
from sim.simulated_helicopter import SimulatedHelicopter
from sim.vehicle.parameters import Parameters

from .error_attribution import Performance, performances
from .flight_rule import FlightRule, flight_rule
from .mission_log import mission_json, mission_specification
from .mission_task import MissionTask, Plant
from .result import MissionResult, downsample_leg
from .safe_envelope import EnvelopeExit, first_exit
from .sensor_tolerance import check_tolerance

# Distinct from the stream keys of `fly_campaign`.
_MISSION_STREAM = 102
_GAMMA_STREAM = 103
_LAW_STREAM = 111

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
    rule = flight_rule(task)
    if task.plant == "helicopter":
        flown, log = fly_helicopter(task, rule)
        flown_primitives, left = performances(log), first_exit(log, task.envelope)
        alarms = alarms_from_series(log[ALARM]) if ALARM.name in log.series else ()
        effects = fault_effects(log)
        left_tube = tuple((share, _left_tube(task.library, flown, share)) for share in TUBES)
    else:
        flown = fly_automaton(task, rule)
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
        planned_time=rule.planned_time,
        predicted_time=flown.predicted_time if isfinite(flown.predicted_time) else None,
        closest=flown.closest if isfinite(flown.closest) else None,
        replans=flown.replans,
        failures=flown.failures,
        safe_stops=flown.safe_stops,
        reason=flown.reason,
        log=task.log,
        planning_times=rule.planning_times,
        performances=flown_primitives,
        legs=tuple(downsample_leg(step, leg) for step, leg in zip(flown.steps, flown.legs, strict=True)),
        alarms=alarms,
        left=left,
        effects=effects,
        left_tube=left_tube,
    )
    return result, log


def plant_name(plant: Plant) -> str:
    """Returns the name of a plant."""
    return plant if isinstance(plant, str) else f"gamma {plant:+g}"


def fly_automaton(task: MissionTask, rule: FlightRule | None = None) -> FlightRecord:
    """Flies a mission by the automaton: errors (thesis, chapter 7) or laws."""
    mission = task.mission
    if task.plant == "law":
        rng = np.random.default_rng(np.random.SeedSequence(task.seed, spawn_key=(_LAW_STREAM,)))
        flown = JointLawVehicle(task.library, start=mission.start, trim=mission.start_trim, rng=rng)
        return (rule or flight_rule(task)).fly(flown)
    gamma: float | Iterator[float]
    if isinstance(task.plant, float):
        gamma = task.plant
    else:
        rng = np.random.default_rng(np.random.SeedSequence(task.seed, spawn_key=(_GAMMA_STREAM,)))
        gamma = independent_gammas(rng)
    vehicle = AutomatonVehicle(task.library, start=mission.start, trim=mission.start_trim, gamma=gamma)
    return (rule or flight_rule(task)).fly(vehicle)


def fly_helicopter(
    task: MissionTask,
    rule: FlightRule | None = None,
    *,
    parameters: Parameters | None = None,
    backend: Backend | None = None,
) -> tuple[FlightRecord, FlightLog]:
    """Flies a mission by the simulated helicopter; returns record and log.

    Args:
        task: the flight.
        rule: how it is flown; made of the task where None.
        parameters: vehicle parameters; those of `models/gtmax.toml` where None.
        backend: backend of the vehicle's expressions; the best available where None.
    """
    mission = task.mission
    task.library.trim(mission.start_trim)
    specification = mission_specification(task)
    helicopter = SimulatedHelicopter(specification, task.library, parameters=parameters, backend=backend)
    rule = rule or flight_rule(task)
    flown = rule.fly(helicopter)
    log = helicopter.log(
        {
            MISSION_ATTACHMENT: mission_json(task),
            **rule.attachments(flown),
            ARRIVAL_ATTACHMENT: arrival_text(flown.arrival),
        }
    )
    series = {**log.series, DECISION.name: decision_series(flown.decisions)}
    return flown, replace(log, header=log.header.with_search_backend(SEARCH_BACKEND), series=series)


def _left_tube(library: Library, flown: FlightRecord, share: float) -> float | None:
    return tube_exit_time(library, flown.steps, flown.legs, flown.times, share=share)
