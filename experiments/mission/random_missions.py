"""Random missions with a worst-case plan."""

from math import cos, pi, sin

import numpy as np

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.mission import Mission
from flight.se2 import SE2
from planner.policies.policy import Planner
from planner.policies.worst_case import worst_case_planner

# Distinct from the stream keys of `fly_campaign` and `fly`.
_DRAW_STREAM = 104

NEAREST, FARTHEST = 10.0, 60.0
"""Range of goal distances, m; a fast turn is 10 m wide, the thesis's missions are 9 to 36 m long."""

TOLERANCE = 0.9144
"""Goal tolerance, m; the thesis's 3 ft."""

DRAWS = 50
"""Largest number of draws for one mission."""


class NoMissionError(FlightError):
    """No drawn mission has a worst-case plan."""

    def __init__(self, library: Library, gamma: float) -> None:
        super().__init__(
            f"library {library.name}: expected a worst-case plan at gamma {gamma:g} for one of {DRAWS} "
            "random missions, got none"
        )


def random_missions(library: Library, *, count: int, seed: int, gamma: float) -> tuple[Mission, ...]:
    """Draws missions with random trims and goals, and a plan each.

    A mission depends on the seed, its number and the library alone. Results with these missions hold for
    missions that a planner accepts; the number of rejected draws does not matter.

    Args:
        library: library with which each must have a worst-case plan.
        count: number of missions.
        seed: seed of all random numbers.
        gamma: gamma at which each must be reachable.

    Raises:
        NoMissionError: no drawn mission has a plan.
    """
    planner = worst_case_planner(library, gamma)
    return tuple(_draw(library, planner, number, seed, gamma) for number in range(1, count + 1))


def _draw(library: Library, planner: Planner, number: int, seed: int, gamma: float) -> Mission:
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_DRAW_STREAM, number)))
    trims = [trim.id for trim in library.trims]
    for _ in range(DRAWS):
        distance, bearing = float(rng.uniform(NEAREST, FARTHEST)), float(rng.uniform(-pi, pi))
        mission = Mission(
            name=f"random-{seed}-{number:03d}",
            start=SE2(0.0, 0.0, float(rng.uniform(-pi, pi))),
            start_trim=int(rng.choice(trims)),
            goal=(distance * cos(bearing), distance * sin(bearing)),
            tolerance=TOLERANCE,
        )
        if planner.plan(mission).found:
            return mission
    raise NoMissionError(library, gamma)
