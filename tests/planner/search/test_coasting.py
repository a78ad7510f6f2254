"""Tests of one walk's coasting times: feasible and optimal."""

from dataclasses import replace
from math import inf, pi, sqrt

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from flight.mission.mission import Mission
from flight.se2 import SE2, Twist
from planner.kernel.exact import best_times
from planner.kernel.tables import kernel_table
from planner.walks.goal_condition import reaches_goal
from planner.walks.kinematics import WalkMotion

HERE = SE2.identity()
STEP = SE2(3.0, -1.0, 0.4)

NORTH, EAST, RIGHT = Twist(2, 0, 0), Twist(0, 4, 0), Twist(3, 0, 0.5)

rates = st.one_of(st.just(0.0), st.floats(1e-3, 0.8), st.floats(-0.8, -1e-3))
twists = st.builds(Twist, st.floats(0.5, 5), st.floats(-2, 2), rates)


def mission(x: float, y: float, tolerance: float = 0.0) -> Mission:
    return Mission("test", HERE, 1, (x, y), tolerance)


def walk(*velocities: Twist, step: SE2 = HERE) -> WalkMotion:
    """Returns a walk with maneuvers of zero time and displacement."""
    return WalkMotion(velocities, (step,) * (len(velocities) - 1), 0.0)


def solve(numbers: WalkMotion, asked: Mission) -> tuple[float, ...] | None:
    """Returns the kernel's times for a walk, or None."""
    trims = len(numbers.velocities)
    table = kernel_table(
        np.ones((1, trims), dtype=int),
        velocity=np.array([[complex(v.forward, v.side) for v in numbers.velocities]]),
        rate=np.array([[v.yaw_rate for v in numbers.velocities]], dtype=float),
        displacement=np.array([[complex(d.x, d.y) for d in numbers.displacements]], dtype=complex),
        turn=np.array([[d.heading for d in numbers.displacements]], dtype=float),
        fixed=np.array([numbers.fixed_time]),
    )
    costs, times = best_times(table, asked)
    return None if costs[0] == inf else tuple(times[0].tolist())


@given(st.lists(twists, min_size=1, max_size=2), st.sampled_from([0.1, 2.0]), st.integers(0, 10_000))
def test_no_times_that_end_within_a_disc_take_less(
    velocities: list[Twist], tolerance: float, seed: int
) -> None:
    known = np.random.default_rng(seed).uniform(0, 3, len(velocities)).tolist()
    numbers = walk(*velocities, step=STEP)
    asked = mission(*numbers.end(HERE, known).position, tolerance)
    times = solve(numbers, asked)
    assert times is not None
    assert reaches_goal(numbers.end(HERE, times), asked)
    assert sum(times) <= sum(known) + 1e-9


@given(twists, twists, st.integers(0, 10_000))
def test_no_two_times_that_end_at_a_point_take_less(one: Twist, two: Twist, seed: int) -> None:
    known = np.random.default_rng(seed).uniform(0.5, 3, 2)
    numbers = walk(one, two, step=STEP)
    ahead, back = (numbers.end(HERE, (known + 1e-6 * np.eye(2)[place]).tolist()).position for place in (0, 1))
    end = numbers.end(HERE, known.tolist()).position
    first, second = ((np.array(there) - end) / 1e-6 for there in (ahead, back))
    # Two times that move the end alike are not distinguished.
    assume(abs(first[0] * second[1] - first[1] * second[0]) > 0.1)
    asked = mission(*end)
    times = solve(numbers, asked)
    assert times is not None
    assert reaches_goal(numbers.end(HERE, times), asked)
    assert sum(times) <= known.sum() + 1e-6


def test_two_straight_trims_divide_the_way_by_their_directions() -> None:
    assert solve(walk(NORTH, EAST), mission(10, 12)) == pytest.approx((5.0, 3.0), abs=1e-9)


def test_a_turn_and_a_straight_follow_the_tangent() -> None:
    # Circle of radius 6 m to the right, then straight on to a point abeam: a right angle at the tangent.
    times = solve(walk(RIGHT, Twist(3, 0, 0)), mission(10.0, 6.0))
    assert times is not None
    assert 3 * times[1] == pytest.approx(sqrt(10**2 - 6**2), abs=1e-9)


def test_a_tolerance_is_used_to_its_edge() -> None:
    assert solve(walk(NORTH), mission(10, 0, tolerance=1.0)) == pytest.approx((4.5,), abs=1e-6)


@pytest.mark.parametrize("full_turns", [-1, 0, 1])
def test_a_heading_is_met_modulo_full_turns(full_turns: int) -> None:
    wanted = replace(mission(0, 0, 20.0), goal_heading=pi / 2 + 2 * pi * full_turns, heading_tolerance=0.1)
    times = solve(walk(RIGHT, Twist(3, 0, 0)), wanted)
    assert times is not None
    assert 0.5 * times[0] == pytest.approx(pi / 2 - 0.1, abs=1e-6)


def test_a_goal_behind_a_straight_walk_gives_no_times() -> None:
    assert solve(walk(NORTH, EAST), mission(-10, 0)) is None


def test_reaching_needs_the_heading_too() -> None:
    there = replace(mission(0, 0, 1.0), goal_heading=-pi, heading_tolerance=0.1)
    assert reaches_goal(SE2(0.5, 0.0, pi), there)
    assert not reaches_goal(SE2(0.5, 0.0, 3.0), there)
    assert not reaches_goal(SE2(1.5, 0.0, pi), there)
