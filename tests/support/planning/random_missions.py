"""Missions and libraries at random."""

from dataclasses import replace
from math import cos, pi, sin

import numpy as np

import libraries
from flight.automaton.library import Library
from flight.automaton.library_file import read_library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.se2 import SE2, Twist

SHIPPED = ("thesis-kinematic", "thesis-gtmax", "gtmax-sim")

ACCELERATION = 0.8
"""Metres a second squared of a synthetic maneuver."""

YAW_ACCELERATION = 0.4
"""Radians a second squared of a synthetic maneuver."""


def shipped_libraries() -> tuple[Library, ...]:
    """Returns the three libraries that are shipped."""
    return tuple(read_library(libraries.FOLDER / f"{name}.json") for name in SHIPPED)


def random_mission(rng: np.random.Generator, library: Library, max_trims: int) -> Mission:
    """Returns a mission of 1 to 80 m: any start trim and headings, tolerances of 0 to a tenth of the way."""
    angle, distance = rng.uniform(-pi, pi), rng.uniform(1, 80)
    mission = Mission(
        "random",
        SE2(float(rng.uniform(-20, 20)), float(rng.uniform(-20, 20)), float(rng.uniform(-pi, pi))),
        int(rng.choice([trim.id for trim in library.trims])),
        (0.0, 0.0),
        float(rng.choice([0.0, 0.0, 0.5, 0.9144, 3.0, 0.1 * distance])),
        max_trims=max_trims,
    )
    goal = mission.start.x + distance * cos(angle), mission.start.y + distance * sin(angle)
    mission = replace(mission, goal=goal)
    if rng.random() > 0.2:
        return mission
    width = float(rng.choice([0.0, 0.1, 0.5]))
    return replace(mission, goal_heading=float(rng.uniform(-pi, pi)), heading_tolerance=width)


def synthetic_library(trims: int, maneuvers: int, *, seed: int) -> Library:
    """Returns a library by the kinematic equations: every maneuver flies the mean of its two trims.

    Args:
        trims: how many; speeds of 0.5 to 10 m/s, yaw rates up to 0.6 rad/s, some straight.
        maneuvers: how many, between trims at random; the first ones join all trims in a ring.
        seed: of all of it.
    """
    rng = np.random.default_rng(seed)
    known = []
    for number in range(1, trims + 1):
        rate = 0.0 if number % 5 == 0 else float(rng.uniform(-0.6, 0.6))
        speed = float(rng.uniform(0.5, 10))
        known.append(Trim(number, f"trim {number}", Twist(speed, 0, rate), Twist(0.1 * speed, 0, 0.1 * rate)))
    joined = {(number, number % trims + 1) for number in range(1, trims + 1)}
    while len(joined) < maneuvers:
        left, reached = (int(number) for number in rng.integers(1, trims + 1, 2))
        if left != reached:
            joined.add((left, reached))
    between = tuple(
        _maneuver(place, known[left - 1], known[reached - 1])
        for place, (left, reached) in enumerate(sorted(joined), start=1)
    )
    return Library("synthetic", "by the kinematic equations", "", tuple(known), between)


def _maneuver(number: int, left: Trim, reached: Trim) -> Maneuver:
    one, two = left.velocity, reached.velocity
    duration = max(
        1.0,
        abs(two.forward - one.forward) / ACCELERATION,
        abs(two.yaw_rate - one.yaw_rate) / YAW_ACCELERATION,
    )
    mean = Twist(0.5 * (one.forward + two.forward), 0.0, 0.5 * (one.yaw_rate + two.yaw_rate))
    moved = SE2.exp(mean, duration)
    error = ManeuverError(-0.1 * duration, -0.1 * moved.x, -0.1 * moved.y, 0.1 * moved.heading)
    return Maneuver(number, left.id, reached.id, duration, moved, error)
