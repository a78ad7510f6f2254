"""Tests of the thesis's shipped libraries and missions."""

from collections.abc import Callable
from math import pi

import pytest

import libraries
from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library import Library
from flight.automaton.library_file import library_text, read_library
from flight.mission.mission import read_mission
from identification.data_sheet import data_sheet
from scenarios.find import MISSIONS


@pytest.mark.parametrize("make", [thesis_kinematic, thesis_gtmax])
def test_the_shipped_thesis_libraries_are_what_the_generator_writes(make: Callable[[], Library]) -> None:
    library = make()
    shipped = libraries.FOLDER / f"{library.name}.json"
    assert shipped.read_text(encoding="utf-8") == library_text(library)
    assert shipped.with_suffix(".md").read_text(encoding="utf-8") == data_sheet(library)


def test_trim_errors_of_the_kinematic_library_are_signed_fractions_of_the_velocity() -> None:
    left = read_library(libraries.FOLDER / "thesis-kinematic.json").trim(5)
    assert left.error.forward == pytest.approx(0.15 * 4, abs=1e-15)
    assert left.error.yaw_rate == pytest.approx(0.2 * -0.4, abs=1e-15)


def test_the_gtmax_library_is_in_metres() -> None:
    maneuver = read_library(libraries.FOLDER / "thesis-gtmax.json").maneuver(2, 1)
    assert maneuver.displacement.x == pytest.approx(6.095 * 0.3048, abs=1e-15)
    assert maneuver.error.side == pytest.approx(-1.939 * 0.3048, abs=1e-15)
    assert maneuver.error.duration == -0.8


def test_suspect_rows_of_the_printed_tables_say_so() -> None:
    gtmax, kinematic = thesis_gtmax(), thesis_kinematic()
    assert {row.id for row in gtmax.maneuvers if "suspect" in row.notes} == {17, 18, 21, 22}
    assert {row.id for row in gtmax.maneuvers if row.notes} == {11, 15, 16, 17, 18, 21, 22}
    assert {row.id for row in kinematic.maneuvers if row.notes} == {13, 14, 15, 16, 17, 18}


def test_the_five_missions_of_chapter_7_are_shipped() -> None:
    found = {path.stem: read_mission(path) for path in MISSIONS.glob("*.toml")}
    assert {"kinematic-1", "kinematic-2", "kinematic-3", "gtmax-1", "gtmax-2"} <= set(found)
    assert all(mission.name == name for name, mission in found.items())
    assert found["kinematic-1"].start.heading == 3 * pi / 4
    assert found["gtmax-2"].goal == pytest.approx((50 * 0.3048, 20 * 0.3048))
    assert found["gtmax-2"].tolerance == pytest.approx(3 * 0.3048)
