"""Newton's methods of the kernel, and what they need."""

import ctypes
from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest

from .native import ActiveSet, Complex, Problem, active, native, problem_of
from .planted_walks import planted, random_walk
from .walk_problem import WalkProblem

pytestmark = pytest.mark.kernel

Doubles = ctypes.c_double * 144


def solve_linear(matrix: np.ndarray, right: np.ndarray) -> np.ndarray | None:
    flat, b = Doubles(*matrix.ravel()), Doubles(*right)
    solved = native().solve_linear(flat, b, len(right))
    return np.array(b[: len(right)]) if solved else None


@pytest.mark.parametrize("seed", range(20))
def test_linear_equations_are_solved_whatever_their_rows_are_measured_in(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size = int(rng.integers(1, 9))
    matrix, x = rng.normal(size=(size, size)), rng.normal(size=size)
    matrix[rng.random((size, size)) < 0.3] = 0.0
    if abs(np.linalg.det(matrix)) < 1e-3:
        return
    scale = 10.0 ** rng.uniform(-20, 20, size)
    found = solve_linear(scale[:, None] * matrix, scale * (matrix @ x))
    assert found is not None
    assert found == pytest.approx(x, rel=1e-9, abs=1e-9)


def test_singular_equations_are_not_solved() -> None:
    one = np.array([[1.0, 2.0], [2.0, 4.0]])
    assert solve_linear(one, np.ones(2)) is None
    assert solve_linear(np.array([[1.0, 0.0], [0.0, 0.0]]), np.ones(2)) is None
    assert solve_linear(np.array([[1.0, inf], [0.0, 1.0]]), np.ones(2)) is None
    # A pivot of 1e-15 of its row is rounding, one of 1e-13 is not.
    assert solve_linear(np.array([[1.0, 1.0], [1.0, 1 + 2e-15]]), np.ones(2)) is None
    assert solve_linear(np.array([[1.0, 1.0], [1.0, 1 + 1e-13]]), np.ones(2)) is not None


@pytest.mark.parametrize("seed", range(30))
def test_the_end_moves_with_each_time_as_differences_say(seed: int) -> None:
    rng = np.random.default_rng(seed)
    walk = random_walk(rng, slow=0.2)
    count = len(walk.rates)
    times = tuple((rng.exponential(4.0, count) * (rng.random(count) < 0.8)).tolist())
    problem, velocity, turned = problem_of(walk), (Complex * 12)(), ctypes.c_double()
    end = native().motion(ctypes.byref(problem), Doubles(*times), velocity, ctypes.byref(turned))
    expected, heading = walk.end(times)
    assert end.value == pytest.approx(expected, abs=1e-12)
    assert turned.value + sum(turn for _, turn in walk.steps) == pytest.approx(heading, abs=1e-13)
    known = walk.end_velocities(times)
    for place in range(count):
        shifted = [(*times[:place], times[place] + d, *times[place + 1 :]) for d in (1e-4, -1e-4)]
        later, earlier = (walk.end(one)[0] for one in shifted)
        assert velocity[place].value == pytest.approx((later - earlier) / 2e-4, abs=1e-6)
        assert velocity[place].value == pytest.approx(complex(known[place]), abs=1e-11)


def placed(walk: WalkProblem, times: tuple[float, ...]) -> tuple[Problem, ActiveSet]:
    """Returns the problem with nonzero times and heading limit set."""
    problem = problem_of(walk)
    on = active(problem, *[place for place, time in enumerate(times) if time])
    if walk.heading is not None:
        on.bound_heading, on.target = 1, problem.heading
    return problem, on


@pytest.mark.parametrize("tolerance", [0.0, 0.4])
@pytest.mark.parametrize("headed", [False, True])
@pytest.mark.parametrize("count", [1, 2, 3, 4, 5])
def test_times_move_by_least_to_the_goal(tolerance: float, headed: bool, count: int) -> None:
    """Covers fewer times than equations, with a consistent solution."""
    for seed in range(5):
        rng = np.random.default_rng([count, seed])
        walk = WalkProblem(
            tuple(complex(*rng.uniform(1, 3, 2)) for _ in range(count)),
            tuple(rng.uniform(0.1, 0.4, count).tolist()),
            tuple(complex(*rng.uniform(-1, 1, 2)) for _ in range(count - 1)),
            tuple(rng.uniform(-0.5, 0.5, count - 1).tolist()),
        )
        times = tuple(rng.uniform(1, 4, count).tolist())
        end, heading = walk.end(times)
        asked = replace(walk, goal=end + tolerance * np.exp(1j), tolerance=tolerance)
        if headed:
            asked = replace(asked, heading=heading, heading_tolerance=0.0)
        problem, on = placed(asked, times)
        start = np.array(times) + rng.normal(0, 1e-4, count)
        moved = Doubles(*start)
        assert native().meet_goal(ctypes.byref(problem), ctypes.byref(on), moved) == 1
        found = tuple(moved[:count])
        reached, faced = walk.end(found)
        assert abs(reached - asked.goal) == pytest.approx(tolerance, abs=1e-11)
        assert not headed or faced == pytest.approx(heading, abs=1e-11)
        equations = (1 if tolerance else 2) + headed
        step = np.array(found) - start
        if count > equations:
            # The shortest step lies in the span of the gradients.
            velocity = walk.end_velocities(found)
            rows = [(np.conj((reached - asked.goal) / tolerance) * velocity).real] if tolerance else []
            rows = rows or [velocity.real, velocity.imag]
            if headed:
                rows.append(np.array(walk.rates))
            left = step - np.array(rows).T @ np.linalg.lstsq(np.array(rows).T, step, rcond=None)[0]
            assert np.abs(left).max() < 1e-5
            assert np.abs(step).max() < 0.1


def test_newtons_method_ends_where_it_leads_nowhere() -> None:
    """Two parallel coasts cannot reach a goal aside."""
    walk = WalkProblem((1, 2), (0.0, 0.0), goal=5 + 3j)
    problem, on = placed(walk, (1.0, 1.0))
    assert native().meet_goal(ctypes.byref(problem), ctypes.byref(on), Doubles(1.0, 1.0)) == 0
    assert native().make_stationary(
        ctypes.byref(problem), ctypes.byref(on), Doubles(1.0, 1.0), Complex.of(-1.0)
    ) in (0, 1)
    # Nearly so: the step is too long to be one.
    near = replace(walk, velocities=(1, 2 + 1e-9j))
    problem, on = placed(near, (1.0, 1.0))
    assert native().meet_goal(ctypes.byref(problem), ctypes.byref(on), Doubles(1.0, 1.0)) == 0


def test_stationary_times_are_kept_and_times_near_them_led_there() -> None:
    tried = 0
    for seed in range(500):
        rng = np.random.default_rng([3, seed])
        one = planted(rng, slow=0.0)
        if one is None or not 1e-2 < one.worth < 5:
            continue
        walk, times = one.walk, one.times
        if walk.heading is not None and walk.heading_tolerance:
            # Free, or at the limit that the times have used up.
            _, heading = walk.end(times)
            off = np.remainder(heading - walk.heading + pi, 2 * pi) - pi
            if abs(abs(off) - walk.heading_tolerance) < 1e-9:
                walk = replace(walk, heading=heading, heading_tolerance=0.0)
            else:
                walk = replace(walk, heading=None)
        end, _ = walk.end(times)
        if walk.tolerance:
            m = (end - walk.goal) / walk.tolerance * one.worth
        else:
            held = [place for place, time in enumerate(times) if time]
            rows = walk.end_velocities(times)[held]
            columns = [rows.real, rows.imag]
            if walk.heading is not None:
                columns.append(np.array(walk.rates)[held])
            found = np.linalg.lstsq(np.column_stack(columns), -np.ones(len(held)), rcond=None)[0]
            m = complex(found[0], found[1])
        problem, on = placed(walk, times)
        if on.count < 2 + on.bound_heading:
            continue
        positive = np.array(times) > 0
        moved = Doubles(*(np.array(times) + 1e-5 * positive * rng.normal(size=len(times))))
        led = native().make_stationary(ctypes.byref(problem), ctypes.byref(on), moved, Complex.of(m * 1.0001))
        found = np.array(moved[: len(times)])
        if not led or np.abs(found - times).max() > 1e-2:
            continue
        tried += 1
        reached, _ = walk.end(tuple(found))
        assert abs(reached - walk.goal) == pytest.approx(walk.tolerance, abs=1e-10)
        assert found == pytest.approx(np.array(times), abs=1e-5)
    assert tried > 80


def test_a_time_that_rounding_made_negative_is_none() -> None:
    walk = WalkProblem((2, 0, 1), (0.0, 0.5, 0.2), goal=4.0)
    problem = problem_of(walk)

    def kept(*times: float) -> bool:
        return bool(native().update_best(ctypes.byref(problem), Doubles(*times)))

    assert not kept(2.0, -1e-8, 0.0)
    assert not kept(2.0, 0.0, -2e-9)
    assert not kept(2.0 - 1e-9, 0.0, -2e-9)
    assert kept(2.0 + 1e-10, -1e-9, -1e-10)
    assert problem.best == 2.0 + 1e-10
    assert list(problem.times[:3]) == [2.0 + 1e-10, 0.0, 0.0]
    # What is no faster is not kept, but it reaches the goal, too.
    assert kept(2.0 + 2e-10, 0.0, 0.0)
    assert problem.best == 2.0 + 1e-10
    assert not kept(2.1, 0.0, 0.0)
    assert not kept(float("nan"), 0.0, 0.0)


def test_what_is_kept_has_the_heading_wanted() -> None:
    walk = WalkProblem((1, 0), (0.0, 0.5), goal=3.0, heading=0.7, heading_tolerance=0.2)
    problem = problem_of(walk)
    for turned, there in ((0.5, 1), (0.5 - 2e-9, 0), (0.9, 1), (0.9 + 2e-9, 0), (0.7 + 2 * pi, 1)):
        problem.best = inf
        times = Doubles(3.0, turned / 0.5)
        assert native().update_best(ctypes.byref(problem), times) == there, turned
