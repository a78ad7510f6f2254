"""Tests of file values: required, optional and repeated keys."""

import json
import pickle
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from flight.automaton.library_file import library_hash, library_text, parse_library
from flight.errors import BadFileError
from flight.plan.plan import PlanContradictionError, plan_text, read_plan
from flight.se2 import Twist
from tests.support.planning.planned_case import case
from tests.support.synthetic_log import synthetic_library

OPTIONAL_OF_A_PLAN = {"reason", "alpha", "tail", "miss", "lower_bound", "cost"}
LIBRARY = synthetic_library()


def without_each_key(content: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for key in content:
        yield key, {name: value for name, value in content.items() if name != key}


def test_a_plan_states_what_python_has_a_default_for(tmp_path: Path) -> None:
    path, content = tmp_path / "plan.json", json.loads(plan_text(case()[0]))
    for key, lacking in without_each_key(content):
        path.write_text(json.dumps(lacking))
        if key in OPTIONAL_OF_A_PLAN - {"cost"}:
            read_plan(path)
        else:
            with pytest.raises(BadFileError, match=rf"plan.json: {key}: (is missing|the deciding)"):
                read_plan(path)


def test_a_library_states_its_conditions_and_its_provenance() -> None:
    content = json.loads(library_text(LIBRARY))
    for key, lacking in without_each_key(content):
        with pytest.raises(BadFileError, match=rf"text: {key}: is missing"):
            parse_library(json.dumps(lacking), "text")
    for key in ("wind", "trim_error_kind"):
        conditions = {name: value for name, value in content["conditions"].items() if name != key}
        with pytest.raises(BadFileError, match=rf"text: conditions.{key}: is missing"):
            parse_library(json.dumps(content | {"conditions": conditions}), "text")


def test_null_equals_a_missing_key() -> None:
    content = json.loads(library_text(LIBRARY))
    content["trims"][0] |= {"averaged": None, "statistics": None}
    content["maneuvers"][0] |= {"notes": None, "interpolated": None}
    content["conditions"]["altitude"] = None
    read = parse_library(json.dumps(content), "text")
    assert read == replace(LIBRARY, conditions=replace(LIBRARY.conditions, altitude=None))
    assert "null" not in library_text(read)


def test_a_plan_that_states_another_cost_than_it_has_is_refused_by_name(tmp_path: Path) -> None:
    path, content = tmp_path / "plan.json", json.loads(plan_text(case()[0]))
    for changed, words in (
        ({"cost": 1.0}, r"cost: the deciding scenario takes .* s, got 1.0 s"),
        ({"coasting_times": []}, "coasting_times: those of the deciding scenario, got others"),
        ({"status": "unknown", "scenarios": [], "verified": False}, "cost: the deciding scenario takes inf"),
    ):
        path.write_text(json.dumps(content | changed))
        with pytest.raises(PlanContradictionError, match=words):
            read_plan(path)
    path.write_text(json.dumps(content | {"cost": "1.0"}))
    with pytest.raises(BadFileError, match=r"cost: Input should be a valid number, got '1\.0'"):
        read_plan(path)


def test_a_whole_number_is_written_as_the_number_that_is_read_back() -> None:
    still, whole = (
        replace(LIBRARY, trims=(replace(LIBRARY.trims[0], velocity=twist), *LIBRARY.trims[1:]))
        for twist in (Twist(2.0, 0.0, 0.0), Twist(2, 0, 0))
    )
    assert library_text(still) == library_text(whole)


def test_the_hash_of_a_library_is_worked_out_once_and_goes_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    library = synthetic_library()
    known = library_hash(library)
    monkeypatch.setattr("flight.automaton.library.json_content", lambda _: pytest.fail("written again"))
    assert library_hash(library) == known
    assert library_hash(pickle.loads(pickle.dumps(library))) == known
    monkeypatch.undo()
    assert library_hash(replace(library, name="another")) != known
