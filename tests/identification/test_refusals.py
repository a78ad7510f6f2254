"""Logs that no library can be made of: one line, exit code 2, what to change."""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from flight.automaton.library import Library
from flight.automaton.library_file import library_text, read_library
from flight.se2 import Twist
from flightlog.attachment_names import LIBRARY_ATTACHMENT
from flightlog.file.writer import write_log
from flightlog.log import FlightLog
from flightlog.topics import PRIMITIVE
from maneuver.app import run
from tests.support.synthetic_log import STILL, synthetic_library, synthetic_log

LIBRARY = synthetic_library()


def only(trims: Sequence[int]) -> Library:
    """Returns the library of some trims."""
    rule = LIBRARY.conditions.maneuver_end
    assert rule is not None
    bands = {trim: rule.bands[trim] for trim in trims}
    return replace(
        LIBRARY,
        trims=tuple(trim for trim in LIBRARY.trims if trim.id in trims),
        maneuvers=tuple(row for row in LIBRARY.maneuvers if {row.from_trim, row.to_trim} <= {*trims}),
        conditions=replace(LIBRARY.conditions, maneuver_end=replace(rule, bands=bands)),
    )


def with_library(log: FlightLog, library: Library) -> FlightLog:
    return replace(log, attachments={**log.attachments, LIBRARY_ATTACHMENT: library_text(library).encode()})


def without_commands(log: FlightLog) -> FlightLog:
    series = {name: part for name, part in log.series.items() if name != PRIMITIVE.name}
    return replace(log, series=series, attachments={})


def cut_short(log: FlightLog, *, before: float) -> FlightLog:
    """Returns the log without its last seconds."""
    until = log.duration - before
    series = {
        name: replace(part, time=part.time[part.time <= until], values=part.values[part.time <= until])
        for name, part in log.series.items()
    }
    return replace(log, series=series)


def steady() -> FlightLog:
    return synthetic_log(LIBRARY, (3,), (20.0,), seed=3)


def half_a_maneuver() -> FlightLog:
    log = synthetic_log(only((1, 3)), (1, 3), (10.0, 0.0), seed=3)
    return cut_short(log, before=2.5)


@pytest.mark.parametrize(
    ("log", "words"),
    [
        (steady(), r"expected trim 1 in at least one log"),
        (with_library(steady(), only((3,))), r"expected at least two trims and a maneuver"),
        (without_commands(steady()), r"expected two trims or more"),
        (without_commands(synthetic_log(LIBRARY, (3,), (20.0,), seed=3, noise=STILL)), r"expected two trims"),
        (half_a_maneuver(), r"expected (trim 3|maneuver \d+, flown to its end) in at least one log"),
        (without_commands(half_a_maneuver()), r"expected two trims or more"),
    ],
    ids=["no step", "one trim", "no step in motion", "no noise", "cut", "cut in motion"],
)
def test_a_log_that_makes_no_library_is_refused_with_advice(
    log: FlightLog, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = tmp_path / "flight.mcap", tmp_path / "library.json"
    write_log(log, path, force=False)
    assert run(("identify", str(path), "--out", str(out), "--workers", "1")) == 2
    (line,) = [line for line in capsys.readouterr().err.splitlines() if line.startswith("maneuver: ")]
    assert re.search(words, line)
    assert "--resolution" in line
    assert not out.exists()
    assert not out.with_suffix(".md").exists()


def test_found_trims_are_named_shortly_and_tables_fit_80_columns(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    walk, folder, out = (1, 3, 7, 3, 1, 2, 4, 2, 1), tmp_path / "logs", tmp_path / "found.json"
    folder.mkdir()
    for seed in range(3):
        log = synthetic_log(LIBRARY, walk, [5.0] * len(walk), seed=seed)
        write_log(without_commands(log), folder / f"{seed}.mcap", force=False)
    assert run(("identify", str(folder), "--out", str(out), "--workers", "1")) == 0
    library = read_library(out)
    names = [trim.name for trim in library.trims]
    assert all(len(name) <= 24 and name.startswith("t") for name in names), names
    right = next(trim for trim in library.trims if trim.velocity.yaw_rate > 0.3)
    assert right.name == f"t{right.id} {right.velocity.forward:.1f} m/s R 34°/s"
    assert next(trim for trim in library.trims if trim.velocity == Twist(0.0, 0.0, 0.0)).name.endswith(
        "hover"
    )
    capsys.readouterr()
    assert run(("library", "show", str(out))) == 0
    table = [line for line in capsys.readouterr().out.splitlines() if "m/s" in line and ":" not in line]
    assert table
    assert max(map(len, table)) <= 80
