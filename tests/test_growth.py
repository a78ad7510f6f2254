"""Growing a library: the interpolation's laws, and grown primitives beside the vehicle that they are of."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import RBFInterpolator

from flight.library import Library
from flight.maneuver import Maneuver, ManeuverError
from flight.se2 import SE2, Twist
from flight.sign_convention import signed_maneuver_error, signed_trim_error
from flight.statistics import ScalarStatistics, Statistics
from flight.trim import Trim
from identification.growth import GROWN, CannotGrowError, Growth, grow
from identification.spline import Spline
from identification.step_baseline import Baseline, Edge
from identification.step_response import StepResponse
from identification.trend_automaton import turns_automaton
from identification.trends import trends

FOOT = 0.3048
TRUTH = Baseline(StepResponse(0.7, 0.75), StepResponse(1.3, 0.7), dwell=1.0, timeout=15.0)


def scatter(velocity: Twist) -> float:
    """How much larger deviations are than in hover: smooth over the range, and not linear."""
    return 1 + 0.1 * velocity.forward + velocity.yaw_rate**2


def flown_library(*, shrunken: float = 1.0) -> Library:
    """Returns the turns automaton as a known vehicle flies it, with statistics of 12 flights."""
    automaton = turns_automaton(wind="calm", altitude=30.0)
    rule = automaton.conditions.maneuver_end
    assert rule is not None
    rng = np.random.default_rng(1)
    trims = tuple(_flown_trim(trim, rng, shrunken) for trim in automaton.trims)
    maneuvers = tuple(_flown(automaton, row, rng, shrunken) for row in automaton.maneuvers)
    return replace(automaton, trims=trims, maneuvers=maneuvers)


def _statistics(names: tuple[str, ...], means: list[float], largest: list[float]) -> Statistics:
    rows = zip(names, means, largest, strict=True)
    scalars = tuple(ScalarStatistics(name, mean, size / 2, size) for name, mean, size in rows)
    return Statistics(12, 0, 0.6, 0.95, scalars)


def _flown_trim(trim: Trim, rng: np.random.Generator, shrunken: float) -> Trim:
    size = scatter(trim.velocity) * shrunken * rng.uniform(0.85, 1.15, 3) * (0.1, 0.1, 0.03)
    error = signed_trim_error(Twist(*size.tolist()), trim.velocity)
    return replace(
        trim, error=error, statistics=_statistics(("forward", "side", "yaw_rate"), [0.0] * 3, size.tolist())
    )


def _flown(library: Library, row: Maneuver, rng: np.random.Generator, shrunken: float) -> Maneuver:
    edge, size = true_edge(library, row), np.array([0.2, 0.3, 0.3, 0.05])
    size = size * scatter(edge.reached) * shrunken
    mean = np.array(TRUTH.maneuver(edge)) + 0.1 * size * rng.uniform(-1, 1, 4)
    size = size * rng.uniform(0.85, 1.15, 4)
    error = signed_maneuver_error(ManeuverError(*size.tolist()), left=edge.left, reached=edge.reached)
    names = ("duration", "forward", "side", "heading_change")
    return replace(
        row,
        duration=float(mean[0]),
        displacement=SE2(*mean[1:].tolist()),
        error=error,
        statistics=_statistics(names, mean.tolist(), size.tolist()),
    )


def true_edge(library: Library, row: Maneuver) -> Edge:
    rule = library.conditions.maneuver_end
    assert rule is not None
    left, reached = library.trim(row.from_trim), library.trim(row.to_trim)
    return Edge(left.velocity, reached.velocity, rule.bands[row.to_trim])


@pytest.fixture(scope="module")
def grown() -> Growth:
    return grow(flown_library(), speed_step=4 * FOOT, yaw_rate_step=0.1, name="grown")


def held(library: Library) -> float:
    """Returns the share of grown maneuvers whose true values, with true scatter, are inside the bounds."""
    inside = []
    for row in library.maneuvers:
        if row.notes != GROWN:
            continue
        edge = true_edge(library, row)
        truth = TRUTH.maneuver(edge)
        spread = np.array([0.2, 0.3, 0.3, 0.05]) * scatter(edge.reached)
        own = (row.duration, row.displacement.x, row.displacement.y, row.displacement.heading)
        error = (row.error.duration, row.error.forward, row.error.side, row.error.heading_change)
        inside.append((np.abs(np.subtract(own, truth)) + spread <= np.abs(error)).all())
    return float(np.mean(inside))


def test_a_grown_library_has_many_trims_and_maneuvers(grown: Growth) -> None:
    assert len(grown.library.trims) >= 70
    assert len(grown.library.maneuvers) >= 500


def test_grown_bounds_hold_the_true_vehicle(grown: Growth) -> None:
    assert held(grown.library) >= 0.95


def test_bounds_grown_from_shrunken_ones_do_not(grown: Growth) -> None:
    """The negative control."""
    small = grow(flown_library(shrunken=0.5), speed_step=4 * FOOT, yaw_rate_step=0.1, name="small")
    assert held(small.library) < 0.5


def test_what_was_flown_stays_as_it_is(grown: Growth) -> None:
    flown = flown_library()
    assert grown.library.trims[: len(flown.trims)] == flown.trims
    assert grown.library.maneuvers[: len(flown.maneuvers)] == flown.maneuvers


def test_grown_primitives_claim_no_coverage(grown: Growth) -> None:
    new = [row for row in grown.library.maneuvers if row.notes == GROWN]
    assert len(new) == grown.maneuvers > 0
    assert all(row.statistics is None for row in new)


def test_no_grown_trim_is_outside_the_flown_range(grown: Growth) -> None:
    flown = flown_library().trims
    for trim in grown.library.trims:
        assert trim.velocity.forward <= max(one.velocity.forward for one in flown)
        nearest = min(
            abs(trim.velocity.forward - one.velocity.forward) / (8 * FOOT)
            + abs(trim.velocity.yaw_rate - one.velocity.yaw_rate) / 0.2
            for one in flown
        )
        assert nearest <= 1.1


def test_a_library_without_evidence_does_not_grow() -> None:
    with pytest.raises(CannotGrowError, match="statistics of at least 8 trims"):
        grow(turns_automaton(wind="calm", altitude=30.0), speed_step=1.0, yaw_rate_step=0.1, name="none")


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
    rest = np.arange(25) != 3
    without = RBFInterpolator(points[rest], values[rest], kernel="linear", degree=1, smoothing=smooth)
    assert spline.left_out[3] == pytest.approx(values[3] - without(points[3:4])[0], abs=1e-7)


def test_trends_are_read_off_the_primitives_flown() -> None:
    library = flown_library()
    seen = trends(library, speed_step=8 * FOOT, rate_step=0.1)
    assert [round(row.speed / FOOT) for row in seen.speed_errors] == [0, 8, 16, 24]
    assert seen.speed_errors[0].percent is None
    assert len(seen.speed_steps) == 6
    assert len(seen.turn_steps) == 24
    for row in seen.speed_steps:
        assert row.percent == pytest.approx(100 * row.error / row.displacement)
