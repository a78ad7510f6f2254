"""Tests of the documentation against the code."""

import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from flight.mission.campaign import read_campaign
from flight.mission.fault import FAULT_KINDS
from flight.mission.mission import read_mission
from flight.mission.sequence import read_sequence
from flightlog.file.writer import write_log
from tests.support.synthetic_log import synthetic_library, synthetic_log

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"


def checked(tool: str, page: Path) -> subprocess.CompletedProcess[str]:
    """Returns the tool's result for its own or another page."""
    command = [sys.executable, "-m", tool, "--check", str(page)]
    return subprocess.run(command, check=False, cwd=ROOT, capture_output=True, text=True)


@pytest.mark.parametrize(
    ("tool", "page", "words", "complaint"),
    [
        ("tools.log_contract", "flight-log.md", "velocity along the heading", "is not the log's contract"),
        (
            "tools.gallery",
            "review.md",
            "$ maneuver review nominal.mcap",
            "lacks the command `maneuver review nom",
        ),
        ("tools.gallery", "review.md", "(review-fault.png)", "lacks the picture review-fault.png"),
    ],
)
def test_the_pages_that_tools_make_are_what_they_would_make_today(
    tool: str, page: str, words: str, complaint: str, tmp_path: Path
) -> None:
    assert checked(tool, DOCS / page).returncode == 0
    text, altered = (DOCS / page).read_text(encoding="utf-8"), tmp_path / page
    assert words in text
    altered.write_text(text.replace(words, "(another.png)"), encoding="utf-8")
    done = checked(tool, altered)
    assert done.returncode == 1
    assert complaint in done.stderr


def test_the_program_on_the_page_of_the_flight_log_runs(tmp_path: Path) -> None:
    text = (DOCS / "flight-log.md").read_text(encoding="utf-8")
    (program,) = re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)
    write_log(synthetic_log(synthetic_library(), (1, 2), (3.0, 3.0), seed=1), tmp_path / "flight.mcap")
    done = subprocess.run(
        [sys.executable, "-c", program], check=True, cwd=tmp_path, capture_output=True, text=True
    )
    assert [line.split()[0] for line in done.stdout.splitlines()[2:]] == ["COAST", "MANEUVER", "COAST"]


def named_places(text: str) -> set[str]:
    """Returns the modules and tests that a page asks to run."""
    modules = re.findall(r"(?:python -m |`)((?:benchmarks|tools)(?:\.\w+)+)", text)
    files = re.findall(r"\b(?:benchmarks|tools|tests)/[\w/]+\.py\b", text)
    return {*files, *(f"{module.replace('.', '/')}.py" for module in modules)}


def test_every_program_and_test_that_a_page_names_exists() -> None:
    pages = [*ROOT.glob("*.md"), *DOCS.glob("*.md")]
    named = {page.name: named_places(page.read_text(encoding="utf-8")) for page in pages}
    assert len(set[str]().union(*named.values())) > 15
    assert not [
        (name, place) for name, places in named.items() for place in places if not (ROOT / place).is_file()
    ]
    assert named_places(
        "`python -m tools.one a`, `benchmarks.two.three`, pytest tests/four/test_five.py"
    ) == {
        "tools/one.py",
        "benchmarks/two/three.py",
        "tests/four/test_five.py",
    }


@pytest.mark.parametrize(("place", "read"), [(0, read_mission), (1, read_sequence), (2, read_campaign)])
def test_the_examples_of_files_are_read(place: int, read: Callable[[Path], object], tmp_path: Path) -> None:
    text = (DOCS / "files.md").read_text(encoding="utf-8")
    example = tmp_path / "example.toml"
    example.write_text(re.findall(r"```toml\n(.*?)```", text, flags=re.DOTALL)[place], encoding="utf-8")
    assert read(example)


def test_every_kind_of_fault_stands_on_the_page_of_the_helicopter() -> None:
    text = (DOCS / "helicopter.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `(\w+ \w+) START DURATION", text, flags=re.MULTILINE) == [
        " ".join(place) for place in FAULT_KINDS
    ]
    assert all(f"| `{kind.words}` | {kind.meaning} |" in text for kind in FAULT_KINDS.values())
