"""What the log of a closed-loop flight carries beside the motion: what was asked, and what was planned."""

import json
from dataclasses import asdict, replace

from flight.plan.plan import plan_content
from flightlog.attachment_names import MISSION_ATTACHMENT
from flightlog.identity import identity
from planner.closed_loop.flight_record import Flown
from planner.kernel.build import SEARCH_BACKEND
from sim.flight_header import flight_header, flight_inputs
from sim.loop.backend import Backend
from sim.loop.specification import DEFAULT_ALTITUDE, FlightSpecification, pose
from sim.vehicle.parameters import read_parameters

from .task import MissionTask


def mission_specification(task: MissionTask) -> FlightSpecification:
    """Returns the flight of a mission, without what decides in it."""
    mission = task.mission
    return FlightSpecification(
        kind="mission",
        name=mission.name,
        seed=task.seed,
        wind=task.wind,
        altitude=task.library.conditions.altitude or DEFAULT_ALTITUDE,
        start=pose(mission.start),
        start_trim=mission.start_trim,
    ).depart(task.departure)


def mission_identity(task: MissionTask) -> dict[str, str]:
    """Returns which flight the log of a mission must be of."""
    specification, parameters = mission_specification(task), read_parameters()
    header = flight_header(specification, parameters, backend=Backend.INTERPRETED)
    inputs = flight_inputs(specification, task.library, parameters)
    return identity(header.planned_by(SEARCH_BACKEND), {**inputs, MISSION_ATTACHMENT: mission_json(task)})


def mission_json(task: MissionTask) -> bytes:
    """Returns what a mission is flown from: mission, planner, and how the loop is closed.

    Latencies of a flight that is repeated are left out: those charged stand with the plans, so that a flight
    and its repetition have the same log.
    """
    latency = replace(task.settings.latency, recorded=None)
    content = {
        **asdict(task.mission),
        "policy": task.policy,
        "gamma": task.gamma,
        "max_nodes": task.max_nodes,
        "settings": asdict(replace(task.settings, latency=latency)),
    }
    return json.dumps(content, indent=1).encode()


def plans_json(flown: Flown) -> bytes:
    """Plans with the time each was asked for, and the seconds charged for it.

    The time each took by the clock would not repeat; it is there only where it was measured, and charged.
    """
    plans = [
        {"time": time, "latency": latency, **plan_content(replace(plan, solve_time=0.0))}
        for time, latency, plan in zip(flown.times, flown.latencies, flown.plans, strict=True)
    ]
    return json.dumps(plans, indent=1).encode()
