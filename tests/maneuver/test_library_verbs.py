"""Tests of library verbs: audits, kinematics, differences and sheets."""

import json
from dataclasses import replace
from math import cos, sin
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

import libraries
from experiments.thesis.error_ratios import NOT_EXPLAINED, error_ratios, is_comparable
from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library import Library
from flight.automaton.library_diff import library_differences
from flight.automaton.library_file import library_text, read_library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.se2 import SE2, Twist
from identification.design.kinematic_library import average_displacement, read_kinematic_library
from maneuver.app import run
from planner.independent_errors.monotonicity_audit import PrimitiveScalar, audit_monotonicity


def simple(forward_error: float) -> Library:
    """Returns a library of two straight trims and exact quarter turns."""
    trims = (
        Trim(1, "one", Twist(2.0, 0.0, 0.0), Twist(forward_error, 0.0, 0.0)),
        Trim(2, "two", Twist(2.0, 0.0, 0.0), Twist(0.0, 0.0, 0.0)),
    )
    exact = ManeuverError(0.0, 0.0, 0.0, 0.0)
    turns = tuple(
        Maneuver(number, *edge, 1.0, SE2(0.0, 0.0, 1.5707963267948966), exact)
        for number, edge in enumerate(((1, 2), (2, 1)), start=1)
    )
    return Library("simple", "", "", trims, turns)


def test_where_only_speed_is_uncertain_faster_is_never_slower() -> None:
    result = audit_monotonicity(simple(0.3), missions=60, seed=1)
    assert result.reachable > 20
    assert result.monotone == result.reachable


def test_an_error_signed_the_wrong_way_is_named() -> None:
    """Negative control: gamma = +1 makes the first trim slower."""
    result = audit_monotonicity(simple(-0.3), missions=60, seed=1)
    assert result.monotone < result.reachable
    assert {rise.culprit for rise in result.rises} == {PrimitiveScalar("trim", 1, "forward")}


def test_the_verb_prints_how_often_and_why(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["library", "audit", "thesis-kinematic", "--missions", "40"]) == 0
    said = capsys.readouterr().out
    assert "optimal time never rises" in said
    assert "signed by the rule" in said
    assert run(["library", "audit", "thesis-kinematic", "--missions", "40", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["missions"] == 40


@given(st.floats(0, 10), st.floats(0, 10), st.floats(-0.6, 0.6), st.floats(-0.6, 0.6), st.floats(0.1, 6))
def test_the_kinematic_equations_are_those_of_the_thesis(
    slow: float, fast: float, before: float, after: float, duration: float
) -> None:
    moved = average_displacement(Twist(slow, 0, before), Twist(fast, 0, after), duration)
    turned = 0.5 * (after - before) / duration * duration**2 + before * duration
    acceleration = ((fast * cos(turned) - slow) / duration, fast * sin(turned) / duration)
    assert moved.heading == pytest.approx(turned, abs=1e-9)
    assert moved.x == pytest.approx(0.5 * acceleration[0] * duration**2 + slow * duration, abs=1e-9)
    assert moved.y == pytest.approx(0.5 * acceleration[1] * duration**2, abs=1e-9)


def test_straight_rows_of_table_6_follow_and_turning_ones_are_shown_to_differ(
    capsys: pytest.CaptureFixture[str],
) -> None:
    made = read_kinematic_library(libraries.FOLDER / "kinematic.toml")
    assert made.trims == thesis_kinematic().trims
    assert made.maneuver(2, 1).displacement == SE2(5.0, 0.0, 0.0)
    assert made.maneuver(6, 5).displacement.x == pytest.approx(16.0)
    assert run(["library", "kinematic"]) == 0
    said = capsys.readouterr().out
    assert "2 of 18 maneuvers equal those of thesis-kinematic" in said
    assert "14.00 -7.00" in said


def test_a_kinematic_file_with_an_unknown_trim_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "bad.toml"
    file.write_text(
        'name = "bad"\ntrims = [{ id = 1, name = "one", forward = 1.0 }]\n'
        "maneuvers = [{ id = 1, from = 1, to = 9, duration = 2.0 }]\n"
    )
    assert run(["library", "kinematic", str(file)]) == 2
    assert "no trim 9; there are [1]" in capsys.readouterr().err


def test_a_library_is_the_same_as_itself_and_every_change_is_found(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    first = thesis_gtmax()
    assert library_differences(first, first) == ()
    changed = replace(first.maneuvers[3], duration=4.5)
    second = replace(
        first, maneuvers=(*first.maneuvers[:3], changed, *first.maneuvers[4:-1]), description="other"
    )
    found = {(one.part, one.place): (one.first, one.second) for one in library_differences(first, second)}
    assert found == {
        ("library", "description"): (first.description, "other"),
        ("maneuver 4", "duration"): (4.0, 4.5),
        ("maneuver 22", ""): ("there", None),
    }
    path = tmp_path / "second.json"
    path.write_text(library_text(second))
    assert run(["library", "diff", "thesis-gtmax", "thesis-gtmax"]) == 0
    assert run(["library", "diff", "thesis-gtmax", str(path)]) == 1
    assert "3 differences in 2 primitives" in capsys.readouterr().out


def test_the_sheet_explains_every_ratio_that_is_far_from_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shipped, printed = read_library(libraries.FOLDER / "gtmax-sim.json"), thesis_gtmax()
    rows = list(error_ratios(shipped, printed))
    assert len(rows) == 3 * 7 + 4 * 22
    assert not [row for row in rows if row.why == NOT_EXPLAINED]
    assert not is_comparable(thesis_kinematic(), printed)
    out = tmp_path / "sheet"
    assert run(["library", "sheet", "gtmax-sim", "--out", str(out)]) == 0
    capsys.readouterr()
    text = (out / "sheet.md").read_text()
    assert "ft/s" in text
    assert "## Flights used" in text
    assert {path.name for path in out.iterdir()} == {"sheet.md", "graph.png", "numbers.png"}


def test_a_ratio_without_explanation_is_marked() -> None:
    printed = thesis_gtmax()
    off = replace(printed.trims[1], error=Twist(100.0, 0.1, 0.01))
    library = replace(printed, trims=(printed.trims[0], off, *printed.trims[2:]))
    why = {(row.kind, row.id, row.name): row.why for row in error_ratios(library, printed)}
    assert why["trim", 2, "forward"] == NOT_EXPLAINED
    assert why["trim", 3, "forward"] == ""


def test_the_graph_of_any_library_is_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("thesis-kinematic", "trends-turns"):
        path = tmp_path / f"{name}.png"
        assert run(["library", "graph", name, "--out", str(path)]) == 0
        assert path.stat().st_size > 20_000
    assert run(["library", "graph", "thesis-gtmax", "--out", str(tmp_path / "graph.pdf")]) == 2
    assert "ends with .png" in capsys.readouterr().err
