"""Tests of plan files: stated missions, and replacement of files without plans."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from maneuver.app import run
from tests.support.refusal import refusal

LIBRARY = ("--library", "thesis-gtmax")

MISSION = """name = "mine"
[start]
position = [0.0, 0.0]
heading = 0.0
trim = 2
[goal]
position = [{north}, 3.0]
tolerance = 0.5
[planner]
max_trims = {max_trims}
"""


def mission(folder: Path, *, north: float = 12.0, max_trims: int = 4) -> str:
    path = folder / "mine.toml"
    path.write_text(MISSION.format(north=north, max_trims=max_trims))
    return str(path)


def planned(folder: Path, *words: str, max_trims: int = 4) -> Path:
    path = folder / "plan.json"
    assert run(["plan", mission(folder, max_trims=max_trims), *LIBRARY, "--out", str(path), *words]) == 0
    (folder / "mine.toml").unlink()
    return path


@pytest.mark.parametrize(
    "words",
    [("--policy", "nominal"), ("--policy", "price-of-robustness"), ("--max-trims", "5"), ("--certify",)],
)
def test_a_plan_is_checked_with_nothing_but_its_library(words: tuple[str, ...], tmp_path: Path) -> None:
    path = planned(tmp_path, *words, max_trims=3)
    assert run(["plan", "check", str(path)]) == 0
    assert run(["plan", "signs", str(path), "--boxes", "1"]) in {0, 1}


def test_the_plan_for_the_smallest_tolerance_is_complete_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "plan.json"
    words = ["plan", mission(tmp_path, max_trims=2), *LIBRARY, "--policy", "committed", "--gamma", "1"]
    assert run([*words, "--out", str(path)]) == 1
    (tmp_path / "mine.toml").unlink()
    wider = json.loads(path.read_text())["at_smallest_tolerance"]
    assert wider["stated_mission"]["tolerance"] == wider["tolerance"] > 0.5
    capsys.readouterr()
    run(["plan", "check", str(path)])
    assert "at_smallest_tolerance" not in capsys.readouterr().out


Told = dict[str, Any]

LIES: dict[str, tuple[Callable[[Told], object], int, str]] = {
    "another goal": (lambda plan: plan["stated_mission"].update(goal=[9.0, 3.0]), 1, "goal: missed by"),
    "another start trim": (lambda plan: plan["stated_mission"].update(start_trim=3), 1, "sequence: "),
    "fewer trims": (lambda plan: plan["stated_mission"].update(max_trims=1), 1, "sequence: at most 1"),
    "another name": (
        lambda plan: plan["stated_mission"].update(name="x"),
        1,
        "stated_mission: expected mine",
    ),
    "a wider goal": (
        lambda plan: plan["stated_mission"].update(tolerance=9.0),
        1,
        "stated_mission: expected",
    ),
    "no mission": (lambda plan: plan.pop("stated_mission"), 2, "stated_mission: is missing"),
    "an old version": (
        lambda plan: plan.update(schema="maneuver-plan/1"),
        2,
        "stated_mission: expected none in maneuver-plan/1, got one",
    ),
    "too many trims": (lambda plan: plan["stated_mission"].update(max_trims=9), 2, "max_trims: expected at"),
    "a goal far away": (lambda plan: plan["stated_mission"].update(goal=[1e7, 0.0]), 2, "expected a number"),
    "a negative tolerance": (
        lambda plan: plan["stated_mission"].update(tolerance=-1.0),
        2,
        "tolerance must be >= 0 m",
    ),
}


@pytest.mark.parametrize("name", LIES)
def test_a_plan_with_another_mission_than_its_own_is_invalid(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lie, code, words = LIES[name]
    path = planned(tmp_path)
    plan = json.loads(path.read_text())
    lie(plan)
    path.write_text(json.dumps(plan))
    capsys.readouterr()
    assert run(["plan", "check", str(path)]) == code
    told = capsys.readouterr()
    assert words in told.out + told.err


def test_an_answer_without_a_plan_does_not_keep_its_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = tmp_path / "plan.json", ("--out", str(tmp_path / "plan.json"))
    for _ in range(2):
        assert run(["plan", mission(tmp_path, north=-9.0, max_trims=1), *LIBRARY, *out]) == 1
        assert json.loads(path.read_text())["status"] == "infeasible"
    assert run(["plan", mission(tmp_path), *LIBRARY, *out]) == 0
    kept = path.read_text()
    capsys.readouterr()
    assert "exists; give --force" in refusal(capsys, "plan", mission(tmp_path), *LIBRARY, *out)
    assert path.read_text() == kept


def test_prices_of_a_mission_without_a_plan_do_not_keep_their_file(tmp_path: Path) -> None:
    words = ["plan", mission(tmp_path, north=-9.0, max_trims=1), *LIBRARY, "--pareto"]
    for _ in range(2):
        assert run([*words, "--out", str(tmp_path / "prices.json")]) == 1


def test_a_proof_that_there_is_no_plan_keeps_its_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [
        "plan",
        mission(tmp_path, north=-9.0, max_trims=1),
        *LIBRARY,
        "--out",
        str(tmp_path / "plan.json"),
    ]
    assert run([*words, "--certify"]) == 1
    capsys.readouterr()
    assert "exists; give --force" in refusal(capsys, *words)
    assert run(["plan", "check", str(tmp_path / "plan.json")]) == 0


@pytest.mark.parametrize("text", ["", "mine", "{}", '{"schema": "maneuver-prices/1", "points": [1]}'])
def test_a_file_that_is_no_answer_is_not_replaced(
    text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "plan.json"
    path.write_text(text)
    line = refusal(capsys, "plan", mission(tmp_path), *LIBRARY, "--out", str(path))
    assert "exists; give --force" in line
    assert path.read_text() == text
