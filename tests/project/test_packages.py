"""Tests of the list of packages in pyproject and its copies."""

import re
from collections import Counter
from itertools import chain
from typing import Any

import pytest

from runtime.version import VERSION
from tests.support.packages import PYPROJECT, ROOT, SHIPPED, UNSHIPPED

TOOLS = PYPROJECT["tool"]


def layers() -> list[str]:
    contracts: list[dict[str, Any]] = TOOLS["importlinter"]["contracts"]
    (contract,) = (one for one in contracts if one["type"] == "layers")
    return [name for layer in contract["layers"] for name in layer.split(" | ")]


def test_every_folder_of_code_is_a_package_that_is_named() -> None:
    assert sorted(SHIPPED) == list(SHIPPED)
    assert sorted(path.parent.name for path in ROOT.glob("*/__init__.py")) == sorted([*SHIPPED, *UNSHIPPED])


@pytest.mark.parametrize(
    ("copy", "expected"),
    [
        (TOOLS["importlinter"]["root_packages"], [*SHIPPED, *UNSHIPPED]),
        (layers(), [*SHIPPED, *UNSHIPPED]),
    ],
    ids=["import-linter", "layers"],
)
def test_every_copy_of_the_list_is_the_same(copy: list[str], expected: list[str]) -> None:
    assert sorted(copy) == sorted(expected)


def test_every_package_of_the_wheel_has_a_type_marker() -> None:
    assert [name for name in SHIPPED if not (ROOT / name / "py.typed").is_file()] == []


def test_the_citation_is_of_this_version_and_the_changelog_dates_it() -> None:
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.findall(r"^version: (.+)$", citation, flags=re.MULTILINE) == [VERSION]
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(rf"^## {re.escape(VERSION)} \(\d{{4}}-\d\d-\d\d\)$", changelog, flags=re.MULTILINE)


def test_no_folder_of_tests_holds_more_than_seventeen_files() -> None:
    files = chain.from_iterable((ROOT / "tests").rglob(pattern) for pattern in ("*.py", "*.gz", "golden/*"))
    assert max(Counter(path.parent for path in set(files)).values()) <= 17


def test_no_folder_of_code_holds_more_than_seventeen_files() -> None:
    files = [
        path
        for package in SHIPPED
        for pattern in ("*.py", "*.c", "*.h", "*.js")
        for path in (ROOT / package).rglob(pattern)
    ]
    assert max(Counter(path.parent for path in files).values()) <= 17


def test_every_marker_is_used() -> None:
    tests = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py"))
    markers = [line.split(":")[0] for line in TOOLS["pytest"]["ini_options"]["markers"]]
    assert len(markers) == 4
    assert [name for name in markers if f"pytest.mark.{name}\n" not in tests] == []


def test_no_test_imports_another() -> None:
    imports = re.compile(r"^\s*(?:from|import) .*\btest_\w+", flags=re.MULTILINE)
    assert imports.search("from .test_plans import case")
    assert not [path.name for path in (ROOT / "tests").rglob("*.py") if imports.search(path.read_text())]
