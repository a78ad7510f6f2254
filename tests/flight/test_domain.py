"""Tests of warnings outside a library's domain, none of them a refusal."""

from dataclasses import replace
from pathlib import Path

import pytest

from experiments.mission.result import FlownLeg, flown_walk
from flight.automaton.conditions import Conditions
from flight.automaton.domain import air_domain_warnings, vehicle_domain_warnings, walk_domain_warnings
from flight.automaton.library_file import library_text, read_library
from libraries import FOLDER
from maneuver.app import run
from maneuver.options.domain_warnings import warn_of_flight, warn_of_walks

BOOK = read_library(FOLDER / "thesis-gtmax.json")
LIBRARY = replace(
    BOOK,
    name="mine",
    conditions=Conditions(
        wind="gtmax",
        altitude=30.0,
        trim_error_kind="instantaneous",
        coasting_range=(2.0, 8.0),
        vehicle_hash="a" * 64,
        speed_range=(0.0, 2.0),
        entry_trims=(1, 2, 3),
    ),
)


def test_inside_the_domain_nothing_is_said() -> None:
    assert walk_domain_warnings(LIBRARY, (1, 2, 1), (2.0, 8.0, 3.0)) == ()
    assert vehicle_domain_warnings(LIBRARY, vehicle_hash="a" * 64) == ()
    assert air_domain_warnings(LIBRARY, wind="gtmax", stronger=False, altitude=30.0) == ()


def test_each_departure_is_named() -> None:
    assert walk_domain_warnings(LIBRARY, (1, 2, 3, 1), (2.0, 1.0, 9.0, 2.0)) == (
        "trims 3 are outside the speeds flown, 0 to 2 m/s",
        "coast in trim 2 (< 2.0 s) is shorter than any in the data",
        "coast in trim 3 (> 8.0 s) is longer than any in the data",
    )
    assert walk_domain_warnings(LIBRARY, (1, 2, 4, 2), (2.0,) * 4) == (
        "no data: maneuvers leaving trims 4 were never flown",
    )
    assert vehicle_domain_warnings(LIBRARY, vehicle_hash="b" * 64) == (
        "the vehicle is bbbbbbbbbbbb, the library was identified from aaaaaaaaaaaa",
    )
    assert air_domain_warnings(LIBRARY, wind="severe", stronger=True, altitude=60.0) == (
        "the wind is severe, stronger than gtmax",
        "the altitude is 60 m, the library's is 30 m",
    )


def test_averaged_errors_bound_no_coast_shorter_than_flown() -> None:
    averaged = replace(LIBRARY, conditions=replace(LIBRARY.conditions, trim_error_kind="averaged"))
    (said,) = walk_domain_warnings(averaged, (1, 2, 1), (3.0, 0.5, 3.0))
    assert said.endswith("averaged errors do not bound it")


def test_the_first_trim_was_held_before_and_the_last_coast_is_cut_by_the_goal() -> None:
    assert walk_domain_warnings(LIBRARY, (1, 2, 1), (0.0, 3.0, 0.0)) == ()


def test_a_library_that_states_no_domain_cannot_be_left() -> None:
    assert walk_domain_warnings(BOOK, (1, 2, 4, 2), (0.0, 0.0, 99.0, 0.0)) == ()
    assert vehicle_domain_warnings(BOOK, vehicle_hash="b" * 64) == ()
    assert air_domain_warnings(BOOK, wind="gtmax", stronger=False, altitude=99.0) == ()


@pytest.mark.parametrize(("wind", "stronger"), [("calm", False), ("gtmax", False), ("light", True)])
def test_only_stronger_wind_is_named(wind: str, stronger: bool, capsys: pytest.CaptureFixture[str]) -> None:
    warn_of_flight(LIBRARY, wind=wind, altitude=30.0)
    said = capsys.readouterr().err
    assert ("stronger than gtmax" in said) == stronger
    # No library has the hash above.
    assert "outside the domain of mine: the vehicle is " in said


def test_planning_outside_the_domain_warns_and_plans(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.json"
    path.write_text(library_text(LIBRARY))
    assert run(("plan", "gtmax-2", "--library", str(path), "--policy", "nominal")) == 0
    output = capsys.readouterr()
    assert "outside the domain of mine: trims 3" in output.err
    assert "optimal" in output.out


def test_what_a_closed_loop_flew_is_held_against_the_domain(capsys: pytest.CaptureFixture[str]) -> None:
    held = FlownLeg(trim=2, to_trim=None, start=0.0, duration=0.4, track=())
    left = FlownLeg(trim=2, to_trim=3, start=0.8, duration=4.0, track=())
    walk = flown_walk([held, held, left, FlownLeg(3, None, 4.8, 0.5, ()), FlownLeg(3, 1, 5.3, 4.0, ())])
    assert walk == ([2, 3, 1], [0.8, 0.5, 0.0])
    warn_of_walks(LIBRARY, [walk])
    assert "coast in trim 3 (< " in capsys.readouterr().err
    warn_of_walks(LIBRARY, [walk, ([1, 2, 1], [2.0, 8.0, 3.0])])
    assert "1 of 2 flights" in capsys.readouterr().err
    warn_of_walks(LIBRARY, [([1, 2, 1], [2.0, 8.0, 3.0])])
    assert capsys.readouterr().err == ""
