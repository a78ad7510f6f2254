"""Tests of validation: missions, results, scorecards, error attribution."""

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from math import isclose
from pathlib import Path

import numpy as np
import pytest

from experiments.mission.error_attribution import (
    ErrorAttribution,
    Performance,
    attribute_errors,
    performances,
)
from experiments.mission.fly import fly_helicopter
from experiments.mission.mission_log import recorded_latency
from experiments.mission.mission_task import MissionTask
from experiments.mission.random_missions import FARTHEST, NEAREST, NoMissionError, random_missions
from experiments.mission.result import MissionResult
from experiments.mission.result_store import FLIGHTS, fly_tasks
from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flight.automaton.maneuver import ManeuverError
from flight.errors import FlightError
from flight.se2 import Twist
from flightlog.attachment_names import LIBRARY_ATTACHMENT, PLANS_ATTACHMENT
from flightlog.decision import DECISION, DecisionKind
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes
from flightlog.log import FlightLog
from maneuver.app import run
from maneuver.options.latencies import latency_of
from planner.closed_loop.flight_record import FlightRecord
from planner.closed_loop.latency import Latency
from planner.closed_loop.settings import Settings
from planner.policies.worst_case import worst_case_planner
from runtime.executor import JobExecutor
from scenarios.find import find_library, find_mission
from tests.support.joint_laws import without_laws

LIBRARY = find_library("gtmax-sim")


Flight = tuple[MissionTask, FlightRecord, FlightLog]


def test_random_missions_repeat_and_each_has_a_plan() -> None:
    missions = random_missions(LIBRARY, count=8, seed=3, gamma=1.0)
    assert missions == random_missions(LIBRARY, count=8, seed=3, gamma=1.0)
    assert missions[:5] == random_missions(LIBRARY, count=5, seed=3, gamma=1.0)
    assert missions != random_missions(LIBRARY, count=8, seed=4, gamma=1.0)
    planner = worst_case_planner(LIBRARY, 1.0)
    for mission in missions:
        assert planner.plan(mission).found
        assert NEAREST <= mission.start.distance_to(mission.goal) <= FARTHEST


def test_a_library_that_leads_nowhere_has_no_missions() -> None:
    lame = replace(
        LIBRARY,
        trims=LIBRARY.trims[:1],
        maneuvers=(),
        conditions=replace(LIBRARY.conditions, maneuver_end=None),
    )
    with pytest.raises(NoMissionError, match="expected a worst-case plan at gamma 1"):
        random_missions(lame, count=1, seed=1, gamma=1.0)


def automaton_task(number: int) -> MissionTask:
    mission = find_mission("gtmax-2")
    return MissionTask(mission, LIBRARY, "nominal", 0.0, "none", number, plant="random")


def test_a_validation_that_was_stopped_flies_only_what_is_missing(tmp_path: Path) -> None:
    tasks = [automaton_task(number) for number in range(3)]

    def fly(some: list[MissionTask]) -> list[MissionResult]:
        with ThreadPoolExecutor(1) as executor:
            return fly_tasks(
                some, folder=tmp_path / "out", logs=None, job_executor=JobExecutor(executor), force=False
            )

    first = fly(tasks[:2])
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "out" / FLIGHTS).iterdir()}
    again = fly(tasks)
    after = {path: path.stat().st_mtime_ns for path in (tmp_path / "out" / FLIGHTS).iterdir()}
    assert again[:2] == first
    assert len(after) == 3
    assert all(after[path] == time for path, time in before.items())
    next(iter(before)).write_text("{broken")
    assert [row.flown_time for row in fly(tasks)] == [row.flown_time for row in again]


def test_a_folder_with_something_else_in_it_is_refused(tmp_path: Path) -> None:
    (tmp_path / "letter.txt").write_text("dear")
    with ThreadPoolExecutor(1) as executor, pytest.raises(FlightError, match="exists"):
        fly_tasks(
            [automaton_task(0)], folder=tmp_path, logs=None, job_executor=JobExecutor(executor), force=False
        )


def test_a_validation_writes_scorecards_and_pictures(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    words = ("--suite", "random", "--missions", "2", "--plant", "automaton", "--true-gamma", "minus", "plus")
    code = run(("validate", *words, "--flights", "1", "--workers", "1", "--out", str(out), "--json"))
    document = json.loads(capsys.readouterr().out)
    cells = document["totals"]
    assert [(cell["policy"], cell["gamma"], cell["plant"]) for cell in cells] == [
        ("nominal", 0.0, "gamma -1"),
        ("nominal", 0.0, "gamma +1"),
        ("worst-case", 1.0, "gamma -1"),
        ("worst-case", 1.0, "gamma +1"),
    ]
    assert code == (0 if all(cell["reached"] == 2 for cell in cells[2:]) else 1)
    assert len(document["flights"]) == 8
    assert (out / "scorecard.md").read_text().startswith("# Scorecard, gtmax-sim")
    assert len((out / "scorecard.csv").read_text().splitlines()) == 1 + 4 + 8
    pictures = {path.name for path in out.glob("*.png")}
    assert "gamma.png" in pictures
    for kind in ("bundle", "map", "occurrence", "predicted"):
        assert any(name.startswith(kind) for name in pictures), kind


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (("--suite", "random", "--missions", "gtmax-1"), "expected one number > 0 for --missions"),
        (("--plant", "automaton", "--true-gamma", "much"), "expected levels from -1 to 1"),
        (("--plant", "automaton", "--true-gamma", "0.5", "--flights", "3"), "expected --flights 1, got 3"),
        (("--latency", "soon"), "expected seconds, 'measured' or a flight log"),
        (("--latency", "nowhere.mcap"), "cannot be read"),
        (("--latency", "11"), "between 0 and 10 s"),
        (("--aim", "2"), "aim must be in"),
    ],
)
def test_wrong_options_are_refused_in_one_line(
    words: tuple[str, ...], problem: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(("validate", *words)) == 2
    error = capsys.readouterr().err
    assert problem in error
    assert error.count("\n") == 1


@pytest.fixture(scope="module")
def flight() -> Flight:
    task = MissionTask(
        find_mission("gtmax-2"),
        LIBRARY,
        "worst-case",
        1.0,
        "gtmax",
        7,
        settings=Settings(latency=Latency(0.05, measured=True), max_activations=40),
    )
    return task, *fly_helicopter(task)


def test_a_flight_with_measured_latencies_is_repeated_by_its_log(flight: Flight, tmp_path: Path) -> None:
    task, flown, log = flight
    path = tmp_path / "flight.mcap"
    path.write_bytes(log_bytes(log))
    again, repeated = fly_helicopter(
        replace(task, settings=replace(task.settings, latency=latency_of(str(path))))
    )
    assert [one.latency for one in again.decisions] == [one.latency for one in flown.decisions]
    assert again.flown_time == flown.flown_time
    assert (repeated[DECISION].values == log[DECISION].values).all()
    assert json.loads(repeated.attachments[PLANS_ATTACHMENT]) == json.loads(log.attachments[PLANS_ATTACHMENT])


def test_the_log_records_the_decisions(flight: Flight, tmp_path: Path) -> None:
    _, flown, log = flight
    path = tmp_path / "flight.mcap"
    path.write_bytes(log_bytes(log))
    decisions = read_log(path)[DECISION]
    assert len(decisions) == len(flown.decisions)
    assert decisions["kind"].tolist() == [one.kind for one in flown.decisions]
    assert flown.reached == (DecisionKind.ARRIVED in decisions["kind"])


def smaller(library: Library, factor: float) -> Library:
    """Returns the library with its errors scaled by a factor."""
    return replace(
        library,
        trims=tuple(
            replace(
                t, error=Twist(t.error.forward * factor, t.error.side * factor, t.error.yaw_rate * factor)
            )
            for t in library.trims
        ),
        maneuvers=tuple(
            replace(
                m,
                error=ManeuverError(
                    m.error.duration * factor,
                    m.error.forward * factor,
                    m.error.side * factor,
                    m.error.heading_change * factor,
                ),
            )
            for m in library.maneuvers
        ),
    )


def test_deviations_are_shares_of_the_error(flight: Flight) -> None:
    _, _, log = flight
    # Joint laws bound by themselves; errors are scaled here.
    plain = without_laws(LIBRARY)
    whole = performances(replace_library(log, plain))
    cut = performances(replace_library(log, smaller(plain, 0.5)))
    assert len(whole) == len(cut) > 4
    for one, other in zip(whole, cut, strict=True):
        assert other.share == pytest.approx(2 * one.share, abs=2e-4)
        assert (one.kind, one.id, one.time) == (other.kind, other.id, other.time)


def replace_library(log: FlightLog, library: Library) -> FlightLog:
    return replace(log, attachments={**log.attachments, LIBRARY_ATTACHMENT: library_text(library).encode()})


def test_a_library_with_too_small_errors_is_refuted() -> None:
    """Tests flights as claimed, and with errors cut by 30 %."""
    rng = np.random.default_rng(1)
    # Largest deviations as in the library's own wind: about one in a hundred is outside.
    shares = np.abs(rng.normal(0.55, 0.17, 200))

    def attributed(factor: float) -> ErrorAttribution:
        flights = [
            (f"flight {n}", [Performance("trim", 2, 1.0, "side", float(share) / factor)])
            for n, share in enumerate(shares)
        ]
        (row,) = attribute_errors(flights, LIBRARY)
        return row

    full, reduced = attributed(1.0), attributed(0.7)
    assert full.claimed == LIBRARY.trim(2).statistics.coverage  # type: ignore[union-attr]
    assert full.p_value > 0.05  # type: ignore[operator]
    assert reduced.p_value < 1e-3  # type: ignore[operator]
    assert reduced.outside > full.outside
    assert reduced.worst.share == pytest.approx(full.worst.share / 0.7)


def test_latencies_of_a_log_are_charged_again(flight: Flight) -> None:
    _, flown, log = flight
    latency = recorded_latency(log, source="flight.mcap")
    assert latency.recorded == flown.latencies
    assert latency.measured
    assert isclose(latency.configured, 0.05)
