"""A small automaton with a table that is made in a moment."""

from functools import cache

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.se2 import SE2, Twist
from planner.recourse.problem import ShortestPathProblem, state_problem
from planner.recourse.solve import Solution, solve
from planner.recourse.table import CostTable

STRAIGHT, LEFT, RIGHT = 1, 2, 3
TOLERANCE = 1.0


def small_library(*, duration: float = 1.0) -> Library:
    """Returns a straight trim and two turns, joined by maneuvers of one duration."""
    error = Twist(0.05, 0.05, 0.02)
    rates = {STRAIGHT: 0.0, LEFT: -0.8, RIGHT: 0.8}
    trims = tuple(
        Trim(number, f"{rate:g} rad/s", Twist(2.0, 0.0, rate), error) for number, rate in rates.items()
    )
    pairs = [(one, two) for one in rates for two in rates if one != two]
    maneuvers = tuple(
        Maneuver(
            number,
            one,
            two,
            duration,
            SE2(2.0 * duration, 0.0, 0.5 * duration * (rates[one] + rates[two])),
            ManeuverError(-0.1 * duration, -0.3, 0.3, 0.1),
        )
        for number, (one, two) in enumerate(pairs, start=1)
    )
    return Library(name="small", description="For tests.", vehicle="none", trims=trims, maneuvers=maneuvers)


def small_problem(*, goal_trim: int | None = None) -> ShortestPathProblem:
    """Returns the problem of the small library within 20 m."""
    return state_problem(small_library(), tolerance=TOLERANCE, reach=20.0, goal_trim=goal_trim)


@cache
def small_solution(threads: int = 2) -> Solution:
    """Returns its solution."""
    return solve(small_problem(), threads=threads)


@cache
def small_table() -> CostTable:
    """Returns its table."""
    solution = small_solution()
    return CostTable(small_problem(), solution.values, solution.gap)
