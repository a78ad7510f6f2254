"""Tests of damaged files of other programs: a flight log or one error line."""

from collections import Counter
from itertools import cycle
from pathlib import Path
from random import Random

import pytest

from tests.support.studies.hostile_files import Kind, outcome
from tests.support.studies.hostile_imports import kinds_of_imports
from tests.support.studies.study import Study

pytest.importorskip("pyulog", reason="pyulog is an extra")
pytest.importorskip("pymavlink", reason="pymavlink is an extra")

NAMES = ("table", "JSON bag", "ROS 2 bag", "ULog", "DataFlash log")


@pytest.fixture(scope="module")
def kinds() -> dict[str, Kind]:
    return {kind.name: kind for kind in kinds_of_imports()}


@pytest.mark.parametrize("name", NAMES)
def test_a_good_file_is_imported(kinds: dict[str, Kind], name: str, tmp_path: Path) -> None:
    path = tmp_path / f"good{kinds[name].suffix}"
    path.write_bytes(kinds[name].content)
    assert kinds[name].use(path) == 0


@pytest.mark.parametrize("name", NAMES)
def test_a_mutated_import_is_a_flight_or_refused_in_one_line(
    kinds: dict[str, Kind], name: str, tmp_path: Path
) -> None:
    found = [outcome(kinds[name], Random(f"{name} {n}"), tmp_path) for n in range(15)]
    assert not [result for result in found if result.startswith("wrong")]


@pytest.mark.slow
def test_study_of_mutated_imports(kinds: dict[str, Kind], study: Study, tmp_path: Path) -> None:
    mutations, seed = study.size("mutations", 1000), study.size("seed", 1)
    outcomes = Counter[tuple[str, str]]()
    for number, kind in zip(range(mutations), cycle(kinds.values()), strict=False):
        result = outcome(kind, Random(f"{seed} {number}"), tmp_path)
        outcomes[kind.name, result] += 1
        if result.startswith("wrong"):
            study.show(f"mutation {number} of seed {seed}: {kind.name}: {result}")
    for (name, result), count in sorted(outcomes.items()):
        study.show(f"{name:13s} {count:6d}  {result}")
    wrong = sum(count for (_, result), count in outcomes.items() if result.startswith("wrong"))
    study.show_share(wrong, mutations, "mutations")
    assert wrong == 0
