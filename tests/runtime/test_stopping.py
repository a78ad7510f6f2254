"""Tests of commands stopped by signals, asked for status, or restarted."""

import json
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from flightlog.file.reader import read_log
from maneuver.app import run
from runtime import atomic_write as publishing
from tests.support.small_campaign import write_small_campaign

ROOT = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def hangup_signal() -> Iterator[None]:
    """Restores the default of SIGHUP, which nohup would change."""
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize("stop", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_a_campaign_stopped_by_a_signal_reports_it_and_resumes(tmp_path: Path, stop: signal.Signals) -> None:
    campaign = write_small_campaign(tmp_path, flights=12)
    words = ["fly", "--campaign", str(campaign), "--out", str(tmp_path / "flights"), "--workers", "2"]
    command = [sys.executable, "-m", "maneuver", *words]
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True) as process:
        while process.poll() is None and not list(tmp_path.glob("flights/small-*.mcap")):
            time.sleep(0.02)
        workers = children(process.pid)
        process.send_signal(stop)
        message = process.communicate()[1]
    there = len(list(tmp_path.glob("flights/small-*.mcap")))
    assert 0 < there < 12
    if stop is signal.SIGKILL:
        assert process.returncode == -stop
    else:
        assert process.returncode == 128 + stop
        assert len(message.splitlines()) == 1
        assert "the same command resumes" in message
        assert not publishing.partial_files(tmp_path / "flights")
    deadline = time.monotonic() + 20
    while any(map(alive, workers)):
        assert time.monotonic() < deadline, "workers outlive the program that started them"
        time.sleep(0.05)
    assert run([*words, "--status"]) == 1
    names = [read_log(path).header.name for path in sorted(tmp_path.glob("flights/small-*.mcap"))]
    assert len(names) == len(set(names)) >= there


def children(parent: int) -> list[int]:
    return [int(word) for word in Path(f"/proc/{parent}/task/{parent}/children").read_text().split()]


def alive(process: int) -> bool:
    try:
        return "State:\tZ" not in Path(f"/proc/{process}/status").read_text()
    except OSError:
        return False


def test_status_lists_the_stored_flights_and_flies_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    campaign = write_small_campaign(tmp_path, flights=2)
    words = ["--campaign", str(campaign), "--flights", "2"]
    fly = ["fly", *words, "--out", str(tmp_path / "flights")]
    assert run([*fly, "--status", "--json"]) == 1
    status = json.loads(capsys.readouterr().out)
    assert (status["flights"], status["complete"], status["missing"]) == (
        2,
        [],
        ["small-0000.mcap", "small-0001.mcap"],
    )
    assert not (tmp_path / "flights").exists()
    assert run([*fly, "--workers", "1"]) == 0
    assert run([*fly, "--status"]) == 0
    # A regeneration uses the same flights and reports the same status.
    make = ["regenerate", *words, "--logs", str(tmp_path / "flights"), "--out", str(tmp_path / "made.json")]
    assert run([*make, "--status"]) == 0
    assert not (tmp_path / "made.json").exists()


def test_a_regeneration_that_was_finished_is_known_again_and_another_is_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    campaign, out = write_small_campaign(tmp_path, flights=2), tmp_path / "made.json"
    words = ["regenerate", "--campaign", str(campaign), "--out", str(out), "--workers", "1"]
    assert run(words) == 0
    assert not (tmp_path / "made-flights").exists()
    made, stamp = out.read_bytes(), out.stat().st_mtime_ns
    # As if it had been killed while it removed the flights.
    (tmp_path / ".made-flights.removed").mkdir()
    capsys.readouterr()
    assert run(words) == 0
    assert "nothing is flown" in capsys.readouterr().err
    assert (out.read_bytes(), out.stat().st_mtime_ns) == (made, stamp)
    assert not (tmp_path / ".made-flights.removed").exists()
    assert run([*words, "--seed", "2"]) == 2
    assert run([*words, "--trim-errors", "averaged"]) == 2
    assert out.read_bytes() == made
    # Killed between the library and its data sheet, with the flights there: the sheet is made.
    logs = ["--logs", str(tmp_path / "kept")]
    assert run([*words, *logs, "--force"]) == 0
    sheet = out.with_suffix(".md").read_bytes()
    out.with_suffix(".md").unlink()
    assert run([*words, *logs]) == 0
    assert (out.read_bytes(), out.with_suffix(".md").read_bytes()) == (made, sheet)


def test_the_status_of_a_validation_lists_the_missing_flights(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["validate", "--missions", "gtmax-2", "--plant", "automaton", "--true-gamma", "minus", "plus"]
    words += ["--policies", "nominal", "--flights", "1", "--out", str(tmp_path / "out")]
    assert run([*words, "--status"]) == 1
    assert "missing              2" in capsys.readouterr().out
    assert not (tmp_path / "out").exists()
    assert run([*words, "--workers", "1"]) in {0, 1}
    assert run([*words, "--status"]) == 0
    assert run([*words[:-2], "--status"]) == 2


@pytest.mark.parametrize(
    ("words", "resumes"),
    [
        (["plan", "gtmax-2"], False),
        (["fly", "--mission", "gtmax-2"], False),
        (["fly", "--campaign", "gtmax"], True),
        (["validate", "--out", "here"], True),
        (["validate"], False),
        (["regenerate"], True),
    ],
)
def test_only_a_resumable_command_reports_that_it_resumes(
    words: list[str], resumes: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stop(**_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("maneuver.app.build", stop)
    assert run(words) == 130
    message = capsys.readouterr().err
    assert "all files written are complete" in message
    assert ("the same command resumes" in message) is resumes
