"""Policy problems of one walk, as CasADi statements for IPOPT.

The worst case has coasting times for each level and the largest cost as one more variable (thesis, Problem
6.2; with level 0 alone it is the nominal problem, 6.1); the committed one has the same times at every
level (Problem 8.1), or these and the tolerance, which is then least. A whole interval of levels is met by
exchange: the level of a fine grid that misses most joins the statement until none misses. The price of
robustness is stated in `price_statement`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import inf
from typing import Any

import casadi
import numpy as np

from flight.automaton.library import Library
from flight.mission.destination import SLACK
from flight.mission.mission import Mission
from flight.se2 import wrap_angle
from planner.walks.goal_condition import wants_heading
from planner.walks.kinematics import WalkMotion, walk_motion
from planner.walks.search_result import Times
from planner.walks.walk import Walk

from .symbolic_motion import symbolic_motion

FINE = 2001
"""Levels of the grid on which a committed solution is evaluated."""

ROUNDS = 10
"""Levels that may join."""

VIOLATED = 1e-6
"""Metres by which a level may miss more than it should."""

OPTIONS: dict[str, Any] = {
    "print_time": False,
    "error_on_fail": False,
    "show_eval_warnings": False,
    "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-10, "max_iter": 300},
}


@dataclass(frozen=True, slots=True)
class Statement:
    """A problem ready for any CasADi solver.

    Attributes:
        problem: variables `x`, parameters `p` (numbers of the walk at every level, then start, goal and
            tolerance), objective `f`, constraints `g`.
        rows: kind of each constraint: a miss over its tolerance squared, a heading, a cost or a time.
    """

    problem: dict[str, casadi.SX]
    rows: tuple[str, ...]


def state_worst_case(trims: int, levels: int) -> Statement:
    """States Problem 6.2 for one walk: least worst-case cost.

    The variables are the times, level after level, and the worst cost; each level's constraints are its miss
    and how far its cost is below the worst.
    """
    end, numbers = ends_of(trims, levels)
    times, worst = casadi.SX.sym("times", trims, levels), casadi.SX.sym("worst")
    fixed, mission = casadi.SX.sym("fixed", levels), casadi.SX.sym("mission", 6)
    misses = [miss_of(end(times[:, level], numbers[level], mission[:3]), mission) for level in range(levels)]
    spare = [worst - casadi.sum1(times[:, level]) - fixed[level] for level in range(levels)]
    problem = {
        "x": casadi.vertcat(casadi.vec(times), worst),
        "p": casadi.vertcat(*numbers, mission, fixed),
        "f": worst,
        "g": casadi.vertcat(*misses, *spare),
    }
    return Statement(problem, ("miss",) * levels + ("cost",) * levels)


def state_committed(trims: int, levels: int, *, heading: bool) -> Statement:
    """States Problem 8.1 for one walk: least committed time.

    The last constraint is the sum of the times.
    """
    end, numbers = ends_of(trims, levels)
    times, mission = casadi.SX.sym("times", trims), casadi.SX.sym("mission", 6)
    ends = [end(times, numbers[level], mission[:3]) for level in range(levels)]
    misses = [miss_of(one, mission) for one in ends]
    headings = [one[2] for one in ends] if heading else []
    problem = {
        "x": times,
        "p": casadi.vertcat(*numbers, mission),
        "f": casadi.sum1(times),
        "g": casadi.vertcat(*misses, *headings, casadi.sum1(times)),
    }
    return Statement(problem, ("miss",) * levels + ("heading",) * len(headings) + ("time",))


def state_smallest_tolerance(trims: int, levels: int, *, heading: bool) -> Statement:
    """States the least tolerance of one walk with committed times.

    The variables are the times and the tolerance in units of the one given; the last constraint is the sum of
    the times.
    """
    end, numbers = ends_of(trims, levels)
    times, mission = casadi.SX.sym("times", trims), casadi.SX.sym("mission", 6)
    share = casadi.SX.sym("share")
    ends = [end(times, numbers[level], mission[:3]) for level in range(levels)]
    misses = [1 + miss_of(one, mission) - share**2 for one in ends]
    headings = [one[2] for one in ends] if heading else []
    problem = {
        "x": casadi.vertcat(times, share),
        "p": casadi.vertcat(*numbers, mission),
        "f": share,
        "g": casadi.vertcat(*misses, *headings, casadi.sum1(times)),
    }
    return Statement(problem, ("miss",) * levels + ("heading",) * len(headings) + ("time",))


def worst_case(
    library: Library, walk: Walk, mission: Mission, gammas: Sequence[float], start: Sequence[float]
) -> float:
    """Returns the worst cost IPOPT finds in seconds, or infinity.

    Args:
        library: the primitives.
        walk: trim ids.
        mission: with a tolerance above 0 and no heading.
        gammas: the levels.
        start: seconds, one for each trim, for every level.
    """
    motions = [walk_motion(library, walk, gamma) for gamma in gammas]
    numbers = [value for one in motions for value in numbers_of(one)] + numbers_of_mission(
        mission, mission.tolerance
    )
    run = _solver("worst", len(walk), len(gammas), heading=False)
    levels = len(gammas)
    guess = [*(list(start) * levels), sum(start) + max(one.fixed_time for one in motions)]
    answer = run(
        x0=guess,
        p=[*numbers, *(one.fixed_time for one in motions)],
        lbx=0,
        ubx=inf,
        lbg=[-inf] * levels + [0.0] * levels,
        ubg=[0.0] * levels + [inf] * levels,
    )
    return float(answer["f"]) if run.stats()["success"] else inf


@dataclass(frozen=True, slots=True)
class Question:
    """One walk at every level of an interval.

    Attributes:
        library: the primitives.
        walk: trim ids.
        mission: from where to where; with a tolerance above 0.
        gamma: the largest level.
        budget: seconds that the coasting times may take together.
    """

    library: Library
    walk: Walk
    mission: Mission
    gamma: float
    budget: float

    def committed(self, start: Times) -> Times | None:
        """Returns IPOPT's times within the tolerance on a fine grid."""
        found = self._exchanged("committed", start)
        return None if found is None else found[0]

    def smallest_tolerance(self, start: Times) -> tuple[Times, float] | None:
        """Returns IPOPT's times of least largest miss, and the miss."""
        return self._exchanged("tolerance", start)

    def _exchanged(self, kind: str, times: Times) -> tuple[Times, float] | None:
        grid = np.linspace(-self.gamma, self.gamma, FINE).tolist()
        every = [walk_motion(self.library, self.walk, level) for level in grid]
        chosen = [0, FINE // 2, FINE - 1]
        for _ in range(ROUNDS):
            solved = self._at_levels(kind, [every[place] for place in chosen], times)
            if solved is None:
                return None
            times, reached = solved
            ends = [one.end(self.mission.start, times) for one in every]
            misses = [end.distance_to(self.mission.goal) for end in ends]
            most = int(np.argmax(misses))
            if misses[most] <= reached + VIOLATED:
                return times, misses[most]
            if most in chosen:
                return None
            chosen.append(most)
        return None

    def _at_levels(self, kind: str, motions: list[WalkMotion], start: Times) -> tuple[Times, float] | None:
        mission, levels = self.mission, len(motions)
        heading, ends = wants_heading(mission), [one.end(mission.start, start) for one in motions]
        miss = max(end.distance_to(mission.goal) for end in ends)
        unit = max(miss, SLACK) if kind == "tolerance" else mission.tolerance
        numbers = [value for one in motions for value in numbers_of(one)] + numbers_of_mission(mission, unit)
        low, high, guess = [-inf] * levels, [0.0] * levels, list(start)
        if heading:
            assert mission.goal_heading is not None
            wanted = ends[1].heading + wrap_angle(mission.goal_heading - ends[1].heading)
            width = mission.destination.heading_reach
            low += [wanted - width] * levels
            high += [wanted + width] * levels
        if kind == "tolerance":
            guess.append(1.0)
        run = _solver(kind, len(start), levels, heading=heading)
        answer = run(x0=guess, p=numbers, lbx=0, ubx=inf, lbg=[*low, 0.0], ubg=[*high, max(self.budget, 0.0)])
        if not run.stats()["success"]:
            return None
        times = tuple(max(float(time), 0.0) for time in answer["x"].full().ravel()[: len(start)])
        return times, (float(answer["f"]) * unit if kind == "tolerance" else mission.tolerance)


@cache
def _solver(kind: str, trims: int, levels: int, *, heading: bool) -> casadi.Function:
    if kind == "worst":
        statement = state_worst_case(trims, levels)
    elif kind == "committed":
        statement = state_committed(trims, levels, heading=heading)
    else:
        statement = state_smallest_tolerance(trims, levels, heading=heading)
    return casadi.nlpsol(f"{kind}_{trims}_{levels}", "ipopt", statement.problem, OPTIONS)


def ends_of(trims: int, levels: int) -> tuple[casadi.Function, list[casadi.SX]]:
    """Returns the end function, and the symbols of every level."""
    walk = symbolic_motion(trims)
    numbers = casadi.vertcat(casadi.vec(walk.velocities), casadi.vec(walk.displacements))
    end = casadi.Function("end", [walk.coasting_times, numbers, walk.start], [walk.end])
    return end, [casadi.SX.sym(f"numbers_{level}", numbers.numel()) for level in range(levels)]


def miss_of(end: casadi.SX, mission: casadi.SX) -> casadi.SX:
    """Returns the square of a miss in tolerances, less 1."""
    off = end[:2] - mission[3:5]
    return casadi.dot(off, off) / mission[5] ** 2 - 1


def numbers_of(one: WalkMotion) -> list[float]:
    """Returns the numbers of a walk in the order of `ends_of`."""
    return [
        *(value for v in one.velocities for value in (v.forward, v.side, v.yaw_rate)),
        *(value for d in one.displacements for value in (d.x, d.y, d.heading)),
    ]


def numbers_of_mission(mission: Mission, unit: float) -> list[float]:
    """Returns start and goal, and what misses are measured in, metres."""
    start = mission.start
    return [start.x, start.y, start.heading, *mission.goal, unit]
