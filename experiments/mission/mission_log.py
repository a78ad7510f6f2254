"""Attachments of a closed-loop flight's log: mission and plans."""

import json
from dataclasses import asdict, replace

from flight.plan.plan import plan_content
from flightlog.attachment_names import MISSION_ATTACHMENT
from flightlog.identity import flight_identity
from planner.closed_loop.flight_record import FlightRecord
from planner.kernel.build import search_backend
from sim.flight_header import flight_attachments, flight_header
from sim.loop.backend import Backend
from sim.loop.specification import DEFAULT_ALTITUDE, FlightSpecification, specified_pose
from sim.vehicle.parameters import read_parameters

from .mission_task import MissionTask


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
        header.with_search_backend(search_backend()), {**inputs, MISSION_ATTACHMENT: mission_json(task)}
    )


def mission_json(task: MissionTask) -> bytes:
    """Returns mission, planner and loop settings as JSON.

    Recorded latencies of a repeated flight are left out: the latencies applied are stored with the plans, so
    that a flight and its repetition have the same log.
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


def plans_json(flown: FlightRecord) -> bytes:
    """Returns the plans with their times and applied latencies as JSON.

    Measured solve times would differ in a repetition, so only applied latencies are stored.
    """
    plans = [
        {"time": time, "latency": latency, **plan_content(replace(plan, solve_time=0.0))}
        for time, latency, plan in zip(flown.times, flown.latencies, flown.plans, strict=True)
    ]
    return json.dumps(plans, indent=1).encode()
