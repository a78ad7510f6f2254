"""Tests of damaged files of other programs: a flight log or one error line."""

from pathlib import Path
from random import Random

import pytest

from tests.support.studies.hostile_files import Kind, count_wrong, outcome
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
    assert count_wrong(kinds.values(), study, tmp_path) == 0
