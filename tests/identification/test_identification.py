"""Tests of identification with flights of known closed-form truth."""

from dataclasses import replace
from itertools import pairwise
from math import exp

import numpy as np
import pytest

from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flight.automaton.maneuver_end import ManeuverEnd
from flight.automaton.statistics import Statistics
from flight.mission.sequence import Sequence
from flightlog.log import FlightLog
from identification.data_sheet import data_sheet
from identification.design.schedule import schedule
from identification.identify import InconsistentLogsError, identify
from identification.segmentation.flight_evidence import FlightEvidence, extract_evidence
from identification.segmentation.segmentation import CoastSegment, segment
from identification.statistics.coast_errors import running_average
from identification.statistics.coverage import joint_coverage
from identification.statistics.samples import NeverFlownError
from tests.support.synthetic_log import BREEZE, STILL, FlightNoise, synthetic_library, synthetic_log

LIBRARY = synthetic_library()


def tours(flights: int, seed: int = 5) -> tuple[Sequence, ...]:
    rng = np.random.default_rng(seed)
    return schedule(LIBRARY, flights=flights, rng=rng, coasting_range=(1.0, 3.0), wind="calm")


def flown(flights: int, noise: FlightNoise = BREEZE, library: Library = LIBRARY) -> list[FlightLog]:
    return [
        synthetic_log(library, tour.trims, tour.coasting_times, seed=seed, noise=noise, start=tour.start)
        for seed, tour in enumerate(tours(flights))
    ]


def gathered(logs: list[FlightLog]) -> list[FlightEvidence]:
    return [
        extract_evidence(log, name=f"log {place}", sha256=f"{place:064x}") for place, log in enumerate(logs)
    ]


@pytest.fixture(scope="module")
def logs() -> list[FlightLog]:
    return flown(8)


@pytest.fixture(scope="module")
def identified(logs: list[FlightLog]) -> Library:
    return identify(gathered(logs), name="test")


def test_a_maneuver_flown_twice_in_a_flight_is_one_sample() -> None:
    lacking = replace(LIBRARY, maneuvers=LIBRARY.maneuvers[1:])
    plan = schedule(lacking, flights=5, rng=np.random.default_rng(1), coasting_range=(1.0, 3.0), wind="calm")
    flights = gathered(
        [
            synthetic_log(lacking, tour.trims, tour.coasting_times, seed=seed, start=tour.start)
            for seed, tour in enumerate(plan)
        ]
    )
    assert {claim.samples for claim in claim_statistics(identify(flights, name="lacking"))} == {5}


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
    """Compares second-order steps with the closed form on a fine grid."""
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


def impatient_library() -> Library:
    """Returns a library with a time-out too short for some maneuvers."""
    rule = LIBRARY.conditions.maneuver_end
    assert rule is not None
    narrow = {trim: replace(band, forward=0.13) for trim, band in rule.bands.items()}
    impatient = ManeuverEnd(narrow, dwell=rule.dwell, timeout=5.0)
    return replace(LIBRARY, conditions=replace(LIBRARY.conditions, maneuver_end=impatient))


def test_a_maneuver_that_does_not_settle_is_counted_listed_and_weakens_the_claim() -> None:
    result = identify(gathered(flown(16, library=impatient_library())), name="impatient")
    listed = result.provenance["unsettled"]
    assert 3 < len(listed) < 22
    for row in result.maneuvers:
        found, seeds = row.statistics, listed.get(str(row.id), [])
        assert found is not None
        assert (found.samples, found.timeouts, found.discarded) == (16, len(seeds), len(seeds))
        whole = joint_coverage(16, support=8, confidence=0.95)
        assert found.coverage < whole if seeds else found.coverage == whole


def test_a_maneuver_that_never_settles_is_named() -> None:
    rule = LIBRARY.conditions.maneuver_end
    assert rule is not None
    hopeless = ManeuverEnd(rule.bands, dwell=rule.dwell, timeout=0.6)
    library = replace(LIBRARY, conditions=replace(LIBRARY.conditions, maneuver_end=hopeless))
    with pytest.raises(NeverFlownError, match=r"expected trim \d in at least one log, got none"):
        identify(gathered(flown(2, library=library)), name="hopeless")


def test_a_lost_flight_weakens_every_claim() -> None:
    logs = flown(12)
    lost = FlightLog(replace(logs[3].header, outcome="flight lost"), logs[3].series, logs[3].attachments)
    result = identify(gathered([*logs[:3], lost, *logs[4:]]), name="lost")
    assert result.provenance["lost"] == [logs[3].header.seed]
    for statistics in claim_statistics(result):
        assert (statistics.samples, statistics.discarded) == (12, 1)
        whole = joint_coverage(12, support=statistics.support or 0, confidence=0.95)
        assert statistics.coverage < whole


def claim_statistics(library: Library) -> list[Statistics]:
    found = [trim.statistics for trim in library.trims]
    found += [row.statistics for row in library.maneuvers]
    return [entry for entry in found if entry is not None]


def test_values_from_flights_of_their_own_make_the_same_flights_claim_more(logs: list[FlightLog]) -> None:
    flights = gathered(logs)
    split = identify(flights[3:], nominal=flights[:3], name="split")
    assert split.provenance["nominal"] == [0, 1, 2]
    means = identify(flights[:3], name="three")
    for row, mean in zip(split.maneuvers, means.maneuvers, strict=True):
        assert row.statistics is not None
        assert mean.statistics is not None
        assert row.statistics.centre == "nominal flights"
        assert (row.statistics.samples, row.statistics.support) == (5, 4)
        values = {scalar.name: scalar.mean for scalar in mean.statistics.scalars}
        assert row.duration == pytest.approx(values["duration"], abs=1e-12)
        assert row.displacement.y == pytest.approx(values["side"], abs=1e-12)
    whole = identify(flights[3:], name="whole").maneuvers[0].statistics
    assert whole is not None
    assert whole.centre == "same flights"
    assert whole.support == 8


def test_averages_over_a_coast_are_bounded_by_its_duration_and_smaller_than_instants() -> None:
    flights = gathered(flown(20))
    instants = identify(flights, name="instants")
    averages = identify(flights, name="averages", trim_errors="averaged")
    assert instants.conditions.trim_error_kind == "instantaneous"
    assert averages.conditions.trim_error_kind == "averaged"
    shortest = min(coast.duration for flight in flights for coast in flight.segments.coasts)
    first, last = 0.0, 0.0
    for instant, average in zip(instants.trims, averages.trims, strict=True):
        assert instant.averaged == average.averaged
        assert instant.averaged[0].shortest == shortest
        sizes = [abs(part.error.side) for part in average.averaged]
        assert max(sizes) == abs(average.error.side) < abs(instant.error.side)
        first, last = first + sizes[0], last + sizes[-1]
    assert last < first


def test_the_averages_of_a_coast_are_those_of_its_beginnings() -> None:
    time = np.linspace(0.0, 4.0, 201)
    velocity = np.column_stack([time, 0.5 * time**2, np.ones_like(time)])
    durations, averages = running_average(CoastSegment(1, 0.0, 4.0, velocity))
    assert durations == pytest.approx(time[1:])
    assert averages[:, 0] == pytest.approx(durations / 2)
    # The trapezoid of a parabola is too large by step^2 / 12 of its curvature.
    assert averages[:, 1] == pytest.approx(durations**2 / 6, abs=0.02**2 / 12 + 1e-12)
    assert averages[:, 2] == pytest.approx(1.0)


def test_the_estimate_may_be_judged_instead_of_the_truth(logs: list[FlightLog]) -> None:
    heard = [
        extract_evidence(log, name=f"log {n}", sha256=f"{n:064x}", of="estimate")
        for n, log in enumerate(logs)
    ]
    library = identify(heard, name="believed")
    assert "believed motion" in library.description
    blind = [
        FlightLog(log.header, {**log.series, "/truth": log.series["/truth"]}, log.attachments) for log in logs
    ]
    for log in blind:
        truth = log.series["/truth"]
        truth_free = replace(truth, values=np.zeros_like(truth.values))
        log.series["/truth"] = truth_free  # type: ignore[index]
    again = [
        extract_evidence(log, name=f"log {n}", sha256=f"{n:064x}", of="estimate")
        for n, log in enumerate(blind)
    ]
    assert library_text(identify(again, name="believed")) == library_text(library)
    assert library_text(identify(gathered(logs), name="believed")) != library_text(library)


def test_a_maneuver_never_flown_is_named() -> None:
    log = synthetic_log(LIBRARY, [1, 2, 1], [2.0, 2.0, 2.0], seed=1)
    with pytest.raises(NeverFlownError, match="expected trim 3 in at least one log, got none"):
        identify(gathered([log]), name="short")


def test_logs_of_different_winds_make_no_library(logs: list[FlightLog]) -> None:
    other = FlightLog(replace(logs[1].header, wind="severe"), logs[1].series, logs[1].attachments)
    with pytest.raises(InconsistentLogsError, match="log 1: expected wind calm as in log 0, got severe"):
        identify(gathered([logs[0], other]), name="mixed")


def test_the_same_flight_twice_is_refused(logs: list[FlightLog]) -> None:
    twice = [extract_evidence(logs[0], name=name, sha256="ab") for name in ("a", "b")]
    with pytest.raises(InconsistentLogsError, match="b is the same flight as a"):
        identify(twice, name="twice")


def test_the_data_sheet_lists_every_primitive(identified: Library) -> None:
    sheet = data_sheet(identified)
    assert sheet.count("→") == 22
    assert "fast right turn" in sheet
    assert "| coverage |" in sheet
