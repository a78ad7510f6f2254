"""Price of robustness of one walk, as a CasADi statement for IPOPT.

The largest level that a limit of seconds allows (thesis, Problem 4.2): the level is a variable itself, with
coasting times for 0, minus and plus that level, each of which reaches the goal within the limit. Whether the
levels below meet the limit, too, is no part of the statement.
"""

from collections.abc import Sequence
from functools import cache
from math import inf

import casadi
import numpy as np

from flight.automaton.library import Library
from flight.mission.mission import Mission
from planner.walks.kinematics import walk_motion
from planner.walks.walk import Walk

from .statements import OPTIONS, Statement, ends_of, miss_of, numbers_of, numbers_of_mission

SIGNS = (0.0, -1.0, 1.0)
"""Of the level, where the goal must be reached."""

PROBE = 0.25
"""Level at which errors are read off a walk; they scale with the level."""


def state_price(trims: int) -> Statement:
    """States the largest level of a walk over times and level.

    The constraints are a miss and the seconds to spare for each sign.
    """
    end, symbols = ends_of(trims, 2)
    nominal, error = symbols
    times, level = casadi.SX.sym("times", trims, len(SIGNS)), casadi.SX.sym("level")
    mission, limit, fixed = casadi.SX.sym("mission", 6), casadi.SX.sym("limit"), casadi.SX.sym("fixed", 2)
    misses, spare = [], []
    for place, sign in enumerate(SIGNS):
        held = times[:, place]
        misses.append(miss_of(end(held, nominal + sign * level * error, mission[:3]), mission))
        spare.append(limit - casadi.sum1(held) - fixed[0] - sign * level * fixed[1])
    problem = {
        "x": casadi.vertcat(casadi.vec(times), level),
        "p": casadi.vertcat(nominal, error, mission, limit, fixed),
        "f": -level,
        "g": casadi.vertcat(*misses, *spare),
    }
    return Statement(problem, ("miss",) * len(SIGNS) + ("time",) * len(SIGNS))


def largest_level(
    library: Library,
    walk: Walk,
    mission: Mission,
    limit: float,
    start: tuple[Sequence[Sequence[float]], float],
) -> float:
    """Returns the largest level IPOPT finds, or minus infinity.

    Args:
        library: the primitives.
        walk: trim ids.
        mission: with a tolerance above 0 and no heading.
        limit: seconds that a plan may take.
        start: coasting times in seconds for the level's signs 0, - and +, and the level.
    """
    nominal, probe = walk_motion(library, walk, 0.0), walk_motion(library, walk, PROBE)
    numbers = np.array(numbers_of(nominal))
    error = (np.array(numbers_of(probe)) - numbers) / PROBE
    fixed = nominal.fixed_time, (probe.fixed_time - nominal.fixed_time) / PROBE
    times, level = start
    count = len(SIGNS)
    run = _solver(len(walk))
    answer = run(
        x0=[*(time for held in times for time in held), level],
        p=[*numbers, *error, *numbers_of_mission(mission, mission.tolerance), limit, *fixed],
        lbx=0,
        ubx=[inf] * (count * len(walk)) + [1.0],
        lbg=[-inf] * count + [0.0] * count,
        ubg=[0.0] * count + [inf] * count,
    )
    return -float(answer["f"]) if run.stats()["success"] else -inf


@cache
def _solver(trims: int) -> casadi.Function:
    return casadi.nlpsol(f"price_{trims}", "ipopt", state_price(trims).problem, OPTIONS)
