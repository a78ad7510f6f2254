"""Pages say what the code says."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from flight.mission.campaign import read_campaign
from flight.mission.fault import FAULT_KINDS
from flight.mission.mission import read_mission
from flight.mission.sequence import read_sequence
from tools.gallery import SHOTS, commands
from tools.log_contract import PAGE, page


def test_the_page_of_the_flight_log_is_the_contract() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()


@pytest.mark.parametrize(("place", "read"), [(0, read_mission), (1, read_sequence), (2, read_campaign)])
def test_the_examples_of_files_are_read(place: int, read: Callable[[Path], object], tmp_path: Path) -> None:
    text = (PAGE.parent / "files.md").read_text(encoding="utf-8")
    example = tmp_path / "example.toml"
    example.write_text(re.findall(r"```toml\n(.*?)```", text, flags=re.DOTALL)[place], encoding="utf-8")
    assert read(example)


def test_every_kind_of_fault_stands_on_the_page_of_the_helicopter() -> None:
    text = (PAGE.parent / "helicopter.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `(\w+ \w+) START DURATION", text, flags=re.MULTILINE) == [
        " ".join(place) for place in FAULT_KINDS
    ]
    assert all(f"| `{kind.words}` | {kind.meaning} |" in text for kind in FAULT_KINDS.values())


def test_the_gallery_shows_the_commands_that_make_it_and_its_pictures_exist() -> None:
    text = (PAGE.parent / "review.md").read_text(encoding="utf-8")
    shown = {line[2:] for line in text.splitlines() if line.startswith("$ ")}
    assert set(commands()) <= shown
    pictures = re.findall(r"!\[[^\]]+\]\(([^)]+)\)", text)
    assert len(pictures) == len(SHOTS)
    assert all((PAGE.parent / picture).is_file() for picture in pictures)
