"""Tests of segmentation by motion, against commands and without any."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flight.automaton.library import Library
from flight.automaton.library_file import read_library
from flight.errors import FlightError
from flightlog.file.reader import read_log
from flightlog.file.writer import write_log
from flightlog.log import FlightLog, MissingTopicError
from flightlog.topics import COMMAND, MOTION, PRIMITIVE, TRUTH, WIND
from identification.design.schedule import schedule
from identification.segmentation.motion_matching import MotionModel, TrimGraph, match_walk
from identification.segmentation.motion_model import TooSlowLogError, sampled_motion
from identification.segmentation.motion_walk import trim_graph_of, walks_of
from identification.segmentation.second_order_response import StepResponse, fit_response
from identification.segmentation.segmentation import commanded_walk, cut_into_segments
from identification.segmentation.segmentation_score import Boundaries, boundaries_of, score_boundaries
from identification.segmentation.trim_discovery import NoTrimsError, discover_automaton
from maneuver.app import run
from tests.support.motion_log import motion_log
from tests.support.synthetic_log import synthetic_library, synthetic_log

LIBRARY = synthetic_library()
ROTORPY = Path(__file__).parents[1] / "data" / "rotorpy-5.csv.gz"


@pytest.fixture(scope="module")
def logs() -> list[FlightLog]:
    rng = np.random.default_rng(11)
    tours = schedule(LIBRARY, flights=3, rng=rng, coasting_range=(1.5, 5.0), wind="calm")
    return [
        synthetic_log(LIBRARY, tour.trims, tour.coasting_times, seed=place, start=tour.start)
        for place, tour in enumerate(tours)
    ]


def without_commands(log: FlightLog) -> FlightLog:
    """Returns the log with the estimated motion alone."""
    gone = {topic.name for topic in (COMMAND, PRIMITIVE, TRUTH, WIND)}
    kept = {name: series for name, series in log.series.items() if name not in gone}
    return replace(log, series=kept, attachments={})


def scored(logs: list[FlightLog], library: Library) -> list[tuple[Boundaries, Boundaries]]:
    walks = walks_of([sampled_motion(log) for log in logs], library)
    pairs = []
    for log, walk in zip(logs, walks, strict=True):
        commanded = commanded_walk(log)
        one = boundaries_of(commanded, cut_into_segments(log, commanded, LIBRARY))
        pairs.append((one, boundaries_of(walk, cut_into_segments(log, walk, library))))
    return pairs


def test_the_motion_shows_every_maneuver_that_was_commanded(logs: list[FlightLog]) -> None:
    entries, ends, edges = score_boundaries(scored(logs, LIBRARY))
    assert entries.commanded == ends.commanded == 66
    assert entries.found >= 0.98 * 66
    assert ends.found >= 0.98 * 66
    assert entries.spurious + ends.spurious <= 2
    assert abs(entries.late) < 0.1
    assert {edge.commanded for edge in edges} == {3}


def test_a_segmentation_that_is_late_by_more_than_a_second_is_refused_by_the_score(
    logs: list[FlightLog],
) -> None:
    """Tests shifted boundaries as the negative control."""
    late = [
        (one, Boundaries(tuple((time + 1.1, edge) for time, edge in shown.entries), shown.ends))
        for one, shown in scored(logs, LIBRARY)
    ]
    entries, _, _ = score_boundaries(late)
    assert entries.found < 0.1 * entries.commanded
    assert entries.spurious > 0.9 * entries.commanded


def test_trims_and_maneuvers_are_found_where_nobody_names_them(logs: list[FlightLog]) -> None:
    motions = [sampled_motion(without_commands(log)) for log in logs]
    found = discover_automaton(motions, vehicle="unknown")
    assert len(found.trims) == len(LIBRARY.trims)
    for trim in LIBRARY.trims:
        off = [
            max(
                abs(one.velocity.forward - trim.velocity.forward),
                abs(one.velocity.side),
                3 * abs(one.velocity.yaw_rate - trim.velocity.yaw_rate),
            )
            for one in found.trims
        ]
        assert min(off) < 0.1
    # A step of two parts may be found as two steps.
    assert len(LIBRARY.maneuvers) <= len(found.maneuvers) <= len(LIBRARY.maneuvers) + 2


def test_logs_with_an_estimate_alone_are_identified_by_the_same_command(
    logs: list[FlightLog], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for place, log in enumerate(logs):
        write_log(without_commands(log), tmp_path / "logs" / f"{place}.mcap")
    out = tmp_path / "found.json"
    assert run(["identify", str(tmp_path / "logs"), "--out", str(out), "--workers", "1"]) == 0
    assert "7 trims, 2" in capsys.readouterr().out
    library = read_library(out)
    assert "believed motion" in library.description
    assert library.provenance["method"].endswith("maneuvers by motion")


def test_another_simulators_vehicle_is_cut_into_its_trims(tmp_path: Path) -> None:
    """Uses a flight of RotorPy's quadrotor: pose alone, seed 5."""
    time, north, east, heading = np.loadtxt(ROTORPY, delimiter=",", skiprows=1).T
    log = motion_log(vehicle="hummingbird", time=time, north=north, east=east, heading=heading)
    write_log(log, tmp_path / "flight.mcap")
    motion = sampled_motion(read_log(tmp_path / "flight.mcap"))
    found = discover_automaton([motion], vehicle="hummingbird")
    flown = {(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (2.0, 0.0, 0.0), (1.0, 0.0, 0.5), (1.0, 0.0, -0.5)}
    flown |= {(0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 0.8)}
    for trim in found.trims:
        velocity = (trim.velocity.forward, trim.velocity.side, trim.velocity.yaw_rate)
        nearest = min(flown, key=lambda one: max(abs(a - b) for a, b in zip(one, velocity, strict=True)))
        assert velocity == pytest.approx(nearest, abs=0.1)
    assert len(found.trims) >= 4
    (walk,) = walks_of([motion], found)
    # The trim changes every 4 to 8 s.
    entries = np.array([entry.time for entry in walk.entries])
    assert 150 / 8 - 2 <= len(entries) <= 150 / 4
    assert np.diff(entries).min() > 3.5


def test_a_log_that_is_sampled_too_slowly_is_refused() -> None:
    time = np.arange(0.0, 60.0, 0.1)
    log = motion_log(vehicle="slow", time=time, north=time, east=0 * time, heading=0 * time)
    with pytest.raises(TooSlowLogError, match="expected /motion at 20 Hz or more"):
        sampled_motion(log)


def test_a_vehicle_that_holds_one_velocity_has_no_automaton() -> None:
    time = np.arange(0.0, 60.0, 0.02)
    log = motion_log(vehicle="steady", time=time, north=2 * time, east=0 * time, heading=0 * time)
    with pytest.raises(NoTrimsError, match="expected two trims or more"):
        discover_automaton([sampled_motion(log)], vehicle="steady")


def held(folder: Path, name: str, *parts: tuple[float, float]) -> Path:
    """Writes a log of forward speeds, each held for its seconds after a lag of 0.6 s."""
    wanted = np.concatenate([np.full(round(seconds / 0.02), speed) for seconds, speed in parts])
    speed, lag = np.array(wanted), 0.02 / 0.6
    for place in range(1, len(speed)):
        speed[place] = speed[place - 1] + lag * (wanted[place] - speed[place - 1])
    time = 0.02 * np.arange(len(speed))
    log = motion_log(
        vehicle="any", time=time, north=np.cumsum(0.02 * speed), east=0 * time, heading=0 * time, name=name
    )
    write_log(log, folder / f"{name}.mcap")
    return folder / f"{name}.mcap"


@pytest.mark.parametrize(
    "flights",
    [
        [[(30.0, 2.0)]],
        [[(30.0, 2.0)], [(30.0, 4.0)]],
        [[(30.0, 2.0)], [(30.0, 4.0)], [(30.0, 0.0)]],
        [[(20.0, 2.0), (1.7, 4.0)]],
    ],
)
def test_flights_without_a_whole_step_give_no_library(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], flights: list[list[tuple[float, float]]]
) -> None:
    logs = [held(tmp_path, f"{place}", *parts) for place, parts in enumerate(flights)]
    out = tmp_path / "found.json"
    assert run(["identify", *map(str, logs), "--out", str(out), "--workers", "1"]) == 2
    refusal = capsys.readouterr().err.splitlines()[-1]
    assert refusal.startswith("maneuver: expected ")
    assert "change --resolution, give --trims, or longer flights with steps" in refusal
    assert not out.exists()


def test_one_step_between_two_trims_is_a_library(tmp_path: Path) -> None:
    log, out = held(tmp_path, "step", (20.0, 2.0), (20.0, 4.0)), tmp_path / "found.json"
    assert run(["identify", str(log), "--out", str(out), "--workers", "1"]) == 0
    library = read_library(out)
    assert [trim.velocity.forward for trim in library.trims] == pytest.approx([2.0, 4.0], abs=0.02)
    assert len(library.maneuvers) == 1


def test_the_error_for_a_log_without_motion_names_the_topic(logs: list[FlightLog]) -> None:
    empty = replace(logs[0], series={PRIMITIVE.name: logs[0][PRIMITIVE]})
    with pytest.raises(MissingTopicError, match="/truth"):
        sampled_motion(empty)


def test_velocities_of_a_foreign_log_are_in_the_heading_frame() -> None:
    time = np.arange(0.0, 10.0, 0.02)
    heading = np.full_like(time, np.pi / 2)
    log = motion_log(vehicle="any", time=time, north=-0.5 * time, east=2 * time, heading=heading)
    assert log[MOTION]["forward"] == pytest.approx(2.0)
    assert log[MOTION]["side"] == pytest.approx(0.5)


def test_a_foreign_log_with_columns_of_different_length_is_refused() -> None:
    time = np.arange(0.0, 1.0, 0.02)
    with pytest.raises(FlightError, match="expected columns of 50 numbers"):
        motion_log(vehicle="any", time=time, north=time[1:], east=time, heading=time)


@given(st.floats(0.4, 4.0), st.floats(0.5, 0.95))
@settings(max_examples=25, deadline=None)
def test_a_response_is_found_again_in_its_own_steps(frequency: float, damping: float) -> None:
    truth = StepResponse(frequency, damping)
    period = 0.1 / frequency
    step = truth.remaining_share(np.arange(60) * period)
    found = fit_response([step], period=period, memory=0.9, guess=StepResponse(1.0, 0.8))
    assert found.frequency == pytest.approx(frequency, rel=1e-3)
    assert found.damping == pytest.approx(damping, abs=1e-3)


@given(st.integers(20, 60), st.integers(0, 2**32 - 1))
@settings(max_examples=25, deadline=None)
def test_one_step_in_noise_is_found_where_it_is(entry: int, seed: int) -> None:
    levels, model = _two_levels()
    rng = np.random.default_rng(seed)
    motion = np.zeros((140, 3))
    share = model.responses[0].remaining_share((np.arange(140) - entry) * model.period)
    motion[:, 0] = 1.0 - share
    motion += 0.02 * rng.standard_normal(motion.shape)
    walk = match_walk(motion, levels, model)
    assert [(step.left, step.reached) for step in walk.steps] == [(0, 1)]
    assert walk.steps[0].time == pytest.approx(entry * model.period, abs=0.3)


def test_noise_without_a_step_shows_none() -> None:
    levels, model = _two_levels()
    motion = 0.05 * np.random.default_rng(3).standard_normal((400, 3))
    assert match_walk(motion, levels, model).steps == ()


def _two_levels() -> tuple[TrimGraph, MotionModel]:
    velocity = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    response = StepResponse(1.0, 0.8)
    model = MotionModel((response, response, response), np.full(3, 0.1), 0.1, float(np.exp(-0.1)))
    return TrimGraph(velocity, np.full((2, 3), 0.3), np.array([[0, 1], [1, 0]]), dwell=0.5), model


def test_the_rule_of_a_library_is_what_trims_are_reached_by() -> None:
    levels = trim_graph_of(LIBRARY)
    assert levels.velocity.shape == levels.band.shape == (7, 3)
    assert len(levels.edges) == 22
    with pytest.raises(FlightError, match=r"expected conditions\.maneuver_end"):
        trim_graph_of(replace(LIBRARY, conditions=replace(LIBRARY.conditions, maneuver_end=None)))
