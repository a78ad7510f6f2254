"""Tests of the conditions of a plan's time bound."""

from dataclasses import replace
from pathlib import Path

import pytest

import libraries
from experiments.mission.stated_time_bound import stated_time_bounds, with_time_bound
from flight.automaton.library_file import library_hash
from flight.plan.time_bound import TimeBound, time_bounds_path, time_bounds_text
from flight.se2 import SE2
from maneuver.app import BAD_INPUT, run
from planner.policies.worst_case import worst_case_planner
from scenarios.find import find_library, find_mission

LIBRARY = find_library("gtmax-sim")
MISSION = replace(find_mission("gtmax-2"), tolerance=1.0)
HERE = TimeBound("worst-case", 1.0, "gtmax", 0.9, 2.0, 100, 100, 1)


def bounded(distance: float, *bounds: TimeBound) -> float | None:
    start = MISSION.start
    mission = replace(MISSION, goal=(start.x + distance, start.y), start=SE2(start.x, start.y, 0.3))
    planner = worst_case_planner(LIBRARY, 1.0)
    plan = with_time_bound(planner.plan(mission), mission, planner, LIBRARY, bounds)
    return None if plan.time_promise is None else plan.time_promise.time


def test_a_plans_bound_is_a_multiple_of_its_time_in_the_librarys_wind() -> None:
    time = bounded(30.0, replace(HERE, wind="calm", factor=1.0), HERE)
    assert time == pytest.approx(2.0 * (bounded(30.0, replace(HERE, factor=1.0)) or 0.0))
    assert bounded(30.0, replace(HERE, wind="calm")) is None
    assert bounded(30.0, replace(HERE, policy="nominal")) is None


@pytest.mark.parametrize("distance", [2.0, 65.0])
def test_no_time_is_bounded_outside_the_flown_distances(distance: float) -> None:
    assert bounded(distance, HERE) is None


def test_another_loop_has_no_time_bounds(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["validate", "--suite", "random", "--missions", "2", "--calibrate", str(tmp_path / "t.toml")]
    assert run([*words, "--aim", "1"]) == BAD_INPUT
    assert "expected default closed-loop settings" in capsys.readouterr().err


WHOLE = time_bounds_text([HERE], library_hash=library_hash(LIBRARY), command="by hand")

BROKEN = {
    "empty": "",
    "no TOML": "= 3",
    "no bound": WHOLE.partition("[[")[0],
    "a bound that is no table": WHOLE.partition("[[")[0] + "promise = 3\n",
    "no factor": WHOLE.replace("factor = 2.0\n", ""),
    "a factor of 0": WHOLE.replace("factor = 2.0", "factor = 0.0"),
    "a factor that no time can take": WHOLE.replace("factor = 2.0", "factor = 1e308"),
    "a factor that is no number": WHOLE.replace("factor = 2.0", "factor = nan"),
    "a seed of many digits": WHOLE.replace("seed = 1", "seed = 1" + 5000 * "0"),
    "a time": WHOLE + "time = 3.0\n",
    "a later version": WHOLE.replace("times/1", "times/2"),
    "bytes that are no text": "\udcff",
}


def beside(folder: Path, text: str) -> Path:
    """Returns a library in a folder, with a file of time bounds beside it."""
    library = folder / "mine.json"
    library.write_text((libraries.FOLDER / "gtmax-sim.json").read_text())
    time_bounds_path(library).write_text(text, errors="surrogateescape")
    return library


def test_a_whole_file_of_time_bounds_is_stated(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert stated_time_bounds(str(beside(tmp_path, WHOLE)), LIBRARY) == (HERE,)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_of_time_bounds_is_ignored_in_one_line(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    library = beside(tmp_path, BROKEN[name])
    assert run(["plan", "gtmax-2", "--library", str(library), "--out", str(tmp_path / "plan.json")]) == 0
    printed = capsys.readouterr()
    assert "of flights finish within" not in printed.out
    (line,) = [line for line in printed.err.splitlines() if "time bound" in line]
    assert line.startswith(str(time_bounds_path(library)))
    assert line.endswith("; no time bound is stated")
    assert run(["plan", "check", str(tmp_path / "plan.json"), "--library", str(library)]) == 0


def test_a_folder_in_place_of_time_bounds_is_ignored(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    library = beside(tmp_path, "")
    time_bounds_path(library).unlink()
    time_bounds_path(library).mkdir()
    assert run(["plan", "gtmax-2", "--library", str(library)]) == 0
    assert "no time bound is stated" in capsys.readouterr().err


def test_too_few_flights_leave_no_file_of_time_bounds(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    library = beside(tmp_path, "")
    file = time_bounds_path(library)
    file.unlink()
    words = ["validate", "--suite", "random", "--missions", "1", "--flights", "1", "--workers", "1"]
    run([*words, "--policies", "worst-case", "--library", str(library), "--calibrate", str(file)])
    assert not file.exists()
    assert f"{file} is not written: no policy has a time bound" in capsys.readouterr().err
    assert run(["plan", "gtmax-2", "--library", str(library)]) == 0
