"""Tests of interpolated libraries: splines, bounds, claims."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jaxtyping import Float
from scipy.interpolate import RBFInterpolator

from flight.automaton.library import Library
from flight.automaton.library_file import library_text, parse_library
from flight.units import FOOT
from identification.data_sheet import data_sheet, describe_claim
from identification.design.trend_automaton import turns_automaton
from identification.interpolation.interpolate import (
    CannotInterpolateError,
    InterpolatedLibrary,
    interpolate_library,
)
from identification.interpolation.interpolated_maneuvers import INTERPOLATED_NOTE
from identification.interpolation.spline import Spline
from identification.trends import trends
from tests.support.synthetic_growth import TRUTH, flown_library, scatter, true_velocity_step

Table = Float[np.ndarray, "n k"]
Column = Float[np.ndarray, "n"]


@pytest.fixture(scope="module")
def interpolated() -> InterpolatedLibrary:
    return interpolate_library(flown_library(), speed_step=4 * FOOT, yaw_rate_step=0.1, name="interpolated")


def held(library: Library) -> float:
    """Returns the share of interpolated maneuvers with true values inside bounds."""
    inside = []
    for row in library.maneuvers:
        if row.notes != INTERPOLATED_NOTE:
            continue
        edge = true_velocity_step(library, row)
        truth = TRUTH.maneuver(edge)
        true_scatter = np.array([0.2, 0.3, 0.3, 0.05]) * scatter(edge.reached)
        own = (row.duration, row.displacement.x, row.displacement.y, row.displacement.heading)
        error = (row.error.duration, row.error.forward, row.error.side, row.error.heading_change)
        inside.append((np.abs(np.subtract(own, truth)) + true_scatter <= np.abs(error)).all())
    return float(np.mean(inside))


def test_an_interpolated_library_has_many_trims_and_maneuvers(interpolated: InterpolatedLibrary) -> None:
    assert len(interpolated.library.trims) >= 70
    assert len(interpolated.library.maneuvers) >= 500


def test_interpolated_bounds_hold_the_true_vehicle(interpolated: InterpolatedLibrary) -> None:
    assert held(interpolated.library) >= 0.95


def test_bounds_interpolated_from_shrunken_ones_do_not(interpolated: InterpolatedLibrary) -> None:
    """Tests shrunken bounds as the negative control."""
    small = interpolate_library(
        flown_library(shrunken=0.5), speed_step=4 * FOOT, yaw_rate_step=0.1, name="small"
    )
    assert held(small.library) < 0.5


def test_flown_maneuvers_and_the_statistics_of_flown_trims_are_unchanged(
    interpolated: InterpolatedLibrary,
) -> None:
    flown = flown_library()
    for trim, own in zip(interpolated.library.trims, flown.trims, strict=False):
        assert replace(trim, error=own.error, interpolated=None) == own
    assert interpolated.library.maneuvers[: len(flown.maneuvers)] == flown.maneuvers


def test_a_flown_trim_entered_by_interpolated_maneuvers_gets_their_kind_of_bounds_and_claim(
    interpolated: InterpolatedLibrary,
) -> None:
    entered = {row.to_trim for row in interpolated.library.maneuvers if row.interpolated}
    for trim, own in zip(interpolated.library.trims, flown_library().trims, strict=False):
        assert trim.id in entered
        assert trim.interpolated == interpolated.trim_claim
        for name in ("forward", "side", "yaw_rate"):
            assert abs(getattr(trim.error, name)) >= abs(getattr(own.error, name))


def test_interpolated_primitives_have_no_statistics_and_the_claim_of_their_kind(
    interpolated: InterpolatedLibrary,
) -> None:
    new = [row for row in interpolated.library.maneuvers if row.notes == INTERPOLATED_NOTE]
    assert len(new) == interpolated.maneuvers > 0
    assert all(row.statistics is None and row.interpolated == interpolated.maneuver_claim for row in new)
    assert (interpolated.maneuver_claim.left_out, interpolated.maneuver_claim.exceeding) == (262, 7)
    assert interpolated.maneuver_claim.coverage >= 0.95
    assert interpolated.maneuver_claim.flights == 12


def test_the_claims_of_an_interpolated_library_are_in_its_file_and_its_data_sheet(
    interpolated: InterpolatedLibrary,
) -> None:
    assert parse_library(library_text(interpolated.library), "text") == interpolated.library
    sheet = data_sheet(interpolated.library)
    for claim in (interpolated.trim_claim, interpolated.maneuver_claim):
        assert describe_claim(claim) in sheet


def test_an_interpolated_library_is_not_interpolated_again(interpolated: InterpolatedLibrary) -> None:
    with pytest.raises(CannotInterpolateError, match="expected a flown library, got interpolated"):
        interpolate_library(interpolated.library, speed_step=1.0, yaw_rate_step=0.1, name="twice")


def test_no_interpolated_trim_is_outside_the_flown_range(interpolated: InterpolatedLibrary) -> None:
    flown = flown_library().trims
    for trim in interpolated.library.trims:
        assert trim.velocity.forward <= max(one.velocity.forward for one in flown)
        nearest = min(
            abs(trim.velocity.forward - one.velocity.forward) / (8 * FOOT)
            + abs(trim.velocity.yaw_rate - one.velocity.yaw_rate) / 0.2
            for one in flown
        )
        assert nearest <= 1.1


def test_a_library_without_evidence_is_not_interpolated() -> None:
    with pytest.raises(CannotInterpolateError, match="statistics of at least 8 trims"):
        interpolate_library(
            turns_automaton(wind="calm", altitude=30.0), speed_step=1.0, yaw_rate_step=0.1, name="none"
        )


def removed_errors(points: Table, values: Column, rows: list[int], smoothing: float) -> Column:
    """Returns value minus prediction of scipy's spline fitted without the rows."""
    rest = [place for place in range(len(points)) if place not in rows]
    without = RBFInterpolator(points[rest], values[rest], kernel="linear", degree=1, smoothing=smoothing)
    return np.asarray(values[rows] - without(points[rows]))


@given(st.integers(0, 2**32 - 1), st.integers(1, 4))
@settings(max_examples=20, deadline=None)
def test_the_spline_is_scipys_and_its_left_out_errors_are_true(seed: int, dimensions: int) -> None:
    rng = np.random.default_rng(seed)
    points, values = rng.uniform(-1, 1, (25, dimensions)), rng.standard_normal(25)
    spline = Spline.fit(points, values)
    at = rng.uniform(-1, 1, (7, dimensions))
    smooth = spline.smoothing
    again = RBFInterpolator(points, values, kernel="linear", degree=1, smoothing=smooth)
    assert spline.at(at) == pytest.approx(again(at), abs=1e-8)
    assert spline.left_out[3] == pytest.approx(removed_errors(points, values, [3], smooth)[0], abs=1e-8)
    groups = [sorted({place, (place + 1) % 25, (7 * place) % 25}) for place in range(25)]
    spline = Spline.fit(points, values, groups=groups)
    errors = removed_errors(points, values, groups[4], spline.smoothing)
    assert spline.left_out[4] == pytest.approx(errors[groups[4].index(4)], abs=1e-8)


def test_trends_come_from_the_primitives_flown() -> None:
    library = flown_library()
    seen = trends(library, speed_step=8 * FOOT, rate_step=0.1)
    assert [round(row.speed / FOOT) for row in seen.speed_errors] == [0, 8, 16, 24]
    assert seen.speed_errors[0].percent is None
    assert len(seen.speed_steps) == 6
    assert len(seen.turn_steps) == 24
    for row in seen.speed_steps:
        assert row.percent == pytest.approx(100 * row.error / row.displacement)


def test_a_spline_needs_points_that_span_without_those_left_out_together() -> None:
    along = np.column_stack([np.arange(8.0), np.zeros(8)])
    points = np.vstack([along, [[1.0, 2.0], [3.0, 1.0]]])
    groups = [[place] for place in range(8)] + [[8, 9], [8, 9]]
    values = np.sin(points).sum(axis=1)
    assert len(Spline.fit(points, values).left_out) == 10
    with pytest.raises(ValueError, match="span all their coordinates"):
        Spline.fit(points, values, groups=groups)
