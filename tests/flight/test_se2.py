"""Tests of planar motions: group laws and constant-velocity flow."""

from math import cos, pi, sin

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from mpmath import mp, mpf

from flight.se2 import SE2, Twist, wrap_angle

lengths = st.floats(-100, 100)
angles = st.floats(-10, 10)
poses = st.builds(SE2, lengths, lengths, angles)
speeds = st.floats(-30, 30)
twists = st.builds(Twist, speeds, speeds, st.floats(-2, 2))
times = st.floats(0, 100)


def close(a: SE2, b: SE2, tolerance: float = 1e-9) -> bool:
    return (
        abs(a.x - b.x) <= tolerance
        and abs(a.y - b.y) <= tolerance
        and abs(a.heading - b.heading) <= tolerance
    )


@given(poses, poses, poses)
def test_composition_is_associative(a: SE2, b: SE2, c: SE2) -> None:
    assert close((a @ b) @ c, a @ (b @ c))


@given(poses)
def test_the_inverse_undoes(pose: SE2) -> None:
    assert close(pose @ pose.inverse(), SE2.identity())
    assert close(pose.inverse() @ pose, SE2.identity())


@given(twists, times, times)
@example(Twist(4.0, 0.0, 1e-300), 10.0, 20.0)
@example(Twist(4.0, 0.0, 1e-12), 10.0, 20.0)
@example(Twist(4.0, 1.0, 0.0), 10.0, 20.0)
def test_holding_twice_is_holding_longer(twist: Twist, first: float, second: float) -> None:
    twice = SE2.exp(twist, first) @ SE2.exp(twist, second)
    # Rounding grows with the distance flown, at most 45 m/s for 200 s.
    assert close(twice, SE2.exp(twist, first + second), tolerance=1e-10 * 9000)


@given(twists, times)
def test_flying_backwards_in_time_returns(twist: Twist, time: float) -> None:
    assert close(SE2.exp(twist, time) @ SE2.exp(twist, -time), SE2.identity(), tolerance=1e-10 * 9000)


@given(speeds, speeds, st.floats(-2, 2), st.floats(1e-3, 100))
@example(4.0, -1.0, 1e-300, 10.0)
@example(4.0, -1.0, 1e-12, 10.0)
@example(4.0, -1.0, 1e-8, 10.0)
@example(4.0, -1.0, 5e-324, 10.0)
def test_the_flow_agrees_with_forty_digits(forward: float, side: float, rate: float, time: float) -> None:
    """Thesis, eq. 17-18, compared in 40-digit arithmetic."""
    with mp.workdps(700):
        r, t = mpf(rate), mpf(time)
        along = mp.sin(r * t) / r if rate else t
        across = (1 - mp.cos(r * t)) / r if rate else mpf(0)
        x, y = forward * along - side * across, forward * across + side * along
    pose = SE2.exp(Twist(forward, side, rate), time)
    # Three roundings of terms no larger than the distance flown.
    tolerance = 1e-15 * (abs(forward) + abs(side)) * time + 1e-300
    assert abs(pose.x - float(x)) <= tolerance
    assert abs(pose.y - float(y)) <= tolerance


def test_a_quarter_turn_to_the_right_leads_north_then_east() -> None:
    pose = SE2.exp(Twist(2.0, 0.0, 0.5), pi)
    assert close(pose, SE2(4.0, 4.0, pi / 2), tolerance=1e-14)


def test_a_displacement_is_in_the_frame_of_the_pose_it_follows() -> None:
    heading = 0.3
    pose = SE2(1.0, 2.0, heading) @ SE2(5.0, 0.0, 0.1)
    assert close(pose, SE2(1 + 5 * cos(heading), 2 + 5 * sin(heading), 0.4), tolerance=1e-14)


@given(st.floats(-1000, 1000))
def test_a_wrapped_angle_points_the_same_way(angle: float) -> None:
    wrapped = wrap_angle(angle)
    assert -pi <= wrapped <= pi
    assert abs(sin(wrapped) - sin(angle)) < 1e-12
    assert abs(cos(wrapped) - cos(angle)) < 1e-12


@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_motion_that_is_no_number_is_refused(bad: float) -> None:
    with pytest.raises(ValueError, match="finite"):
        Twist(bad, 0.0, 0.0)
    with pytest.raises(ValueError, match="finite"):
        SE2(0.0, bad, 0.0)
