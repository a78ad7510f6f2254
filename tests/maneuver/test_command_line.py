"""Tests of the command line: results, exit codes, one-line errors."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from flight.automaton.library_file import library_text
from flightlog.file.writer import write_log
from maneuver.app import run
from tests.support.refusal import refusal
from tests.support.synthetic_log import synthetic_library, synthetic_log


@pytest.fixture
def log_path(tmp_path: Path) -> Path:
    path = tmp_path / "flight.mcap"
    write_log(synthetic_log(synthetic_library(), [1, 2, 1], [2.0, 2.0, 2.0], seed=1), path)
    return path


def test_a_truncated_log_is_one_line_and_code_2(
    capsys: pytest.CaptureFixture[str], log_path: Path, tmp_path: Path
) -> None:
    log_path.write_bytes(log_path.read_bytes()[:5000])
    assert "is truncated after 5000 bytes" in refusal(
        capsys, "review", str(log_path), "--png", "--out", str(tmp_path / "r")
    )
    assert "is truncated after 5000 bytes" in refusal(
        capsys, "identify", str(log_path), "--out", str(tmp_path / "library.json")
    )
    assert not (tmp_path / "library.json").exists()


def test_a_library_with_a_broken_edge_is_one_line_and_code_2(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    content = json.loads(library_text(synthetic_library()))
    content["maneuvers"][6]["to"] = 12
    path = tmp_path / "broken.json"
    path.write_text(json.dumps(content))
    expected = "maneuvers[6].to: no trim 12; the library has [1, 2, 3, 4, 5, 6, 7]"
    assert expected in refusal(capsys, "library", "check", str(path))
    assert expected in refusal(capsys, "plan", "gtmax-1", "--library", str(path), "--policy", "nominal")


def test_a_mission_with_an_unknown_trim_is_one_line_and_code_2(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "lost.toml"
    path.write_text(
        'name = "lost"\n[start]\nposition = [0.0, 0.0]\nheading = 0.0\ntrim = 9\n'
        "[goal]\nposition = [30.0, 0.0]\ntolerance = 0.0\n"
    )
    line = refusal(capsys, "plan", str(path), "--library", "thesis-gtmax", "--policy", "nominal")
    assert "no trim 9; the library has [1, 2, 3, 4, 5, 6, 7]" in line


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("plan", "nowhere", "--library", "thesis-gtmax", "--policy", "nominal"), "no mission 'nowhere'"),
        (("plan", "gtmax-1", "--library", "nothing", "--policy", "nominal"), "no library 'nothing'"),
        (("plan", "gtmax-1", "--library", "thesis-gtmax", "--policy", "bold"), "bold"),
        (
            ("plan", "gtmax-1", "--library", "thesis-gtmax", "--policy", "worst-case", "--gamma", "1.5"),
            "gamma must be",
        ),
        (("plan",), "MISSION"),
        (("plane",), "plane"),
        (("fly",), "expected one of --sequence, --mission and --campaign"),
        (
            ("fly", "--sequence", "figure-eight", "--library", "thesis-gtmax"),
            "expected conditions.maneuver_end",
        ),
        (("fly", "--sequence", "figure-eight", "--wind", "hurricane"), "hurricane"),
        (
            ("fly", "--sequence", "figure-eight", "--wind", "moderate"),
            "wind moderate cannot be flown: expected",
        ),
        (("fly", "--campaign", "gtmax", "--wind", "moderate"), "wind moderate cannot be flown: expected"),
        (
            ("fly", "--mission", "gtmax-1", "--wind-change", "5 severe"),
            "wind severe cannot be flown: expected",
        ),
        (("validate", "--wind", "severe"), "wind severe cannot be flown: expected"),
        (("fly", "--campaign", "gtmax", "--wind", "severe"), "no maneuver_end for wind 'severe'"),
        (("fly", "--sequence", "figure-eight", "--seed", "-1"), "seed"),
        (("fly", "--sequence", "figure-eight", "--seed", "3.7"), "expected a whole number, got '3.7'"),
        (
            ("fly", "--sequence", "figure-eight", "--flights", "3"),
            "only valid with --campaign",
        ),
        (
            ("fly", "--sequence", "figure-eight", "--policy", "nominal"),
            "only valid with --mission",
        ),
        (("fly", "--sequence", "figure-eight", "--mission", "gtmax-1"), "got 2"),
        (("validate", "--tolerance-share", "inf"), "tolerance_share must be in"),
        (("validate", "--replan-interval", "1e9"), "replan interval must be"),
        (("validate", "--plant", "automaton", "--wind", "severe"), "it has no wind"),
        (("validate", "--true-gamma", "0.5"), "expected --plant automaton"),
        (("identify", "--out", "x.json"), "LOGS"),
        (("identify", "nowhere.mcap", "--out", "x.json"), "cannot be read"),
        (("review", "nowhere.mcap"), "cannot be read"),
    ],
)
def test_bad_usage_is_one_line_and_code_2(
    capsys: pytest.CaptureFixture[str],
    arguments: tuple[str, ...],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert words in refusal(capsys, *arguments)
    assert list(tmp_path.iterdir()) == []


def test_an_existing_result_is_not_overwritten(capsys: pytest.CaptureFixture[str], log_path: Path) -> None:
    before = log_path.read_bytes()
    line = refusal(capsys, "fly", "--sequence", "figure-eight", "--out", str(log_path))
    assert "exists; give --force" in line
    assert log_path.read_bytes() == before


def test_a_plan_is_one_json_document(capsys: pytest.CaptureFixture[str]) -> None:
    code = run(("plan", "kinematic-1", "--library", "thesis-kinematic", "--policy", "nominal", "--json"))
    plan = json.loads(capsys.readouterr().out)
    assert code == 0
    assert plan["schema"] == "maneuver-plan/2"
    assert plan["stated_mission"]["name"] == plan["mission"] == "kinematic-1"
    assert plan["sequence"] == [1, 2, 5, 2]
    assert plan["cost"] == pytest.approx(19.868357, abs=1e-4)
    assert plan["verified"] is True


def test_a_mission_without_a_plan_is_code_1_and_no_number(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "behind.toml"
    path.write_text(
        'name = "behind"\n[start]\nposition = [0.0, 0.0]\nheading = 0.0\ntrim = 2\n'
        "[goal]\nposition = [-30.0, 0.0]\ntolerance = 0.0\n[planner]\nmax_trims = 1\n"
    )
    arguments = ("plan", str(path), "--library", "thesis-gtmax", "--policy", "nominal", "--json")
    assert run(arguments) == 1
    plan = json.loads(capsys.readouterr().out)
    assert plan["status"] in {"infeasible", "unknown"}
    assert "cost" not in plan


def test_the_program_starts_and_lists_its_verbs() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "maneuver", "--help"], capture_output=True, text=True, check=True
    )
    for verb in ("demo", "fly", "identify", "regenerate", "plan", "validate", "review", "thesis", "library"):
        assert verb in done.stdout


def test_a_result_without_plan_and_certificate_is_invalid(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    mission, out = tmp_path / "far.toml", tmp_path / "plan.json"
    mission.write_text(
        'name = "far"\n[start]\nposition = [0.0, 0.0]\nheading = 0.0\ntrim = 1\n'
        "[goal]\nposition = [-30.0, 0.0]\ntolerance = 0.0\n[planner]\nmax_trims = 1\n"
    )
    command = ("plan", str(mission), "--library", "thesis-gtmax", "--policy", "nominal", "--out", str(out))
    assert run(command) == 1
    assert run(("plan", "check", str(out), "--mission", str(mission), "--library", "thesis-gtmax")) == 1
    assert "expected a plan or a certificate, got status" in capsys.readouterr().out
