"""Tests of coverage claims with planted deviations and with altered bounds."""

import json
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom

from experiments.campaign.fly_campaign import campaign_library, specify_campaign
from flight.automaton.library import Library
from flight.automaton.library_file import library_text, parse_library
from flight.automaton.maneuver import ManeuverError
from flightlog.file.writer import write_log
from flightlog.log import FlightLog
from identification.coverage_trial import (
    NoClaimError,
    adjust_p_values,
    coverage_trials,
    maneuver_box,
    trim_box,
)
from identification.design.schedule import schedule
from identification.identify import InconsistentLogsError, identify
from identification.segmentation.flight_evidence import FlightEvidence, extract_evidence
from identification.statistics.box import Box, box_around, smallest_box
from identification.statistics.coverage import joint_coverage, samples_needed
from maneuver.app import run
from maneuver.library.trial import new_flights
from scenarios.find import find_campaign
from tests.support.deviation_laws import LAWS, Law
from tests.support.planted_flights import PlantedDeviations, planted_log

CAMPAIGN = find_campaign("gtmax")
LIBRARY = campaign_library(CAMPAIGN, "gtmax")
TRIM_SCALE = np.array([0.03, 0.02, 0.004])
MANEUVER_SCALE = np.array([0.03, 0.1, 0.07, 0.02])


@cache
def planted_flights(count: int, seed: int, law: Law = LAWS[0]) -> tuple[FlightLog, ...]:
    """Returns logs with deviations of a law, scaled differently per primitive."""
    rng = np.random.default_rng((17, seed))
    tours = schedule(LIBRARY, flights=count, rng=rng, coasting_range=(2.0, 8.0), wind="gtmax")
    text = library_text(LIBRARY).encode()
    logs = []
    for number, tour in enumerate(tours):
        trims = {trim.id: law.draw(rng, 1, 3)[0] * TRIM_SCALE * trim.id for trim in LIBRARY.trims}
        rows = {row.id: law.draw(rng, 1, 4)[0] * MANEUVER_SCALE * (row.id % 5) for row in LIBRARY.maneuvers}
        logs.append(
            planted_log(LIBRARY, text, tour, PlantedDeviations(trims, rows), seed=1000 * seed + number)
        )
    return tuple(logs)


def cut(logs: Sequence[FlightLog], *, name: str) -> list[FlightEvidence]:
    return [extract_evidence(log, name=f"{name} {n}", sha256=f"{name} {n}") for n, log in enumerate(logs)]


@pytest.fixture(scope="module")
def library() -> Library:
    flights = cut(planted_flights(183, seed=1), name="old")
    return identify(flights[30:], nominal=flights[:30], name="planted")


@pytest.fixture(scope="module")
def new() -> list[FlightEvidence]:
    return cut(planted_flights(300, seed=2), name="new")


def with_maneuver_errors(library: Library, errors: Sequence[ManeuverError]) -> Library:
    rows = zip(library.maneuvers, errors, strict=True)
    return replace(library, maneuvers=tuple(replace(row, error=error) for row, error in rows))


def test_a_planted_deviation_is_found_as_it_was_planted() -> None:
    rng = np.random.default_rng(5)
    (tour,) = schedule(LIBRARY, flights=1, rng=rng, coasting_range=(2.0, 8.0), wind="gtmax")
    trims = {trim.id: rng.normal(size=3) * TRIM_SCALE for trim in LIBRARY.trims}
    rows = {row.id: rng.normal(size=4) * MANEUVER_SCALE for row in LIBRARY.maneuvers}
    log = planted_log(LIBRARY, library_text(LIBRARY).encode(), tour, PlantedDeviations(trims, rows), seed=1)
    (flight,) = cut([log], name="planted")
    for segment in flight.segments.maneuvers:
        truth = next(row for row in LIBRARY.maneuvers if row.id == segment.id)
        late, forward, side, turned = rows[segment.id]
        assert segment.settled
        assert segment.duration == pytest.approx(truth.duration + late, abs=1e-9)
        assert segment.displacement.x == pytest.approx(truth.displacement.x + forward, abs=1e-9)
        assert segment.displacement.y == pytest.approx(truth.displacement.y + side, abs=1e-9)
        assert segment.displacement.heading == pytest.approx(truth.displacement.heading + turned, abs=1e-9)
    for coast in flight.segments.coasts:
        velocity = LIBRARY.trim(coast.trim).velocity
        off = coast.velocity - [velocity.forward, velocity.side, velocity.yaw_rate]
        assert np.abs(off).max(axis=0) == pytest.approx(np.abs(trims[coast.trim]), abs=1e-12)


def test_at_95_95_every_primitive_states_its_claim_and_evidence(library: Library) -> None:
    for trim in library.trims:
        assert trim.statistics is not None
        assert (trim.statistics.centre, trim.statistics.support) == ("command", 3)
        assert trim.statistics.coverage == joint_coverage(153, support=3, confidence=0.95)
    for row in library.maneuvers:
        assert row.statistics is not None
        assert (row.statistics.centre, row.statistics.support) == ("nominal flights", 4)
        assert row.statistics.coverage >= 0.95
    assert len(library.provenance["nominal"]) == 30


def test_what_a_library_claims_survives_its_file(library: Library) -> None:
    assert parse_library(library_text(library), "text") == library


def test_new_flights_do_not_refute_a_library_that_was_identified(
    library: Library, new: list[FlightEvidence]
) -> None:
    trials = coverage_trials(library, new)
    assert [(trial.kind, trial.id) for trial in trials] == [
        *(("trim", trim.id) for trim in library.trims),
        *(("maneuver", row.id) for row in library.maneuvers),
    ]
    for trial in trials:
        assert trial.flights == 300
        assert trial.low < trial.inside / 300 <= trial.high
        assert not trial.refuted


def test_new_flights_refute_shrunken_bounds(library: Library, new: list[FlightEvidence]) -> None:
    small = [
        ManeuverError(*(0.7 * np.array([e.duration, e.forward, e.side, e.heading_change])).tolist())
        for e in (row.error for row in library.maneuvers)
    ]
    trials = coverage_trials(with_maneuver_errors(library, small), new)
    assert sum(trial.refuted for trial in trials if trial.kind == "maneuver") > 11
    assert not any(trial.refuted for trial in trials if trial.kind == "trim")


def test_new_flights_refute_shuffled_bounds(library: Library, new: list[FlightEvidence]) -> None:
    errors = [row.error for row in library.maneuvers]
    trials = coverage_trials(with_maneuver_errors(library, errors[1:] + errors[:1]), new)
    assert sum(trial.refuted for trial in trials) > 4


def test_a_flight_that_did_not_settle_or_was_lost_counts_as_outside(
    library: Library, new: list[FlightEvidence]
) -> None:
    lost = replace(new[0], header=replace(new[0].header, outcome="flight lost"))
    before, after = coverage_trials(library, new), coverage_trials(library, [lost, *new[1:]])
    for left, right in zip(before, after, strict=True):
        assert right.flights == left.flights
        assert right.unsettled == left.unsettled + 1
        assert left.inside - 1 <= right.inside <= left.inside


def test_flights_that_gave_the_bounds_cannot_test_them(library: Library) -> None:
    old = cut(planted_flights(183, seed=1)[:2], name="old")
    with pytest.raises(
        InconsistentLogsError, match="old 0: expected a new flight, got one from which planted was identified"
    ):
        coverage_trials(library, old)


def test_a_library_from_a_book_claims_nothing(new: list[FlightEvidence]) -> None:
    with pytest.raises(NoClaimError, match="expected primitives with statistics to test, got none"):
        coverage_trials(LIBRARY, new)


def test_only_what_claims_is_tested(library: Library, new: list[FlightEvidence]) -> None:
    partial = replace(library, trims=tuple(replace(trim, statistics=None) for trim in library.trims))
    assert {trial.kind for trial in coverage_trials(partial, new)} == {"maneuver"}


@given(st.lists(st.floats(0, 1), min_size=1, max_size=30))
def test_holms_correction_keeps_the_order_and_lies_between_no_correction_and_bonferronis(
    p_values: list[float],
) -> None:
    corrected = adjust_p_values(p_values)
    for p_value, larger in zip(p_values, corrected, strict=True):
        assert p_value <= larger <= min(1.0, len(p_values) * p_value)
    order = sorted(range(len(p_values)), key=p_values.__getitem__)
    assert all(corrected[a] <= corrected[b] for a, b in pairwise(order))
    assert min(corrected) == min(1.0, len(p_values) * min(p_values))


def covering_less(law: Law, boxes: Sequence[Box]) -> int:
    return sum(law.inside(box.centre - box.size, box.centre + box.size) < 0.95 for box in boxes)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_of_200_primitives_that_claim_95_95_at_most_21_cover_less(law: Law) -> None:
    """Allows 21 failures: ten are expected, more have P < 0.001."""
    assert binom.sf(21, 200, 0.05) < 0.001
    rng = np.random.default_rng(95)
    separate, together = [], []
    for _ in range(200):
        centre = law.draw(rng, 30, 4).mean(axis=0)
        drawn = law.draw(rng, samples_needed(0.95, support=4, confidence=0.95), 4)
        separate.append(box_around(centre, drawn, drawn))
        drawn = law.draw(rng, samples_needed(0.95, support=8, confidence=0.95), 4)
        together.append(smallest_box(drawn, drawn))
    sizes = [box.size / law.quantile(0.95, 4) for box in separate]
    assert covering_less(law, separate) <= 21
    assert covering_less(law, together) <= 21
    assert np.median(sizes) <= 1.5
    # Negative controls: too small boxes, and boxes with swapped scalars.
    assert covering_less(law, [replace(box, size=0.75 * box.size) for box in separate]) > 21
    uneven = np.array([1.0, 3.0, 1.0, 3.0])
    swapped = [replace(box, size=np.roll(box.size * uneven, 1) / uneven) for box in separate]
    assert covering_less(law, swapped) > 21


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_the_coverage_of_a_law_is_what_samples_of_it_show(law: Law) -> None:
    low, high = np.array([-1.0, -0.7, -2.0, -0.9]), np.array([1.5, 2.0, 0.8, 1.2])
    drawn = law.draw(np.random.default_rng(4), 200_000, 4)
    share = ((low <= drawn) & (drawn <= high)).all(axis=1).mean()
    assert law.inside(low, high) == pytest.approx(share, abs=0.005)
    assert np.abs(drawn.mean(axis=0)).max() < 0.02


def test_the_flights_that_test_a_library_are_none_of_its_own(library: Library) -> None:
    ordered = specify_campaign(CAMPAIGN, LIBRARY, seed=1, flights=50, wind="gtmax")
    fresh = new_flights(library, seed=1, flights=50, wind="gtmax")
    assert {flight.seed for flight in ordered}.isdisjoint(flight.seed for flight in fresh)
    assert {flight.trims for flight in ordered} != {flight.trims for flight in fresh}
    times = [time for flight in fresh for time in flight.coasting_times]
    assert 2.0 <= min(times) < 2.1
    assert 7.9 < max(times) <= 8.0


def test_the_boxes_of_a_library_hold_its_values(library: Library) -> None:
    for trim in library.trims:
        box = trim_box(trim)
        assert box.contains(box.centre[None], box.centre[None]).all()
    row = library.maneuvers[0]
    assert maneuver_box(row).size[0] == -row.error.duration


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    old, fresh = tmp_path_factory.mktemp("old"), tmp_path_factory.mktemp("new")
    for folder, seed in ((old, 1), (fresh, 2)):
        for number, log in enumerate(planted_flights(183 if seed == 1 else 300, seed=seed)[:24]):
            write_log(log, folder / f"{number:02d}.mcap", force=False)
    return old, fresh


def test_a_claim_weaker_than_asked_for_ends_with_1_and_is_named(
    folders: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = str(tmp_path / "few.json")
    assert run(("identify", str(folders[0]), "--coverage", "0.95", "--out", out)) == 1
    claim = joint_coverage(24, support=8, confidence=0.95)
    message = (
        f"maneuver 22: expected coverage >= 0.95, got {claim:.3f} from 24 flights, "
        "0 of them lost or not settled"
    )
    assert message in capsys.readouterr().err
    assert run(("identify", str(folders[0]), "--coverage", "0.5", "--out", out, "--force")) == 0
    assert run(("identify", str(folders[0]), "--coverage", "95", "--out", out, "--force")) == 2


def test_the_command_tests_a_library_with_logs(
    folders: tuple[Path, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "few.json"
    assert run(("identify", str(folders[0]), "--out", str(path))) == 0
    capsys.readouterr()
    assert run(("library", "test", str(path), "--logs", str(folders[1]), "--json")) == 0
    document = json.loads(capsys.readouterr().out)
    assert (document["flights"], document["refuted"], len(document["trials"])) == (24, False, 29)
    content = json.loads(path.read_text())
    for row in content["maneuvers"]:
        row["error"] = {name: 0.1 * size for name, size in row["error"].items()}
    path.write_text(json.dumps(content))
    assert run(("library", "test", str(path), "--logs", str(folders[1]))) == 1
    assert "its claim is refuted for maneuver 1, " in capsys.readouterr().out
    assert run(("library", "test", str(path), "--logs", str(folders[0]))) == 2
    capsys.readouterr()
    assert run(("library", "test", "thesis-gtmax")) == 2
    assert "thesis-gtmax: expected primitives with statistics" in capsys.readouterr().err
