"""Tests of `maneuver review` on one log: output, files, errors, bounds."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flight.errors import FlightError
from flight.se2 import Twist
from flightlog.attachment_names import LIBRARY_ATTACHMENT
from flightlog.file.writer import write_log
from flightlog.log import FlightLog
from flightlog.topics import ESTIMATE, TRUTH, WIND
from maneuver.app import run
from review.summary.bound_check import check_bounds, with_bounds_of
from review.summary.summary import summarise
from tests.support.altered_logs import bound_for, with_added_offset, without_topics
from tests.support.synthetic_log import STILL, synthetic_library, synthetic_log

LIBRARY = synthetic_library()


def still_flight(*, kind: str = "sequence") -> FlightLog:
    return synthetic_log(LIBRARY, (1, 2, 3, 7, 5), (4.0,) * 5, seed=1, noise=STILL, kind=kind)


def narrower(library: Library, share: float) -> Library:
    """Returns a library with scaled trim errors."""

    def less(error: Twist) -> Twist:
        return Twist(share * error.forward, share * error.side, share * error.yaw_rate)

    trims = tuple(replace(trim, error=less(trim.error)) for trim in library.trims)
    return replace(library, name="narrower", trims=trims)


def test_the_command_prints_one_document_and_overwrites_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, pictures = tmp_path / "flight.mcap", tmp_path / "pictures"
    write_log(without_topics(synthetic_log(LIBRARY, (1, 2), (2.0, 2.0), seed=1), WIND, ESTIMATE), log)
    order = ["review", str(log), "--png", "--html", "--out", str(pictures), "--json"]
    assert run(order) == 0
    content = json.loads(capsys.readouterr().out)
    assert content["bounds"]["coasts"] == 2
    assert Path(content["files"][0]).name == "flight.html"
    assert {Path(path).suffix for path in content["files"][1:]} == {".png"}
    assert all(Path(path).is_file() for path in content["files"])
    assert run(order) == 2
    refusal = capsys.readouterr()
    assert refusal.out == ""
    assert refusal.err.count("\n") == 1
    assert "give --force" in refusal.err


def test_the_command_prints_the_paths_of_its_pictures(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = tmp_path / "flight.mcap"
    flight = bound_for(synthetic_log(LIBRARY, (1, 2), (2.0, 2.0), seed=1), (90.0, 0.0), 1.0)
    write_log(with_added_offset(flight, TRUTH, "forward", 1.0), log)
    assert run(["review", str(log), "--png", "--out", str(tmp_path / "pictures")]) == 0
    said = capsys.readouterr().out
    assert "not reached" in said
    assert "2 of 2 coasts" in said
    assert f"files  {tmp_path / 'pictures' / 'flight.png'}" in said.replace("\n", "")


def test_a_truncated_log_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = tmp_path / "flight.mcap"
    write_log(still_flight(), log)
    log.write_bytes(log.read_bytes()[:-100])
    assert run(["review", str(log)]) == 2
    refusal = capsys.readouterr().err
    assert refusal.count("\n") == 1
    assert "flight.mcap" in refusal


def test_a_broken_library_is_refused_before_anything_is_drawn(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, pictures = tmp_path / "flight.mcap", tmp_path / "pictures"
    write_log(replace(still_flight(), attachments={LIBRARY_ATTACHMENT: b"{}"}), log)
    assert run(["review", str(log), "--png", "--out", str(pictures)]) == 2
    assert "library.json" in capsys.readouterr().err
    assert not pictures.exists()


def test_a_flight_that_is_flown_to_find_bounds_is_judged_by_none_until_a_library_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    flight = with_added_offset(still_flight(kind="campaign"), TRUTH, "forward", 0.2)
    assert check_bounds(flight) is None
    log, named = tmp_path / "flight.mcap", tmp_path / "narrower.json"
    write_log(flight, log)
    named.write_text(library_text(narrower(LIBRARY, 0.5)))
    assert run(["review", str(log)]) == 0
    assert "a campaign has no bounds of its own" in " ".join(capsys.readouterr().out.split())
    assert run(["review", str(log), "--library", str(named)]) == 0
    assert "5 of 5 coasts" in capsys.readouterr().out
    assert run(["review", str(tmp_path), "--library", str(named), "--json", "--workers", "1"]) == 0
    (row,) = json.loads(capsys.readouterr().out)["flights"]
    assert row["left"] >= 5


def test_the_library_named_judges_and_the_one_flown_with_still_names() -> None:
    flight = with_added_offset(still_flight(), TRUTH, "forward", 0.2)
    own, other = check_bounds(flight), check_bounds(with_bounds_of(flight, narrower(LIBRARY, 0.5)))
    assert own is not None
    assert other is not None
    assert (own.library, other.library) == ("synthetic", "narrower")
    # The last coast is held shortly after a maneuver; it leaves both.
    assert len(own.violations) == 1
    assert len(other.violations) == 5
    assert summarise(with_bounds_of(flight, narrower(LIBRARY, 0.5))).trims == summarise(flight).trims


def test_a_library_of_another_automaton_judges_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = tmp_path / "flight.mcap"
    write_log(still_flight(), log)
    assert run(["review", str(log), "--library", "thesis-kinematic"]) == 2
    refusal = capsys.readouterr().err
    assert refusal.count("\n") == 1
    assert "is of another automaton: expected trim" in refusal
    fewer = replace(
        LIBRARY, maneuvers=tuple(one for one in LIBRARY.maneuvers if (one.from_trim, one.to_trim) != (2, 3))
    )
    with pytest.raises(FlightError, match="no maneuver from trim 2 to trim 3"):
        with_bounds_of(still_flight(), fewer)
