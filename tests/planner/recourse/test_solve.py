"""Tests of the solver against its oracle and its own bounds."""

import numpy as np
import pytest

from flight.automaton.library import Library
from flight.errors import UnknownTrimError
from planner.recourse.grid import NestedGrid
from planner.recourse.normal_points import normal_points
from planner.recourse.problem import ZeroDurationLoopError, ZeroToleranceError, state_problem
from planner.recourse.solve import GAP, solve
from planner.recourse.table import CostTable
from tests.oracles.least_expected_times import action_cost, improved, looked_up

from .small_problem import (
    LEFT,
    STRAIGHT,
    TOLERANCE,
    small_library,
    small_problem,
    small_solution,
    small_table,
)


def goals(count: int, most: float = 40.0) -> np.ndarray:
    return np.random.default_rng(4).uniform(-most, most, (count, 2))


def test_points_have_exactly_the_mean_and_covariance_asked_for() -> None:
    rng = np.random.default_rng(1)
    root, mean = rng.normal(size=(4, 4)), rng.normal(size=4)
    points = normal_points(mean, root @ root.T, 48)
    assert points.mean(axis=0) == pytest.approx(mean, abs=1e-9)
    assert np.cov(points.T, bias=True) == pytest.approx(root @ root.T, abs=1e-8)


def test_a_number_without_variance_stays_what_it_is() -> None:
    assert normal_points(np.array([3.0, 1.0]), np.diag([0.0, 1.0]), 8)[:, 0] == pytest.approx(3.0, abs=1e-12)


def test_the_edge_of_the_tolerance_lies_midway_between_nodes_of_three_grids() -> None:
    for tolerance in (0.1, 0.9144, 3.0):
        grid = NestedGrid.around(tolerance, longest=10.0)
        assert grid.step <= tolerance / 4
        for level in range(2):
            steps = tolerance / (grid.step * 3**level)
            assert steps - 0.5 == pytest.approx(round(steps - 0.5), abs=1e-9)


def test_look_ups_are_the_oracles() -> None:
    problem, table = small_problem(), small_table()
    points = np.vstack([goals(300), goals(300, 1.5)])
    for trim in range(len(problem.trims)):
        expected = looked_up(problem, table.values, trim, points)
        assert table.times(np.full(len(points), trim), points) == pytest.approx(expected, abs=1e-9)


def test_costs_of_actions_are_the_oracles() -> None:
    problem, table, points = small_problem(), small_table(), np.vstack([goals(30, 4.0), goals(30)])
    first = problem.first
    for number, action in enumerate(problem.actions):
        costs = table.action_costs(np.full(len(points), action.trim), points)[:, number - first[action.trim]]
        expected = action_cost(problem, table.values, action, points)
        considered = np.isfinite(costs)
        assert costs[considered] == pytest.approx(expected[considered], abs=1e-9)
        assert considered.any()


def test_the_oracle_improves_nothing_beyond_the_stated_gap() -> None:
    solution = small_solution()
    made = improved(small_problem(), solution.values)
    assert solution.gap <= GAP
    assert np.abs(made - solution.values).max() <= GAP


def test_the_oracle_improves_values_that_are_not_solved() -> None:
    problem, values = small_problem(), small_solution().values.copy()
    values[values > 1.0] += 1.0
    assert np.abs(improved(problem, values) - values).max() > 0.3


def test_one_two_and_eight_threads_give_the_same_bytes() -> None:
    assert small_solution(1).values.tobytes() == small_solution(2).values.tobytes()
    assert small_solution(8).values.tobytes() == small_solution(2).values.tobytes()


def test_straight_ahead_takes_the_way_over_the_speed() -> None:
    time = small_table().times(np.array([0]), np.array([[9.0, 0.0]]))[0]
    assert time == pytest.approx((9.0 - TOLERANCE) / 2.0, abs=0.05)


def test_errors_cost_time() -> None:
    points, trims = goals(200, 15.0), np.zeros(200, dtype=int)
    problem = state_problem(small_library(), tolerance=TOLERANCE, reach=20.0, error_scale=4.0)
    solution = solve(problem)
    worse = CostTable(problem, solution.values, solution.gap).times(trims, points)
    assert worse.mean() > small_table().times(trims, points).mean() + 0.1


def test_a_wanted_last_trim_takes_longer_and_ends_in_it_alone() -> None:
    problem = small_problem(goal_trim=LEFT)
    solution = solve(problem)
    table = CostTable(problem, solution.values, solution.gap)
    inside = np.zeros((3, 2))
    ended = table.times(np.arange(3), inside) == 0
    assert ended.tolist() == [False, True, False]
    points, trims = goals(100, 15.0), np.zeros(100, dtype=int)
    assert (table.times(trims, points) >= small_table().times(trims, points) - 0.1).all()


def test_a_loop_of_maneuvers_that_take_no_time_is_refused() -> None:
    with pytest.raises(ZeroDurationLoopError, match=r"got one of 0 s through trims \[1, 2, 3\]"):
        state_problem(small_library(duration=0.0), tolerance=1.0)


def test_a_goal_without_tolerance_or_with_an_unknown_trim_is_refused() -> None:
    library: Library = small_library()
    with pytest.raises(ZeroToleranceError, match="> 0 m for feedback, got 0 m"):
        state_problem(library, tolerance=0.0)
    with pytest.raises(UnknownTrimError, match="no trim 9"):
        state_problem(library, tolerance=1.0, goal_trim=9)
    assert library.trim(STRAIGHT)
