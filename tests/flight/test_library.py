"""Tests of libraries: consistency, exact files, one-line refusals."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import libraries
from flight.automaton.library_file import (
    library_hash,
    library_json_schema,
    library_text,
    parse_library,
    read_library,
)
from flight.errors import BadFileError, FlightError, NoManeuverError, UnknownTrimError
from flight.se2 import Twist
from tests.support.synthetic_log import synthetic_library

SCHEMA = libraries.FOLDER / "library.schema.json"

numbers = st.floats(allow_nan=False, allow_infinity=False)


@given(numbers, numbers, numbers)
def test_numbers_round_trip_to_the_last_bit(forward: float, side: float, yaw_rate: float) -> None:
    library = synthetic_library()
    trim = replace(library.trims[0], velocity=Twist(forward, side, yaw_rate))
    conditions = replace(library.conditions, coasting_range=(abs(side), abs(yaw_rate)))
    changed = replace(library, trims=(trim, *library.trims[1:]), conditions=conditions)
    assert parse_library(library_text(changed), "text") == changed


@pytest.mark.parametrize(
    "path", sorted(set(libraries.FOLDER.glob("*.json")) - {SCHEMA}), ids=lambda path: path.stem
)
def test_a_shipped_library_is_its_own_text(path: Path) -> None:
    library = read_library(path)
    assert library.name == path.stem
    assert library_text(library) == path.read_text()


def test_the_hash_changes_with_the_last_bit_of_a_number() -> None:
    library = synthetic_library()
    trim = library.trims[1]
    nudged = replace(trim, velocity=replace(trim.velocity, forward=trim.velocity.forward * (1 + 2e-16)))
    changed = replace(library, trims=(library.trims[0], nudged, *library.trims[2:]))
    assert library_hash(changed) != library_hash(library)


def test_the_shipped_json_schema_is_the_one_that_is_checked() -> None:
    shipped = json.loads(SCHEMA.read_text())
    assert shipped == library_json_schema()


def test_an_unknown_trim_is_named_with_those_that_exist() -> None:
    with pytest.raises(UnknownTrimError, match=r"no trim 9; the library has \[1, 2, 3, 4, 5, 6, 7\]"):
        synthetic_library().trim(9)


def test_a_maneuver_that_does_not_exist_is_refused_with_those_that_do() -> None:
    with pytest.raises(NoManeuverError, match=r"no maneuver from trim 1 to trim 7; .* reaches \[2, 3\]"):
        synthetic_library().maneuver(1, 7)


def _unknown_trim(content: dict[str, Any]) -> None:
    content["maneuvers"][4]["to"] = 99


def _double_edge(content: dict[str, Any]) -> None:
    content["maneuvers"][4] |= {"from": 2, "to": 1}


def _duplicate_trim(content: dict[str, Any]) -> None:
    content["trims"][3]["id"] = 1


def _duplicate_maneuver(content: dict[str, Any]) -> None:
    content["maneuvers"][3]["id"] = 1


def _negative_duration(content: dict[str, Any]) -> None:
    content["maneuvers"][2]["duration"] = -1.0


def _not_finite(content: dict[str, Any]) -> None:
    content["trims"][2]["velocity"]["forward"] = float("nan")


def _infinite_error(content: dict[str, Any]) -> None:
    content["maneuvers"][2]["error"]["side"] = float("inf")


def _missing_part(content: dict[str, Any]) -> None:
    del content["maneuvers"][1]["displacement"]


def _unknown_part(content: dict[str, Any]) -> None:
    content["trims"][0]["colour"] = "red"


def _newer(content: dict[str, Any]) -> None:
    content["schema"] = "maneuver-library/2"


def _no_trims(content: dict[str, Any]) -> None:
    content["trims"] = []


def _number_as_text(content: dict[str, Any]) -> None:
    content["maneuvers"][0]["duration"] = "4.0"


def _no_band(content: dict[str, Any]) -> None:
    del content["conditions"]["maneuver_end"]["band"][0]


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (_unknown_trim, r"maneuvers\[4\].to: no trim 99"),
        (_double_edge, r"maneuvers\[4\]: maneuvers 1 and 5 both lead from trim 2 to trim 1"),
        (_duplicate_trim, r"trims\[3\].id: 1 is taken by trims\[0\]"),
        (_duplicate_maneuver, r"maneuvers\[3\].id: 1 is taken"),
        (_negative_duration, r"maneuvers\[2\].duration: .*greater than or equal to 0"),
        (_not_finite, r"trims\[2\].velocity.forward: .*finite"),
        (_infinite_error, r"maneuvers\[2\].error.side: .*finite"),
        (_missing_part, r"maneuvers\[1\].displacement: is missing"),
        (_unknown_part, r"trims\[0\].colour: Extra inputs are not permitted"),
        (_newer, r"expected maneuver-library/1, got maneuver-library/2"),
        (_no_trims, r"trims: .*at least 1"),
        (_number_as_text, r"maneuvers\[0\].duration: .*valid number"),
        (_no_band, r"conditions.maneuver_end.band: expected one for each of the trims"),
    ],
)
def test_a_library_that_contradicts_itself_is_refused_in_one_line(
    tmp_path: Path, spoil: Callable[[dict[str, Any]], None], words: str
) -> None:
    content = json.loads(library_text(synthetic_library()))
    spoil(content)
    path = tmp_path / "broken.json"
    path.write_text(json.dumps(content))
    with pytest.raises(BadFileError, match=words) as caught:
        read_library(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["", "{", "[]", "null", '{"schema": 1}', "\x00", '{"a":' * 5000])
def test_text_that_is_no_library_is_refused_in_one_line(tmp_path: Path, text: str) -> None:
    path = tmp_path / "broken.json"
    path.write_text(text)
    with pytest.raises(BadFileError) as caught:
        read_library(path)
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_refused_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(FlightError, match="cannot be read: No such file"):
        read_library(tmp_path / "nowhere.json")
