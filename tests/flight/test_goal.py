"""Tests of goal tolerances: closed sets, with one slack for rounding."""

from math import nextafter, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flight.mission.destination import LARGE, SLACK, Destination, first_arrival, slack_of
from flight.mission.mission import Mission
from flight.se2 import SE2

tolerances = st.one_of(st.just(0.0), st.floats(1e-9, 1e3))


@given(tolerances, st.floats(-pi, pi), st.floats(-100, 100), st.floats(-100, 100))
def test_a_tolerance_is_reached_at_its_edge_and_not_beyond(
    tolerance: float, bearing: float, north: float, east: float
) -> None:
    there = Destination((north, east), tolerance)
    outward = complex(np.cos(bearing), np.sin(bearing))
    for off, reached in ((0.0, True), (0.5 * SLACK, True), (2 * SLACK + 1e-12 * tolerance, False)):
        end = complex(north, east) + (tolerance + off) * outward
        assert there.reached(SE2(end.real, end.imag, 0.0)) == reached


@given(st.one_of(st.just(0.0), st.floats(1e-9, 3.0)), st.floats(-10, 10), st.integers(-2, 2))
def test_a_heading_is_reached_at_its_edge_and_not_beyond(width: float, heading: float, turns: int) -> None:
    there = Destination((0.0, 0.0), 1.0, heading, width)
    for side in (-1, 1):
        for off, reached in ((0.0, True), (0.5 * SLACK, True), (2 * SLACK, False)):
            end = heading + side * (width + off) + 2 * pi * turns
            assert there.reached(SE2(0.0, 0.0, end)) == reached


def test_a_heading_that_is_free_is_never_wrong() -> None:
    assert Destination((0.0, 0.0), 1.0).reached(SE2(1.0, 0.0, 2.0))
    assert not Destination((0.0, 0.0), 1.0).wants_heading
    assert not Destination((0.0, 0.0), 1.0, 0.3, pi).wants_heading
    assert Destination((0.0, 0.0), 1.0, 0.3, nextafter(pi, 0.0)).wants_heading


def test_the_slack_is_a_part_of_large_problems() -> None:
    assert slack_of() == SLACK
    assert slack_of(-LARGE / 2, LARGE / 2) == SLACK
    assert slack_of(-4 * LARGE, 5 * LARGE) == pytest.approx(9 * SLACK)
    far = Mission("far", SE2(-1e5, 0.0, 0.0), 1, (2e5, 3e5), 1e5)
    assert far.destination.slack == pytest.approx(7e-7)
    assert far.destination.reach == far.tolerance + far.destination.slack


def test_a_track_that_touches_the_tolerance_arrives() -> None:
    track = np.array([[0.0, 0.0, 2.0, 0.0], [10.0, 10.0, 2.0, 0.0]])
    assert first_arrival([track], Destination((5.0, 0.0), 2.0)).time == pytest.approx(5.0, abs=1e-4)
    assert first_arrival([track], Destination((5.0, 0.0), 1.9999)).time is None
    assert first_arrival([track], Destination((5.0, 2.0), 0.0)).time == pytest.approx(5.0, abs=1e-8)
