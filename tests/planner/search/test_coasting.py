"""Coasting times of one walk: closed forms, and what CasADi makes of the statement."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.mission.mission import Mission
from flight.se2 import SE2, Twist
from planner.fallback.batch import Batch
from planner.fallback.coasting import solve, state
from planner.fallback.optimality import settled
from planner.fallback.starts import Goal, closed_forms
from planner.fallback.two_times import close, meet_disc
from planner.walks.goal import reaches
from planner.walks.kinematics import Motion, motion

CLOSED = 1e-7
"""Metres by which a closed form may miss, for turns no slower than a thousandth of a radian a second."""

HERE = SE2.identity()


def mission(x: float, y: float, tolerance: float = 0.0) -> Mission:
    return Mission("test", HERE, 1, (x, y), tolerance)


def walk(*velocities: Twist) -> Motion:
    """A walk whose maneuvers take no time and lead nowhere."""
    return Motion(velocities, (HERE,) * (len(velocities) - 1), 0.0)


NORTH, EAST, RIGHT = Twist(2, 0, 0), Twist(0, 4, 0), Twist(3, 0, 0.5)

rates = st.one_of(st.just(0.0), st.floats(1e-3, 0.8), st.floats(-0.8, -1e-3))
twists = st.builds(Twist, st.floats(0.5, 5), st.floats(-2, 2), rates)


@given(st.lists(twists, min_size=2, max_size=4), st.integers(0, 10_000))
def test_two_times_in_closed_form_end_where_they_should(velocities: list[Twist], seed: int) -> None:
    rng = np.random.default_rng(seed)
    batch = Batch.of([walk(*velocities)])
    times = rng.uniform(0, 6, (1, len(velocities)))
    target, _ = batch.end(times)
    first, second = sorted(rng.choice(len(velocities), 2, replace=False).tolist())
    found = close(batch, times, target, first=first, second=second)
    found = found[np.isfinite(found).all(axis=1) & (np.abs(found) < 1e4).all(axis=1)]
    ends, _ = batch.repeat(len(found)).end(found)
    assert np.abs(ends - target) == pytest.approx(0, abs=CLOSED)


@given(twists, twists, st.integers(0, 10_000))
def test_the_true_times_are_among_the_closed_forms(one: Twist, two: Twist, seed: int) -> None:
    times = np.random.default_rng(seed).uniform(0.5, 3, (1, 2))
    batch = Batch.of([walk(one, two)])
    velocities = batch.end_velocities(times)[0]
    # Where both times move the end alike, no two times are told apart.
    assume(abs((np.conj(velocities[0]) * velocities[1]).imag) > 0.1)
    found = close(batch, times, batch.end(times)[0], first=0, second=1)
    assert np.nanmin(np.abs(found - times).max(axis=1)) < 1e-5


@given(st.lists(twists, min_size=1, max_size=3), st.floats(0.1, 5), st.integers(0, 10_000))
def test_a_trim_held_to_the_edge_of_a_disc_ends_there(
    velocities: list[Twist], tolerance: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    batch = Batch.of([walk(*velocities)])
    times = rng.uniform(0, 6, (1, len(velocities)))
    target = batch.end(times)[0]
    found = meet_disc(batch, times, target, tolerance, place=int(rng.integers(len(velocities))))
    found = found[np.isfinite(found).all(axis=1)]
    ends, _ = batch.repeat(len(found)).end(found)
    assert np.abs(ends - target) == pytest.approx(tolerance, abs=CLOSED)


def test_two_straight_trims_divide_the_way_by_their_directions() -> None:
    times = solve(walk(NORTH, EAST), mission(10, 12), (1.0, 1.0))
    assert times == pytest.approx((5.0, 3.0), abs=1e-6)


def test_a_turn_and_a_straight_follow_the_tangent() -> None:
    # Circle of radius 6 m to the right, then straight on to a point abeam: a right angle at the tangent.
    goal = mission(10.0, 6.0)
    times = solve(walk(RIGHT, Twist(3, 0, 0)), goal, (1.0, 1.0))
    assert times is not None
    assert 3 * times[1] == pytest.approx(sqrt(10**2 - 6**2), abs=1e-5)


def test_a_tolerance_is_used_to_its_edge() -> None:
    times = solve(walk(NORTH), mission(10, 0, tolerance=1.0), (4.0,))
    assert times == pytest.approx((4.5,), abs=1e-6)


@pytest.mark.parametrize("full_turns", [0, 1])
def test_a_heading_is_met_modulo_full_turns(full_turns: int) -> None:
    wanted = replace(mission(0, 0, 20.0), goal_heading=pi / 2 + 2 * pi * full_turns, heading_tolerance=0.1)
    times = solve(walk(RIGHT, Twist(3, 0, 0)), wanted, (3.0, 0.0))
    assert times is not None
    assert 0.5 * times[0] == pytest.approx(pi / 2 - 0.1, abs=1e-5)


def test_a_goal_behind_a_straight_walk_gives_no_times() -> None:
    assert solve(walk(NORTH, EAST), mission(-10, 0), (1.0, 1.0)) is None


def test_more_equations_than_times_are_left_to_the_closed_forms() -> None:
    assert solve(walk(NORTH), mission(10, 0), (5.0,)) is None
    found = closed_forms(Batch.of([walk(NORTH)]), Goal(10 + 0j, 0.0))
    assert found.times == pytest.approx(np.full((len(found.times), 1), 5.0))


def test_the_statement_can_be_read_without_a_solver() -> None:
    exact, within = state(3, exact=True, heading=False), state(3, exact=False, heading=True)
    assert exact.problem["x"].shape == within.problem["x"].shape == (3, 1)
    assert exact.problem["g"].shape == (2, 1)
    assert within.problem["g"].shape == (2, 1)


@pytest.mark.parametrize("tolerance", [0.0, 2.0])
def test_what_counts_as_settled_the_solver_cannot_improve(tolerance: float) -> None:
    goal = mission(22.0, 9.0, tolerance)
    checked = 0
    for library in (thesis_kinematic(), thesis_gtmax()):
        for trims in [(2, 1), (1, 2), (1, 3)] if library.name == "thesis-gtmax" else [(1, 2, 5), (2, 6, 2)]:
            numbers = motion(library, trims, 0.5)
            batch = Batch.of([numbers])
            aim = Goal(complex(*goal.goal), tolerance * (1 - 1e-9))
            found = closed_forms(batch, aim)
            done = settled(batch, aim, found)
            for times, cost in zip(found.times[done], found.cost[done], strict=True):
                better = solve(numbers, goal, times)
                assert better is not None
                assert numbers.cost(better) > cost - 1e-5
                checked += 1
    assert checked >= 8


def test_reaching_needs_the_heading_too() -> None:
    there = replace(mission(0, 0, 1.0), goal_heading=-pi, heading_tolerance=0.1)
    assert reaches(SE2(0.5, 0.0, pi), there)
    assert not reaches(SE2(0.5, 0.0, 3.0), there)
    assert not reaches(SE2(1.5, 0.0, pi), there)
