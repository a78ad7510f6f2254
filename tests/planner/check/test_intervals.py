"""Tests of interval arithmetic: every true result, with little excess."""

from fractions import Fraction
from math import inf, nextafter, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flight.se2 import SE2, Twist
from planner.check.intervals import Interval, PoseBox, cos, hypot, sin, sinc, sqrt, square

NUMBERS = st.floats(-1e6, 1e6, allow_nan=False).map(lambda x: 0.0 if abs(x) < 1e-100 else x)
ANGLES = st.floats(-50, 50)
WIDTHS = st.sampled_from([0.0, 1e-16, 1e-9, 0.1, 1.0, 4.0, 8.0])


def holds(found: Interval, exact: Fraction) -> bool:
    return Fraction(float(found.low)) <= exact <= Fraction(float(found.high))


@given(NUMBERS, NUMBERS)
def test_the_four_operations_hold_the_exact_result(a: float, b: float) -> None:
    one, two = Interval.of(a), Interval.of(b)
    x, y = Fraction(a), Fraction(b)
    assert holds(one + two, x + y)
    assert holds(one - two, x - y)
    assert holds(one * two, x * y)
    assert holds(square(one), x * x)
    if b:
        assert holds(one / two, x / y)


@given(NUMBERS, NUMBERS, st.floats(0, 10), st.floats(0, 1))
def test_operations_on_wide_intervals_hold_what_their_members_give(
    a: float, b: float, wide: float, share: float
) -> None:
    one, two = Interval.of(a, a + wide), Interval.of(b, b + 2 * wide)
    x, y = min(a + share * wide, a + wide), min(b + (1 - share) * wide, b + 2 * wide)
    assert (one + two).contains(x + y)
    assert (one * two).contains(x * y)
    assert (one - two).contains(x - y)
    assert sqrt(square(one)).contains(abs(x))
    assert hypot(one, two).contains(float(np.hypot(x, y)))
    if y and not two.contains(0.0):
        assert (one / two).contains(x / y)


def test_without_outward_rounding_a_third_is_lost() -> None:
    third = Interval.of(1.0) / Interval.of(3.0)
    assert holds(third, Fraction(1, 3))
    assert Fraction(1.0 / 3.0) != Fraction(1, 3)
    assert float(third.width) < 1e-15


def test_dividing_by_what_may_be_zero_gives_anything() -> None:
    found = Interval.of(1.0) / Interval.of(-1.0, 1.0)
    assert (float(found.low), float(found.high)) == (-inf, inf)


@given(ANGLES, WIDTHS, st.floats(0, 1))
def test_sine_cosine_and_sinc_hold_what_their_members_give(angle: float, wide: float, share: float) -> None:
    high = angle + wide
    inside = min(angle + share * wide, high)
    box = Interval.of(angle, high)
    assert sin(box).contains(np.sin(inside))
    assert cos(box).contains(np.cos(inside))
    assert sinc(box).contains(float(np.sinc(inside / np.pi)))


@pytest.mark.parametrize("turn", range(-4, 5))
def test_peaks_on_the_very_edge_are_held(turn: int) -> None:
    peak = pi * turn
    for low, high in ((peak, peak + 0.1), (peak - 0.1, peak), (nextafter(peak, inf), peak + 0.1)):
        found = cos(Interval.of(low, high))
        assert found.contains(1.0 if turn % 2 == 0 else -1.0)


def test_enclosures_of_single_numbers_are_narrow() -> None:
    angles = np.linspace(-30, 30, 1001)
    away = np.abs(np.sin(angles)) > 1e-3
    assert sin(Interval.of(angles)).width.max() < 1e-13
    assert cos(Interval.of(angles)).width[away].max() < 1e-14
    assert sinc(Interval.of(angles)).width.max() < 1e-13


@given(
    st.tuples(st.floats(-5, 5), st.floats(-2, 2), st.floats(-1, 1)),
    st.floats(0, 20),
    st.floats(0, 0.2),
    st.floats(0, 1),
)
def test_a_box_of_motions_holds_every_motion_in_it(
    twist: tuple[float, float, float], duration: float, wide: float, share: float
) -> None:
    start = PoseBox(Interval.of(1.0), Interval.of(2.0), Interval.of(0.3, 0.3 + wide))
    forward, side, rate = (Interval.of(value - wide, value + wide) for value in twist)
    box = start @ PoseBox.exp(forward, side, rate, Interval.of(duration, duration + wide))
    moved = [value + (2 * share - 1) * wide * 0.999 for value in twist]
    end = SE2(1.0, 2.0, 0.3 + share * wide) @ SE2.exp(Twist(*moved), duration + share * wide)
    assert box.x.contains(end.x)
    assert box.y.contains(end.y)
    assert box.heading.contains(end.heading)


def test_a_coast_of_several_turns_is_enclosed_as_narrowly_as_a_short_one() -> None:
    rate, time = Interval.of(np.array([0.05, 0.6, 0.6])), Interval.of(np.array([10.0, 20.0, 100.0]))
    box = PoseBox.exp(Interval.of(8.0), Interval.of(0.5), rate, time)
    for part in (box.x, box.y, box.heading):
        assert part.width.max() < 1e-10
