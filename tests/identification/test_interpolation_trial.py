"""Tests of claims of interpolated primitives with known truth and shrunken bounds."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import beta, binom, norm

from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flight.automaton.maneuver import ManeuverError
from flight.automaton.statistics import ScalarStatistics, Statistics
from flight.automaton.trim import Trim
from flight.errors import FlightError
from flight.se2 import Twist
from flight.units import FOOT
from flightlog.file.writer import write_log
from identification.design.interpolation_schedule import PrimitiveSample, draw_sample, sampled_schedule
from identification.design.trend_automaton import turns_automaton
from identification.interpolation.interpolate import interpolate_library
from identification.interpolation.interpolated_trims import interpolate_trims
from identification.interpolation.interpolation_claim import calibrate_claim
from identification.interpolation.trim_scatter import TrimScatter, trim_scatter
from identification.interpolation_trial import interpolation_trials
from identification.segmentation.flight_evidence import FlightEvidence, extract_evidence
from identification.statistics.coverage import most_exceedances, order_statistic_coverage
from maneuver.app import run
from tests.support.planted_flights import PlantedDeviations, planted_log
from tests.support.synthetic_growth import flown_library
from tests.support.synthetic_growth import scatter as spread

FLIGHTS = 12
SCALES = np.array([0.05, 0.05, 0.015])


def test_the_share_held_is_exact_for_any_continuous_law() -> None:
    """Tests that 59 draws are the fewest for 95 % coverage."""
    assert (
        order_statistic_coverage(59, exceeding=0, confidence=0.95)
        >= 0.95
        > order_statistic_coverage(58, exceeding=0, confidence=0.95)
    )
    assert order_statistic_coverage(262, exceeding=7, confidence=0.95) == pytest.approx(
        beta.ppf(0.05, 255, 8)
    )
    assert order_statistic_coverage(3, exceeding=3, confidence=0.95) == 0.0


@given(st.integers(1, 500), st.floats(0.5, 0.99), st.floats(0.5, 0.99))
@settings(deadline=None)
def test_the_number_exceeding_is_the_largest_for_the_coverage(
    count: int, coverage: float, confidence: float
) -> None:
    most = most_exceedances(count, coverage=coverage, confidence=confidence)
    if most:
        assert order_statistic_coverage(count, exceeding=most, confidence=confidence) >= coverage
    assert order_statistic_coverage(count, exceeding=most + 1, confidence=confidence) < coverage


@pytest.mark.parametrize("count", [44, 262])
def test_of_claims_at_95_percent_confidence_one_in_twenty_is_too_large(count: int) -> None:
    """Uses uniform scores, so the true share is the factor minus 1."""
    rng = np.random.default_rng(3)
    wrong = 0
    for _ in range(2000):
        scores = rng.uniform(1.0, 2.0, count)
        claim = calibrate_claim(scores, flights=12, coverage=0.95, confidence=0.95)
        wrong += claim.factor - 1.0 < claim.coverage
    assert binom.sf(wrong - 1, 2000, 0.05) > 0.001
    assert binom.cdf(wrong, 2000, 0.05) > 0.001


def scattering(
    rng: np.random.Generator, *, tails: float = 1.0
) -> tuple[list[Trim], TrimScatter, dict[int, np.ndarray]]:
    """Returns trims entered by interpolated maneuvers, their bounds and tails.

    The wind's part is normal, with sizes that vary smoothly and a little at random; tails are arbitrary, and
    larger for interpolated maneuvers.
    """
    automaton = turns_automaton(wind="calm", altitude=30.0)
    rule = automaton.conditions.maneuver_end
    assert rule is not None
    left = {trim.id: random_transient(rng) for trim in automaton.trims}
    flown = [flown_trim(trim, left[trim.id], rng) for trim in automaton.trims]
    new, _ = interpolate_trims(flown, rule, speed_step=4 * FOOT, yaw_rate_step=0.1)
    wanted = [*flown, *new]
    longer = {trim.id: 1.5 * left.get(trim.id, random_transient(rng)) for trim in wanted}
    scatter = trim_scatter(
        flown,
        wanted,
        tails_flown=tails * np.array([left[trim.id] for trim in flown]),
        tails_wanted=tails * np.array([longer[trim.id] for trim in wanted]),
        coverage=0.95,
        confidence=0.95,
    )
    return wanted, scatter, longer


def random_transient(rng: np.random.Generator) -> np.ndarray:
    return np.asarray(SCALES * (rng.uniform(0, 5), 0.0, rng.uniform(0, 5)))


def sizes(velocity: Twist, rng: np.random.Generator) -> np.ndarray:
    return np.asarray(SCALES * spread(velocity) * np.exp(0.1 * rng.standard_normal(3)))


def flown_trim(trim: Trim, left: np.ndarray, rng: np.random.Generator) -> Trim:
    drawn = sizes(trim.velocity, rng) * rng.standard_normal((FLIGHTS, 3))
    names = ("forward", "side", "yaw_rate")
    furthest = np.hypot(np.abs(drawn).max(axis=0), left).tolist()
    scalars = tuple(ScalarStatistics(name, 0.0, 1.0, far) for name, far in zip(names, furthest, strict=True))
    return replace(trim, statistics=Statistics(FLIGHTS, 0, 0.6, 0.95, scalars))


def share_that_holds(
    trims: list[Trim],
    scatter: TrimScatter,
    tails: dict[int, np.ndarray],
    rng: np.random.Generator,
    *,
    shrunken: float = 1.0,
) -> float:
    """Returns the expected share of trims with 12 flights inside."""
    inside = []
    for trim in trims:
        bound = shrunken * scatter.sizes[trim.id]
        room = np.sqrt(np.maximum(bound**2 - tails[trim.id] ** 2, 0.0))
        once = np.prod(2 * norm.cdf(room / sizes(trim.velocity, rng)) - 1)
        inside.append(once**FLIGHTS)
    return float(np.mean(inside))


def test_the_claim_of_interpolated_trims_holds_and_shrunken_bounds_do_not() -> None:
    rng = np.random.default_rng(7)
    less = shrunken = forgotten = 0
    for _ in range(60):
        trims, scatter, tails = scattering(rng)
        less += share_that_holds(trims, scatter, tails, rng) < scatter.claim.coverage
        shrunken += share_that_holds(trims, scatter, tails, rng, shrunken=0.7) < scatter.claim.coverage
        trims, scatter, tails = scattering(rng, tails=0.0)
        forgotten += share_that_holds(trims, scatter, tails, rng) < scatter.claim.coverage
    assert binom.sf(less - 1, 60, 0.05) > 0.001
    assert shrunken > 50
    assert forgotten > 30


@cache
def interpolated_library() -> Library:
    return interpolate_library(flown_library(), speed_step=4 * FOOT, yaw_rate_step=0.1, name="grown").library


def planted(library: Library, drawn: PrimitiveSample, *, flights: int, share: float) -> list[FlightEvidence]:
    """Returns flights with deviations up to a share of the bounds."""
    rng = np.random.default_rng(11)
    truth = interpolated_library()
    tours = sampled_schedule(truth, drawn, flights=flights, rng=rng, coasting_range=(2.0, 8.0), wind="calm")
    text, found = library_text(truth).encode(), []
    for number, tour in enumerate(tours):
        trims = {t.id: share * rng.uniform(-1, 1, 3) * error_of(t) for t in truth.trims}
        rows = {
            row.id: share
            * rng.uniform(-1, 1, 4)
            * (0.0, row.error.forward, row.error.side, row.error.heading_change)
            for row in truth.maneuvers
        }
        # A planted maneuver lasts longer than its dwell.
        for row in truth.maneuvers:
            rows[row.id][0] = max(0.0, 1.01 - row.duration)
        log = planted_log(truth, text, tour, PlantedDeviations(trims, rows), seed=number)
        found.append(extract_evidence(log, name=f"flight {number}", sha256=f"flight {number}"))
    assert library.conditions.maneuver_end == truth.conditions.maneuver_end
    return found


def error_of(trim: Trim) -> np.ndarray:
    return np.array([trim.error.forward, trim.error.side, trim.error.yaw_rate])


def shrink(library: Library, by: float) -> Library:
    rows = (
        replace(
            row,
            error=ManeuverError(*(by * np.array([e.duration, e.forward, e.side, e.heading_change])).tolist()),
        )
        for row in library.maneuvers
        for e in (row.error,)
    )
    trims = (replace(trim, error=Twist(*(by * error_of(trim)).tolist())) for trim in library.trims)
    return replace(library, trims=tuple(trims), maneuvers=tuple(rows))


def test_a_random_sample_inside_the_bounds_passes_and_shrunken_bounds_are_refuted() -> None:
    library = interpolated_library()
    drawn = draw_sample(library, most=20, rng=np.random.default_rng(1))
    flights = planted(library, drawn, flights=3, share=0.99)
    primitives, trials = interpolation_trials(library, drawn, flights)
    assert [(trial.kind, trial.drawn, trial.kept) for trial in trials] == [
        ("trim", 20, 20),
        ("maneuver", 20, 20),
    ]
    assert all(one.flights == 3 and one.kept for one in primitives)
    assert not any(trial.refuted for trial in trials)
    _, trials = interpolation_trials(shrink(library, 0.7), drawn, flights)
    assert all(trial.refuted for trial in trials)


def test_every_test_flight_has_every_primitive_drawn_and_enters_trims_as_flown_ones_are() -> None:
    library = interpolated_library()
    drawn = draw_sample(library, most=15, rng=np.random.default_rng(2))
    rng = np.random.default_rng(3)
    edges = {(row.from_trim, row.to_trim): row for row in library.maneuvers}
    ways_in = {trim: set[int]() for trim in drawn.trims}
    for tour in sampled_schedule(library, drawn, flights=4, rng=rng, coasting_range=(2.0, 8.0), wind="calm"):
        flown = [edges[edge] for edge in zip(tour.trims, tour.trims[1:], strict=False)]
        assert {row.id for row in flown} >= set(drawn.maneuvers)
        for trim in drawn.trims:
            entered = {row.id for row in flown if row.to_trim == trim}
            assert len(entered) >= 6
            ways_in[trim] |= entered
        assert len(flown) < 3 * (15 + 6 * 15)
    for trim, entered in ways_in.items():
        assert len(entered) > min(6, sum(edge[1] == trim for edge in edges) - 1)


def test_only_what_is_interpolated_is_drawn_and_the_seed_decides() -> None:
    library = interpolated_library()
    drawn = draw_sample(library, most=10_000, rng=np.random.default_rng(1))
    assert set(drawn.maneuvers) == {row.id for row in library.maneuvers if row.interpolated}
    assert set(drawn.trims) == {trim.id for trim in library.trims if trim.interpolated}
    some = [draw_sample(library, most=9, rng=np.random.default_rng(seed)) for seed in (4, 4, 5)]
    assert some[0] == some[1] != some[2]


def test_a_claim_for_twelve_flights_is_not_tested_with_more() -> None:
    library = interpolated_library()
    drawn = draw_sample(library, most=2, rng=np.random.default_rng(1))
    flights = planted(library, drawn, flights=13, share=0.5)
    with pytest.raises(
        FlightError, match="claim of interpolated trims: expected at most 12 flights each, got 13"
    ):
        interpolation_trials(library, drawn, flights)


def test_the_command_tests_an_interpolated_library_with_logs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    library = interpolated_library()
    drawn = draw_sample(library, most=12, rng=np.random.default_rng(1))
    tours = sampled_schedule(
        library,
        drawn,
        flights=2,
        rng=np.random.default_rng(2),
        coasting_range=(2.0, 8.0),
        wind="calm",
    )
    nothing = PlantedDeviations(
        {trim.id: np.zeros(3) for trim in library.trims},
        {row.id: np.array([max(0.0, 1.01 - row.duration), 0, 0, 0]) for row in library.maneuvers},
    )
    for number, tour in enumerate(tours):
        log = planted_log(library, library_text(library).encode(), tour, nothing, seed=number)
        write_log(log, tmp_path / f"{number}.mcap", force=False)
    path = tmp_path / "grown.json"
    path.write_text(library_text(library))
    assert run(("library", "test", str(path), "--flights", "13")) == 2
    assert "expected at most 12, the number in the claim of grown, got 13" in capsys.readouterr().err
    assert run(("library", "test", str(path), "--logs", str(tmp_path), "--json")) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["refuted"] is False
    assert {trial["kind"] for trial in document["interpolated"]} == {"trim", "maneuver"}
    content = json.loads(path.read_text())
    for row in content["maneuvers"]:
        row["displacement"]["forward"] += 2 * abs(row["error"]["forward"])
    path.write_text(json.dumps(content))
    assert run(("library", "test", str(path), "--logs", str(tmp_path))) == 1
    assert "REFUTED" in capsys.readouterr().out
