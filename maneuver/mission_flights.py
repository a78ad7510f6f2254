"""Missions flown in closed loop by the simulated helicopter: what `fly`, `validate` and `demo` share."""

import hashlib
import json
from dataclasses import asdict, dataclass, field, replace
from math import isfinite
from pathlib import Path
from typing import Literal

from flight.library import Library
from flight.log import MISSION_ATTACHMENT, PLANS_ATTACHMENT, FlightLog
from flight.log_file import publish_log
from flight.mission import Mission
from flight.plan import plan_content
from planner.automaton_vehicle import AutomatonVehicle
from planner.nominal import Nominal
from planner.policy import Planner
from planner.receding_horizon import Flown, Settings, fly
from planner.worst_case import WorstCase
from sim.fly import SimulatedHelicopter
from sim.specification import DEFAULT_ALTITUDE, PLAIN, Departure, FlightSpecification, pose

from .campaign_flights import derived_seed
from .policies import FlownPolicy

# Beside those of `campaign_flights`.
_MISSION_STREAM = 102

Plant = Literal["helicopter"] | float


@dataclass(frozen=True)
class MissionTask:
    """One closed-loop flight, completely.

    Attributes:
        mission: what is to be reached.
        library: planned with, and flown with.
        policy: which planner.
        gamma: uncertainty level of the worst-case planner.
        plant: what flies: `helicopter`, or the automaton at the true gamma given here.
        wind: wind class.
        seed: of all chance.
        settings: how the loop is closed.
        departure: of the helicopter's flight from the plain one.
        log: where the flight log goes; None keeps none.
        force: overwrite the log.
    """

    mission: Mission
    library: Library
    policy: FlownPolicy
    gamma: float
    wind: str
    seed: int
    plant: Plant = "helicopter"
    settings: Settings = field(default_factory=Settings)
    departure: Departure = PLAIN
    log: Path | None = None
    force: bool = False


@dataclass(frozen=True, slots=True)
class MissionResult:
    """What a closed-loop flight came to: `planner.receding_horizon.Flown` without plans and tracks."""

    mission: str
    policy: FlownPolicy
    wind: str
    seed: int
    reached: bool
    flown_time: float
    predicted_time: float | None
    closest: float | None
    activations: int
    failures: int
    reason: str
    log: Path | None


def mission_seed(seed: int, mission: str, number: int) -> int:
    """Returns the seed of one flight of a mission: other air than any campaign's, or other mission's.

    Policies are compared in the same air: they share it.
    """
    name = int.from_bytes(hashlib.sha256(mission.encode()).digest()[:4], "little")
    return derived_seed(seed, _MISSION_STREAM, name, number)


def fly_mission(task: MissionTask) -> MissionResult:
    """Flies a mission once, and keeps the helicopter's log where one is wanted."""
    if task.plant == "helicopter":
        flown, log = fly_helicopter(task)
        if task.log is not None:
            publish_log(log, task.log, force=task.force)
    else:
        flown = fly_automaton(task, task.plant)
    return MissionResult(
        mission=task.mission.name,
        policy=task.policy,
        wind=task.wind,
        seed=task.seed,
        reached=flown.reached,
        flown_time=flown.flown_time,
        predicted_time=flown.predicted_time if isfinite(flown.predicted_time) else None,
        closest=flown.closest if isfinite(flown.closest) else None,
        activations=flown.activations,
        failures=flown.failures,
        reason=flown.reason,
        log=task.log,
    )


def fly_automaton(task: MissionTask, true_gamma: float) -> Flown:
    """Flies a mission by the library's own model, moved by the library's own errors (thesis, chapter 7)."""
    mission = task.mission
    vehicle = AutomatonVehicle(task.library, start=mission.start, trim=mission.start_trim, gamma=true_gamma)
    planner = planner_of(task.policy, task.library, gamma=task.gamma)
    return fly(vehicle, mission, planner=planner, library=task.library, settings=task.settings)


def fly_helicopter(task: MissionTask) -> tuple[Flown, FlightLog]:
    """Flies a mission by the simulated helicopter, and returns what it came to with its log."""
    mission = task.mission
    task.library.trim(mission.start_trim)
    specification = FlightSpecification(
        kind="mission",
        name=mission.name,
        seed=task.seed,
        wind=task.wind,
        altitude=task.library.conditions.altitude or DEFAULT_ALTITUDE,
        start=pose(mission.start),
        start_trim=mission.start_trim,
    ).depart(task.departure)
    helicopter = SimulatedHelicopter(specification, task.library)
    planner = planner_of(task.policy, task.library, gamma=task.gamma)
    flown = fly(helicopter, mission, planner=planner, library=task.library, settings=task.settings)
    return flown, helicopter.log(
        {MISSION_ATTACHMENT: _mission_json(task), PLANS_ATTACHMENT: _plans_json(flown)}
    )


def planner_of(policy: FlownPolicy, library: Library, *, gamma: float) -> Planner:
    """Returns the planner of a policy for a library."""
    return Nominal(library) if policy == "nominal" else WorstCase(library, gamma)


def _mission_json(task: MissionTask) -> bytes:
    content = {
        **asdict(task.mission),
        "policy": task.policy,
        "gamma": task.gamma,
        "settings": asdict(task.settings),
    }
    return json.dumps(content, indent=1).encode()


def _plans_json(flown: Flown) -> bytes:
    """Plans with the time each was made; without the time each took, which would not repeat."""
    plans = [
        {"time": time, **plan_content(replace(plan, solve_time=0.0))}
        for time, plan in zip(flown.times, flown.plans, strict=True)
    ]
    return json.dumps(plans, indent=1).encode()
