"""Missions drawn by chance, where a mission makes sense: some way off, and with a plan that survives."""

from math import cos, pi, sin

import numpy as np

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.mission import Mission
from flight.se2 import SE2
from planner.policies.policy import Planner
from planner.policies.worst_case import worst_case_planner

# Beside those of `campaign_flights` and `mission_flights`.
_DRAW_STREAM = 104

NEAREST, FARTHEST = 10.0, 60.0
"""Metres to the goal: a fast turn is 10 m across, and the thesis's missions are 9 to 36 m long."""

TOLERANCE = 0.9144
"""Metres; the thesis's 3 ft."""

DRAWS = 50
"""How often a mission is drawn before it is said that there is none."""


class NoMissionError(FlightError):
    """Nothing that was drawn can be reached at the level that it is to be planned for."""

    def __init__(self, library: Library, gamma: float) -> None:
        super().__init__(
            f"of {DRAWS} missions drawn none has a worst-case plan at gamma {gamma:g} with {library.name}"
        )


def random_missions(library: Library, *, count: int, seed: int, gamma: float) -> tuple[Mission, ...]:
    """Returns missions from any trim to a goal anywhere around, each with a plan at the level.

    A mission depends on the seed, its number and the library alone. How many draws had no plan is no part of
    what is proved with these missions: they are what a planner would accept.

    Args:
        library: with which each must have a worst-case plan.
        count: how many.
        seed: of all chance.
        gamma: uncertainty level at which each must be reachable.

    Raises:
        NoMissionError: the level leaves nothing to be reached.
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
