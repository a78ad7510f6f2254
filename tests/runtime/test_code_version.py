"""Code versions: of flights by what flies, of results also by the evaluation."""

import shutil
from pathlib import Path

import grimp
import pytest

from runtime.code_version import EVALUATION_CODE, EXCLUDED, FLIGHT_CODE, code_version, digest
from runtime.version import VERSION

ROOT = Path(__file__).parents[2]

ROUND_ABOUT = {
    "experiments.campaign": "a flight's seed is in its specification, which is in the log",
    "experiments.mission": "what a flight came to: judged",
    "identification": "how primitives are cut: judged",
    "libraries": "a flight's library is in the log",
    "planner.independent_errors": "the price of robustness, which is not flown",
    "runtime": "processes and files",
    "scenarios": "missions and faults are in the log",
}
"""Imports of a flight's modules that do not decide how it goes, with the reason."""


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Path:
    copy = tmp_path_factory.mktemp("tree")
    for folder in ("experiments", "flight", "flightlog", "identification", "maneuver", "models", "planner"):
        shutil.copytree(ROOT / folder, copy / folder)
    for folder in ("review", "runtime", "sim"):
        shutil.copytree(ROOT / folder, copy / folder)
    return copy


@pytest.mark.parametrize(
    ("file", "flies", "judges"),
    [
        ("sim/supervisor.py", True, False),
        ("models/gtmax.toml", True, False),
        ("planner/kernel/walks/search.c", True, False),
        ("planner/check/plan_check.py", True, False),
        ("runtime/compiler.py", True, False),
        ("experiments/mission/fly.py", True, True),
        ("experiments/mission/error_attribution.py", False, True),
        ("identification/segmentation/segmentation.py", False, True),
        ("maneuver/fly.py", False, False),
        ("maneuver/app.py", False, False),
        ("review/page/page.py", False, False),
        ("flightlog/imports/px4_log.py", False, False),
        ("sim/checks/margins.py", False, False),
        ("experiments/validation/scorecard_files.py", False, False),
    ],
)
def test_a_changed_file_shows_where_it_matters(tree: Path, file: str, flies: bool, judges: bool) -> None:
    before = digest(FLIGHT_CODE, tree), digest(EVALUATION_CODE, tree)
    path = tree / file
    content = path.read_bytes()
    path.write_bytes(content + b"\n")
    after = digest(FLIGHT_CODE, tree), digest(EVALUATION_CODE, tree)
    path.write_bytes(content)
    assert [one != two for one, two in zip(before, after, strict=True)] == [flies, judges]
    assert (digest(FLIGHT_CODE, tree), digest(EVALUATION_CODE, tree)) == before


def test_the_version_is_the_release_and_the_digest_of_this_tree() -> None:
    assert code_version() == f"{VERSION}+{digest(FLIGHT_CODE, ROOT)}"


def test_every_place_exists() -> None:
    assert all((ROOT / place).exists() for place in (*FLIGHT_CODE, *EVALUATION_CODE, *EXCLUDED))


def test_what_a_flight_passes_through_is_in_the_digest_or_no_matter() -> None:
    graph = grimp.build_graph(
        *("experiments", "flight", "flightlog", "identification", "libraries", "models", "planner"),
        *("runtime", "scenarios", "sim"),
        cache_dir=None,
    )
    roots = {"sim.campaign_flight", "experiments.mission.fly"}
    reached = roots.union(*(graph.find_upstream_modules(root) for root in roots))
    files = {name: ROOT / f"{name.replace('.', '/')}.py" for name in reached}
    covered = [ROOT / place for place in FLIGHT_CODE]
    apart = [ROOT / place for place in EXCLUDED]
    assert len(files) > 50
    for name, file in files.items():
        is_in = any(file.is_relative_to(place) or place == file.with_suffix("") for place in covered)
        assert is_in or any(name == one or name.startswith(f"{one}.") for one in ROUND_ABOUT), name
        assert not any(file.is_relative_to(place) for place in apart), name
