"""Libraries in which many walks are nearly one."""

from dataclasses import replace
from math import cos, pi, sin

import numpy as np

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.se2 import SE2, Twist


def alike_library(rng: np.random.Generator, *, trims: int, size: float) -> Library:
    """Returns a library of few rates and speeds whose maneuvers cost and move next to nothing.

    Args:
        rng: of everything.
        trims: how many, each joined with all others and itself.
        size: of durations, displacements and heading changes: seconds, metres, radians.
    """
    rate = float(rng.choice([0.2, 0.5, 1.5]))
    errors = 0.1 * rng.normal(size=(trims, 3)) if rng.random() < 0.5 else np.zeros((trims, 3))
    known = tuple(
        Trim(
            number,
            f"trim {number}",
            Twist(float(rng.choice([0.5, 1, 2])), 0.0, rate * float(rng.choice([-1, 0, 1, 0.7]))),
            Twist(*(float(error) * unit for error, unit in zip(row, (1.0, 1.0, rate), strict=True))),
        )
        for number, row in enumerate(errors, start=1)
    )
    pairs = [(one, other) for one in range(1, trims + 1) for other in range(1, trims + 1)]
    between = tuple(
        Maneuver(
            number,
            *pair,
            size * float(rng.random()),
            SE2(*(size * rng.normal(size=3)).tolist()),
            ManeuverError(0.0, 0.0, 0.0, 0.0),
        )
        for number, pair in enumerate(pairs, start=1)
    )
    return Library("alike", "walks that are nearly one", "", known, between)


def near_mission(rng: np.random.Generator, *, trims: int, max_trims: int) -> Mission:
    """Returns a mission of 0.3 to 10 m, a third of them with a wanted heading."""
    bearing, distance = rng.uniform(-pi, pi), 10 ** rng.uniform(-0.5, 1)
    mission = Mission(
        "near",
        SE2.identity(),
        int(rng.integers(1, trims + 1)),
        (float(distance * cos(bearing)), float(distance * sin(bearing))),
        float(rng.choice([0.0, 0.05, 0.3])),
        max_trims=max_trims,
    )
    if rng.random() > 0.35:
        return mission
    width = float(rng.choice([0.0, 0.2]))
    return replace(mission, goal_heading=float(rng.uniform(-pi, pi)), heading_tolerance=width)
