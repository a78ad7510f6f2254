"""Invariance under units of length and time, and the public functions."""

import ctypes
from dataclasses import replace

import numpy as np
import pytest

from .native import native, problem_of
from .planted_walks import random_walk
from .walk_problem import WalkProblem

pytestmark = pytest.mark.kernel


def scaled(walk: WalkProblem, length: float, time: float) -> WalkProblem:
    return replace(
        walk,
        velocities=tuple(velocity * length / time for velocity in walk.velocities),
        rates=tuple(rate / time for rate in walk.rates),
        displacements=tuple(moved * length for moved in walk.displacements),
        goal=walk.goal * length,
        tolerance=walk.tolerance * length,
    )


def solved(
    walk: WalkProblem, slack: float, *, best: float = np.inf, most: int = 12
) -> tuple[float, list[float]]:
    problem = problem_of(walk, slack=slack)
    problem.best = best
    native().solve(ctypes.byref(problem), most)
    return problem.best, list(problem.times[: len(walk.rates)])


@pytest.mark.parametrize("seed", range(40))
def test_times_are_the_same_to_the_last_bit_in_units_that_are_powers_of_two(seed: int) -> None:
    rng = np.random.default_rng(seed)
    walk = random_walk(rng, slow=0.2)
    times = tuple(rng.exponential(3.0, len(walk.rates)).tolist())
    end, heading = walk.end(times)
    asked = replace(walk, goal=end + rng.choice([0, 0.3]), tolerance=float(rng.choice([0.0, 0.5])))
    if seed % 3 == 0:
        asked = replace(asked, heading=heading, heading_tolerance=float(rng.choice([0.0, 0.2])))
    cost, best = solved(asked, 1e-9)
    for length, time in ((2.0**-20, 2.0**10), (2.0**30, 2.0**-5), (1.0, 2.0**40)):
        other, found = solved(scaled(asked, length, time), 1e-9 * length)
        assert other == cost * time
        assert found == [one * time for one in best]


def test_a_goal_at_the_start_is_measured_by_the_turn() -> None:
    """The only length is a circle, or a turn's."""
    circle = WalkProblem((3,), (0.5,), goal=0, heading=0.5, heading_tolerance=0.0)
    assert solved(circle, 1e-9)[0] == np.inf
    spot = replace(circle, velocities=(0,))
    assert solved(spot, 1e-9)[0] == pytest.approx(1.0, rel=1e-15)
    around = WalkProblem((3, 3), (0.5, -0.5), (0,), (np.pi,), goal=0, heading=np.pi, heading_tolerance=0.0)
    assert solved(around, 1e-9)[0] == 0.0
    still = WalkProblem((0,), (0.0,), goal=1.0, tolerance=0.5)
    assert solved(still, 1e-9)[0] == np.inf
    assert solved(replace(still, tolerance=1.0), 1e-9)[0] == 0.0


def test_only_faster_times_count() -> None:
    walk = WalkProblem((2, 3), (0.0, 0.5), (1,), (0.2,), goal=8 + 3j)
    cost, times = solved(walk, 1e-9)
    assert solved(walk, 1e-9, best=cost * (1 - 1e-12))[1] == [0.0, 0.0]
    assert solved(walk, 1e-9, best=cost * (1 - 1e-12))[0] == cost * (1 - 1e-12)
    again, same = solved(walk, 1e-9, best=cost * 1.01)
    assert again == pytest.approx(cost, rel=1e-14)
    assert same == pytest.approx(times)


def test_no_more_times_are_used_than_asked_for() -> None:
    """With a limit of as many times as trims a walk is solved exactly."""
    rng = np.random.default_rng(2)
    fewer = 0
    for _ in range(30):
        walk = random_walk(rng, slow=0.0)
        goal = complex(*rng.normal(0, 10, 2))
        costs = []
        for most in (1, 2, 3, 12):
            cost, times = solved(replace(walk, goal=goal, tolerance=1.0), 1e-9, most=most)
            assert sum(time > 0 for time in times) <= most
            assert most < len(walk.rates) or cost == solved(replace(walk, goal=goal, tolerance=1.0), 1e-9)[0]
            costs.append(cost)
        assert costs == sorted(costs, reverse=True)
        assert costs[0] == least_of_one(walk, goal)
        fewer += costs[0] > costs[1] or costs[1] > costs[2]
    assert fewer > 5


def least_of_one(walk: WalkProblem, goal: complex) -> float:
    """Returns the least time with one coast, to 1 m."""
    found = [np.inf]
    for place in range(len(walk.rates)):
        velocities = tuple(v if k == place else 0j for k, v in enumerate(walk.velocities))
        rates = tuple(r if k == place else 0.0 for k, r in enumerate(walk.rates))
        alone = replace(walk, velocities=velocities, rates=rates, goal=goal, tolerance=1.0)
        found.append(solved(alone, 1e-9)[0])
    return min(found)


def test_seconds_in_maneuvers_count() -> None:
    walk = WalkProblem((2, 3), (0.0, 0.5), (1,), (0.2,), goal=8 + 3j)
    cost, times = solved(walk, 1e-9)
    problem = problem_of(walk)
    problem.fixed = 3.5
    native().solve(ctypes.byref(problem), 12)
    assert problem.best == pytest.approx(cost + 3.5, rel=1e-14)
    assert list(problem.times[:2]) == pytest.approx(times, rel=1e-14)
