"""Identification from logs alone, held to flights whose truth is known in closed form."""

from collections import Counter
from dataclasses import replace
from itertools import pairwise
from math import exp

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binom

from flight.library import Library
from flight.library_file import library_text
from flight.log import FlightLog
from flight.maneuver_end import ManeuverEnd
from flight.sequence import Sequence
from identification.bounds import joint_coverage
from identification.data_sheet import data_sheet
from identification.identify import (
    FlightEvidence,
    InconsistentLogsError,
    NeverFlownError,
    evidence,
    identify,
)
from identification.schedule import NoClosedTourError, schedule
from identification.segmentation import segment
from tests.synthetic_log import BREEZE, STILL, Noise, synthetic_library, synthetic_log

LIBRARY = synthetic_library()


def tours(flights: int, seed: int = 5) -> tuple[Sequence, ...]:
    rng = np.random.default_rng(seed)
    return schedule(LIBRARY, flights=flights, rng=rng, coasting_range=(1.0, 3.0), wind="calm")


def flown(flights: int, noise: Noise = BREEZE, library: Library = LIBRARY) -> list[FlightLog]:
    return [
        synthetic_log(library, tour.trims, tour.coasting_times, seed=seed, noise=noise, start=tour.start)
        for seed, tour in enumerate(tours(flights))
    ]


def gathered(logs: list[FlightLog]) -> list[FlightEvidence]:
    return [evidence(log, name=f"log {place}", sha256=f"{place:064x}") for place, log in enumerate(logs)]


@pytest.fixture(scope="module")
def logs() -> list[FlightLog]:
    return flown(8)


@pytest.fixture(scope="module")
def identified(logs: list[FlightLog]) -> Library:
    return identify(gathered(logs), name="test")


def test_every_flight_uses_every_maneuver_once() -> None:
    for tour in tours(20):
        edges = Counter(maneuver.id for maneuver in LIBRARY.maneuvers_along(tour.trims))
        assert edges == Counter(range(1, 23))


def test_flights_differ_in_order_start_and_heading() -> None:
    drawn = tours(60)
    assert len({tour.trims for tour in drawn}) == 60
    assert {tour.trims[0] for tour in drawn} == set(range(1, 8))
    assert len({tour.start.heading for tour in drawn}) == 60


def test_an_automaton_without_a_closed_tour_is_refused() -> None:
    one_way = replace(LIBRARY, maneuvers=LIBRARY.maneuvers[1:])
    with pytest.raises(NoClosedTourError, match="as many maneuvers leave each trim as lead to it"):
        schedule(one_way, flights=1, rng=np.random.default_rng(1), coasting_range=(1.0, 3.0), wind="calm")


def test_bounds_contain_every_observation(logs: list[FlightLog], identified: Library) -> None:
    for log in logs:
        segments = segment(log)
        for maneuver in segments.maneuvers:
            row = next(row for row in identified.maneuvers if row.id == maneuver.id)
            assert abs(maneuver.duration - row.duration) <= abs(row.error.duration)
            assert abs(maneuver.displacement.x - row.displacement.x) <= abs(row.error.forward)
            assert abs(maneuver.displacement.y - row.displacement.y) <= abs(row.error.side)
            assert abs(maneuver.displacement.heading - row.displacement.heading) <= abs(
                row.error.heading_change
            )
        for coast in segments.coasts:
            trim = identified.trim(coast.trim)
            centre = [trim.velocity.forward, trim.velocity.side, trim.velocity.yaw_rate]
            size = [abs(trim.error.forward), abs(trim.error.side), abs(trim.error.yaw_rate)]
            assert (np.abs(coast.velocity - centre) <= size).all()


def test_every_edge_is_sampled_equally(identified: Library) -> None:
    assert {maneuver.statistics.samples for maneuver in identified.maneuvers if maneuver.statistics} == {8}


def test_the_order_of_the_logs_does_not_matter(logs: list[FlightLog], identified: Library) -> None:
    assert library_text(identify(reversed(gathered(logs)), name="test")) == library_text(identified)


def test_the_reference_model_is_found_again_in_still_air() -> None:
    """Velocity steps of a second-order model, whose settling times a fine grid of the closed form gives."""
    rule = LIBRARY.conditions.maneuver_end
    assert rule is not None
    walk = (1, 2, 3, 1, 3, 2, 1)
    segments = segment(synthetic_log(LIBRARY, walk, [15.0] * len(walk), seed=1, noise=STILL))
    times = np.arange(0, 8, 1e-3)
    for maneuver, (left, reached) in zip(segments.maneuvers, pairwise(walk), strict=True):
        before, after = LIBRARY.trim(left).velocity.forward, LIBRARY.trim(reached).velocity.forward
        response = after + (before - after) * _step_error(times)
        last_outside = times[np.abs(response - after) > rule.bands[reached].forward].max()
        # The log has a sample every 0.02 s: the band is entered up to one later, and the dwell likewise.
        assert last_outside + rule.dwell <= maneuver.duration <= last_outside + rule.dwell + 0.04
        flown = np.trapezoid(response[times <= maneuver.duration], dx=1e-3)
        assert maneuver.displacement.x == pytest.approx(flown, abs=0.03)
        assert maneuver.displacement.y == 0.0
        assert maneuver.displacement.heading == 0.0


def _step_error(times: np.ndarray) -> np.ndarray:
    natural, damping = 0.8, 0.8
    damped = natural * np.sqrt(1 - damping**2)
    decay = np.array([exp(-damping * natural * time) for time in times])
    error: np.ndarray = decay * (np.cos(damped * times) + damping * natural / damped * np.sin(damped * times))
    return error


def test_a_maneuver_that_does_not_settle_is_counted_not_dropped() -> None:
    rule = LIBRARY.conditions.maneuver_end
    assert rule is not None
    narrow = {trim: replace(band, forward=0.1) for trim, band in rule.bands.items()}
    impatient = ManeuverEnd(narrow, dwell=rule.dwell, timeout=4.2)
    library = replace(LIBRARY, conditions=replace(LIBRARY.conditions, maneuver_end=impatient))
    result = identify(gathered(flown(2, library=library)), name="impatient")
    counted = [maneuver.statistics for maneuver in result.maneuvers if maneuver.statistics]
    assert sum(statistics.timeouts for statistics in counted) > 10
    assert {statistics.samples for statistics in counted} == {2}
    assert max(maneuver.duration for maneuver in result.maneuvers) <= 4.2 + 1e-9


def test_a_maneuver_never_flown_is_named() -> None:
    log = synthetic_log(LIBRARY, [1, 2, 1], [2.0, 2.0, 2.0], seed=1)
    with pytest.raises(NeverFlownError, match="trim 3 is held in none of the 1 logs"):
        identify(gathered([log]), name="short")


def test_logs_of_different_winds_make_no_library(logs: list[FlightLog]) -> None:
    other = FlightLog(replace(logs[1].header, wind="severe"), logs[1].series, logs[1].attachments)
    with pytest.raises(InconsistentLogsError, match="log 1: wind is severe, in log 0 it is"):
        identify(gathered([logs[0], other]), name="mixed")


def test_the_same_flight_twice_is_refused(logs: list[FlightLog]) -> None:
    twice = [evidence(logs[0], name=name, sha256="ab") for name in ("a", "b")]
    with pytest.raises(InconsistentLogsError, match="b is the same flight as a"):
        identify(twice, name="twice")


@given(st.integers(1, 3000), st.integers(1, 12), st.floats(0.5, 0.999))
@settings(max_examples=300)
def test_the_coverage_inverts_the_binomial_tail(samples: int, support: int, confidence: float) -> None:
    coverage = joint_coverage(samples, support=support, confidence=confidence)
    if samples < support:
        assert coverage == 0.0
    else:
        tail = binom.cdf(support - 1, samples, 1 - coverage)
        assert tail == pytest.approx(1 - confidence, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(("support", "samples"), [(1, 59), (3, 124), (6, 208), (8, 260), (12, 361)])
def test_the_sample_sizes_of_the_scenario_bound(support: int, samples: int) -> None:
    """Samples needed for 95 % coverage with 95 % confidence, and one fewer is not enough."""
    assert joint_coverage(samples, support=support, confidence=0.95) >= 0.95
    assert joint_coverage(samples - 1, support=support, confidence=0.95) < 0.95


def test_the_data_sheet_lists_every_primitive(identified: Library) -> None:
    sheet = data_sheet(identified)
    assert sheet.count("→") == 22
    assert "fast right turn" in sheet
    assert "| coverage |" in sheet
