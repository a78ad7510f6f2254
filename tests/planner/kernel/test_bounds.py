"""Lower bounds of a walk's time: valid, and sharp."""

import ctypes
from dataclasses import replace
from math import acos, cos, inf, pi, sin

import numpy as np
import pytest

from .native import Complex, active, native, problem_of
from .planted_walks import planted, random_walk
from .walk_problem import WalkProblem

pytestmark = pytest.mark.kernel


def least_time(walk: WalkProblem, distance: float) -> float:
    problem = problem_of(walk)
    every = active(problem, *range(len(walk.rates)))
    return float(native().least_time(ctypes.byref(problem), ctypes.byref(every), ctypes.c_double(distance)))


def chords_in_line(walk: WalkProblem, distance: float) -> float:
    """Returns the least time in which chords in line cover a distance."""
    trims = [(abs(velocity), abs(rate)) for velocity, rate in zip(walk.velocities, walk.rates, strict=True)]
    low, high = 0.0, max(speed for speed, _ in trims)
    for _ in range(200):
        u = 0.5 * (low + high)
        covered = sum(
            2 * speed / rate * sin(acos(u / speed)) if rate else inf for speed, rate in trims if speed > u
        )
        low, high = (u, high) if covered >= distance else (low, u)
    turning = [(speed, rate) for speed, rate in trims if speed > high and rate]
    spent = sum(2 * acos(high / speed) / rate for speed, rate in turning)
    covered = sum(2 * speed / rate * sin(acos(high / speed)) for speed, rate in turning)
    return spent + (distance - covered) / high


@pytest.mark.parametrize("seed", range(30))
def test_chords_in_line_cover_a_distance_in_least_time(seed: int) -> None:
    rng = np.random.default_rng(seed)
    walk = random_walk(rng, slow=0.0)
    reach = sum(
        2 * abs(velocity) / abs(rate) if rate else (inf if velocity else 0)
        for velocity, rate in zip(walk.velocities, walk.rates, strict=True)
    )
    distance = float(rng.uniform(0.05, 0.99)) * min(reach, 100.0)
    if not distance:
        return
    exact, bound = chords_in_line(walk, distance), least_time(walk, distance)
    assert bound <= exact * (1 + 1e-12)
    assert bound >= 0.93 * exact
    assert least_time(walk, 0.0) == least_time(walk, -1.0) == 0.0
    if reach < inf:
        assert least_time(walk, reach * (1 + 1e-12)) == inf
        assert least_time(walk, reach * (1 - 1e-12)) < inf


def test_a_straight_trim_covers_a_distance_at_its_speed() -> None:
    assert least_time(WalkProblem((5, 3j), (0.0, 0.0)), 10.0) == pytest.approx(2.0, rel=1e-15)
    assert least_time(WalkProblem((0, 3j), (0.5, 0.0)), 10.0) == pytest.approx(10 / 3, rel=1e-15)
    assert least_time(WalkProblem((0, 0), (0.5, 0.0)), 1e-9) == inf


def test_what_the_maneuvers_leave_of_a_distance_is_to_be_covered() -> None:
    walk = WalkProblem((1, 1), (0.0, 0.0), (3 - 4j,), (0.2,), goal=-30 + 40j, tolerance=2.0)
    problem = problem_of(walk)
    assert native().to_cover(ctypes.byref(problem)) == pytest.approx(50 - 5 - 2 - 1e-9, abs=1e-12)
    problem.fixed = 7.0
    assert native().lower_bound(ctypes.byref(problem)) == pytest.approx(7 + 43, abs=1e-8)


@pytest.mark.parametrize(
    ("off", "width", "reached"), [(0.5, 0.5, 1), (0.6, 0.5, 0), (-0.4, 0.5, 1), (6.2, 0.1, 1)]
)
def test_a_walk_that_never_turns_has_one_heading(off: float, width: float, reached: int) -> None:
    straight = WalkProblem(
        (1, 2), (0.0, 0.0), (1,), (0.3,), goal=9, heading=0.3 + off, heading_tolerance=width
    )
    bound = native().lower_bound(ctypes.byref(problem_of(straight)))
    assert (bound < inf) == bool(reached)
    turning = problem_of(replace(straight, rates=(0.0, 1e-3)))
    # To the right it turns 0.1 rad in 100 s.
    expected = 4.0 if reached else 100.0
    assert native().lower_bound(ctypes.byref(turning)) == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("seed", range(40))
def test_a_cosine_is_bounded_over_an_interval(seed: int) -> None:
    rng = np.random.default_rng(seed)
    angle, low, width = rng.uniform(-9, 9), rng.uniform(-5, 5), float(rng.choice([0.0, rng.uniform(0, 7)]))
    found = native().best_cosine(*map(ctypes.c_double, (angle, low, low + width)))
    most = np.cos(angle + np.linspace(low, low + width, 2001)).max()
    assert most - 1e-15 <= found <= most + 1e-5 + 0.026 * (abs(np.arccos(min(most, 1.0))) / pi) ** 10


def out_of_reach(walk: WalkProblem, seconds: float) -> bool:
    problem = problem_of(walk)
    every = active(problem, *range(len(walk.rates)))
    return bool(native().out_of_reach(ctypes.byref(problem), ctypes.byref(every), ctypes.c_double(seconds)))


@pytest.mark.parametrize("seed", range(60))
def test_what_was_flown_is_in_reach(seed: int) -> None:
    rng = np.random.default_rng(seed)
    walk = random_walk(rng, slow=0.1)
    times = tuple(rng.exponential(4.0, len(walk.rates)) * (rng.random(len(walk.rates)) < 0.7))
    end, _ = walk.end(times)
    assert not out_of_reach(replace(walk, goal=end), sum(times) * (1 + 1e-12) + 1e-12)


@pytest.mark.parametrize("bearing", [0.0, 0.4, -2.0, 3.0])
@pytest.mark.parametrize("aside", [0.0, 0.5, -0.5, 1.1, -1.1, 1.8, -1.8])
def test_straight_coasts_reach_as_far_as_the_fastest_of_them(bearing: float, aside: float) -> None:
    left = complex(cos(bearing), sin(bearing))
    direction = left * complex(cos(aside), sin(aside))
    walk = WalkProblem((2 * direction, 0.1), (0.0, 0.0), (3 * direction,), (0.0,), tolerance=0.5)
    # What is left of the way to the goal bears where it should.
    seconds, goal = 4.0, 3 * direction + 100 * left
    far = (goal * direction.conjugate()).real - 3 - 0.5
    fastest = max(2.0, (0.1 * direction.conjugate()).real)
    if far <= 0:
        return
    edge = (far - 1e-9) / fastest
    assert out_of_reach(replace(walk, goal=goal), edge * (1 - 1e-9))
    assert seconds > 0


def beyond_reach(walk: WalkProblem, seconds: float) -> float:
    """Returns the largest directional distance in metres beyond the reachable set.

    Headings are sampled: all that the coasts before can turn to, and in a coast what it turns besides.
    """
    goal, moved = walk.goal, problem_of(walk).table.arrays[3][0]
    folded = problem_of(walk).table.arrays[1][0]
    toward = np.angle(goal - moved.sum())
    most = -inf
    for aside in (0, 0.5, -0.5, 1.1, -1.1, 1.8, -1.8):
        direction = np.exp(1j * (toward + aside))
        left, fastest, low, high = (goal * direction.conjugate()).real - walk.tolerance, 0.0, 0.0, 0.0
        for displacement, velocity, rate in zip(moved, folded, walk.rates, strict=True):
            left -= _furthest(displacement, direction, low, high)
            turn = rate * seconds
            fastest = max(fastest, _furthest(velocity, direction, min(low, turn), max(high, turn)))
            low, high = min(low, turn), max(high, turn)
        most = max(most, left - fastest * seconds)
    return most


def _furthest(vector: complex, direction: complex, low: float, high: float) -> float:
    return float((np.exp(1j * np.linspace(low, high, 301)) * vector * np.conj(direction)).real.max())


def test_a_goal_is_out_of_reach_where_in_some_direction_nothing_leads_far_enough() -> None:
    out = near = 0
    for seed in range(300):
        rng = np.random.default_rng([8, seed])
        walk = random_walk(rng, slow=0.1)
        goal = complex(*rng.normal(0, 12, 2))
        asked = replace(walk, goal=goal, tolerance=float(rng.choice([0.0, 1.0])))
        seconds = float(rng.exponential(3.0))
        beyond = beyond_reach(asked, seconds)
        # Cosines are bounded from above: at most by 2.6 % of what is turned, at the far side of a turn.
        margin = 0.03 * (sum(map(abs, walk.displacements)) + seconds * max(map(abs, walk.velocities))) + 1e-3
        if beyond > margin:
            out += 1
            assert out_of_reach(asked, seconds), seed
        elif beyond < 0:
            near += 1
            assert not out_of_reach(asked, seconds), seed
    assert out > 50
    assert near > 50


def refuted(walk: WalkProblem, best: float, multiplier: complex, *, rounds: int = 8) -> tuple[bool, complex]:
    problem, m = problem_of(walk), Complex.of(multiplier)
    problem.best = best
    mask = ctypes.c_uint((1 << len(walk.rates)) - 1)
    found = native().refuted(ctypes.byref(problem), mask, rounds, ctypes.byref(m))
    return bool(found), m.value


def test_no_multiplier_refutes_what_was_flown() -> None:
    tried = 0
    for seed in range(400):
        rng = np.random.default_rng([5, seed])
        one = planted(rng, slow=0.0)
        if one is None:
            continue
        tried += 1
        toward = -one.walk.goal / (abs(one.walk.goal) or 1.0)
        for m in (0.2 * toward, complex(*rng.normal(0, 0.5, 2))):
            assert not refuted(one.walk, sum(one.times) * (1 + 1e-9) + 1e-9, m)[0], seed
    assert tried > 150


def test_multipliers_refute_most_that_is_faster_than_the_best() -> None:
    """Refutes 5 % below the least in three of four walks."""
    tried = few = 0
    for seed in range(400):
        one = planted(np.random.default_rng([6, seed]), slow=0.0)
        if one is None or not 0.01 < one.worth < 10:
            continue
        cost, _ = one.walk.solved()
        if cost < 1.0 or max(map(abs, one.walk.rates)) * cost > 6:
            continue
        tried += 1
        toward = -0.3 * one.walk.goal / (abs(one.walk.goal) or 1.0)
        found, m = refuted(one.walk, 0.95 * cost, toward, rounds=40)
        few += found
        assert not found or refuted(one.walk, 0.95 * cost, m, rounds=1)[0]
    assert tried > 150
    assert few >= 0.71 * tried


def test_a_heading_that_no_turn_has_in_time_is_refuted() -> None:
    """A goal that is everywhere leaves the turn alone to count."""
    walk = WalkProblem((0, 3), (0.2, 0.0), (1,), (0.1,), goal=4 + 2j, tolerance=100.0)
    left = replace(walk, heading=-1.0, heading_tolerance=0.3)
    # The maneuver's 0.1 rad and 4.883 rad to the right are 1.3 rad to the left: 24.42 s.
    assert refuted(left, 24.4, 0j)[0]
    assert not refuted(left, 24.43, 0j)[0]
    right = replace(walk, heading=0.1 + 0.2 * 5 + 0.3, heading_tolerance=0.3)
    assert refuted(right, 4.99, 0j)[0]
    assert not refuted(right, 5.01, 0j)[0]
    assert not refuted(replace(walk, heading=-1.0), 1.0, 0j)[0]
    # A tolerance of no heading is of no matter.
    assert not refuted(replace(walk, heading_tolerance=0.3), 1.0, 0j)[0]


def test_a_walk_that_cannot_beat_the_best_is_known_by_its_bounds() -> None:
    """Goal abeam: refuted by multipliers, not by the reachable set."""
    walk = WalkProblem((3, 2), (0.4, 0.0), (1,), (0.1,), goal=4 + 14j, tolerance=1.0)
    cost, _ = walk.solved()
    problem, first = problem_of(walk), -0.1 * walk.goal / abs(walk.goal)
    for share, known in ((0.3, True), (1 + 1e-9, False), (2.0, False), (0.9, True)):
        problem.best, problem.multiplier = share * cost, Complex.of(first)
        assert bool(native().cannot_beat(ctypes.byref(problem))) == known, share
    assert out_of_reach(walk, 0.3 * cost)
    assert not out_of_reach(walk, 0.9 * cost)
    assert problem.multiplier.value != first
    assert refuted(walk, 0.9 * cost, problem.multiplier.value, rounds=1)[0]


def test_seconds_in_maneuvers_are_no_time_to_coast() -> None:
    """Turns too slow for a grid of headings leave the reach alone to tell."""
    walk = WalkProblem((3, 2), (1e-5, 0.0), (1,), (0.1,), goal=31, tolerance=0.0)
    problem = problem_of(walk)
    problem.fixed = 50.0
    for coasting, known in ((9.9, True), (10.1, False)):
        problem.best = 50.0 + coasting
        assert bool(native().cannot_beat(ctypes.byref(problem))) == known
