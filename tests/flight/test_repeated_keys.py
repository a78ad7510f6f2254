"""Tests of repeated keys: refused in every file format."""

import json
from pathlib import Path

import pytest

from flight.automaton.library_file import library_text, read_library
from flight.errors import BadFileError
from flight.plan.plan import plan_text, read_plan
from tests.support.planning.planned_case import case
from tests.support.synthetic_log import synthetic_library


def test_a_plan_with_two_costs_is_refused(tmp_path: Path) -> None:
    path, text = tmp_path / "plan.json", plan_text(case()[0])
    path.write_text(text)
    assert read_plan(path) == case()[0]
    for old in ('"cost": ', '"tail": ', '"gamma": '):
        path.write_text(text.replace(old, f"{old}1.0,\n  {old}", 1))
        with pytest.raises(
            BadFileError, match=rf"plan.json: {json.loads(old[:-2])}: stands twice in one object"
        ):
            read_plan(path)


def test_a_library_with_two_durations_of_one_maneuver_is_refused(tmp_path: Path) -> None:
    path, text = tmp_path / "library.json", library_text(synthetic_library())
    path.write_text(text.replace('"duration": ', '"duration": 1.0, "duration": ', 1))
    with pytest.raises(BadFileError, match="duration: stands twice in one object"):
        read_library(path)


def test_a_file_of_another_kind_is_distinguished_from_a_newer_version(tmp_path: Path) -> None:
    path = tmp_path / "library.json"
    path.write_text(library_text(synthetic_library()))
    with pytest.raises(
        BadFileError,
        match=r"expected maneuver-plan/2 or maneuver-plan/1, got maneuver-library/1$",
    ):
        read_plan(path)
    path.write_text("{}")
    with pytest.raises(BadFileError, match=r"schema: is missing$"):
        read_plan(path)


def test_a_file_without_an_end_is_not_read_to_it() -> None:
    with pytest.raises(BadFileError, match="expected at most 16777216 bytes, got more"):
        read_plan(Path("/dev/zero"))
