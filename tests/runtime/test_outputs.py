"""Tests of output files: complete, in place, never over others."""

import os
import shutil
from pathlib import Path

import pytest

import libraries
from flight.errors import AlreadyExistsError, CannotWriteError
from flightlog.file.writer import write_log
from maneuver.app import run
from runtime.atomic_write import write_atomically
from scenarios.find import MISSIONS
from tests.support.refusal import refusal
from tests.support.synthetic_log import synthetic_library, synthetic_log

PLAN = ("plan", "gtmax-2", "--library", "thesis-gtmax", "--policy", "nominal")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def log_path(here: Path) -> Path:
    write_log(synthetic_log(synthetic_library(), [1, 2, 1], [2.0, 2.0, 2.0], seed=1), here / "flight.mcap")
    return here / "flight.mcap"


@pytest.mark.parametrize("place", [".", "..", "/", "", "folder", "new/.."])
def test_a_folder_is_no_name_for_a_file(here: Path, place: str) -> None:
    (here / "folder").mkdir()
    for force in (False, True):
        with pytest.raises(CannotWriteError, match="expected the name of a file, got a folder"):
            write_atomically(b"", Path(place), force=force)
    assert [path.name for path in here.iterdir()] == ["folder"]


def test_a_pipe_is_not_replaced_by_a_file(here: Path) -> None:
    os.mkfifo(here / "pipe")
    with pytest.raises(CannotWriteError, match="expected the name of a file, got a device, a pipe"):
        write_atomically(b"", here / "pipe", force=True)
    assert (here / "pipe").is_fifo()


def test_a_link_stays_and_what_it_leads_to_is_written(here: Path) -> None:
    target, link, dangling = here / "real" / "file", here / "link", here / "dangling"
    write_atomically(b"before", target)
    link.symlink_to("real/file")
    with pytest.raises(AlreadyExistsError):
        write_atomically(b"after", link)
    write_atomically(b"after", link, force=True)
    dangling.symlink_to("real/new")
    write_atomically(b"new", dangling)
    assert link.is_symlink()
    assert dangling.is_symlink()
    assert (target.read_bytes(), (here / "real" / "new").read_bytes()) == (b"after", b"new")
    assert len(list((here / "real").iterdir())) == 2


def test_a_link_to_itself_is_no_place_for_a_file(here: Path) -> None:
    (here / "loop").symlink_to("loop")
    with pytest.raises(CannotWriteError, match="symbolic links"):
        write_atomically(b"", here / "loop", force=True)


@pytest.mark.parametrize(
    "words",
    [
        (*PLAN, "--out", "."),
        (*PLAN, "--picture", "folder.png"),
        ("plan", "gtmax-2", "--pareto", "--out", "."),
        ("fly", "--sequence", "figure-eight", "--out", "."),
        ("library", "graph", "thesis-gtmax", "--out", "folder.png"),
        ("library", "kinematic", "--out", "."),
        ("library", "interpolate", "gtmax-sim", "--out", "."),
        ("identify", "flight.mcap", "--out", "."),
        ("regenerate", "--out", "."),
        ("replay", "flight.mcap", "--out", "."),
        ("recover", "flight.mcap", "--out", "."),
        ("import", "flight.mcap", "--pose", "/pose", "--out", "."),
        ("review", "flight.mcap", "--still", "folder.png"),
        ("validate", "--suite", "random", "--calibrate", "."),
    ],
)
def test_a_verb_refuses_a_folder_for_a_file_in_one_line(
    words: tuple[str, ...], log_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (log_path.parent / "folder.png").mkdir()
    assert "expected the name of a file, got a folder" in refusal(capsys, *words, "--force")
    assert {path.name for path in log_path.parent.iterdir()} == {"flight.mcap", "folder.png"}


@pytest.mark.parametrize(
    "words",
    [
        ("library", "sheet", "thesis-gtmax", "--out", "flight.mcap"),
        ("validate", "--suite", "tables", "--out", "flight.mcap"),
        ("demo", "--out", "flight.mcap"),
    ],
)
def test_a_verb_refuses_a_file_for_a_folder_in_one_line(
    words: tuple[str, ...], log_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "expected the name of a folder" in refusal(capsys, *words, "--force")
    assert list(log_path.parent.iterdir()) == [log_path]


@pytest.mark.parametrize(
    "words",
    [
        ("plan", "m.toml", "--out", "m.toml"),
        ("plan", "m.toml", "--library", "l.json", "--out", "./l.json"),
        ("plan", "m.toml", "--pareto", "--out", "link"),
        ("fly", "--mission", "m.toml", "--out", "m.toml"),
        ("library", "interpolate", "l.json", "--out", "l.json"),
        ("replay", "flight.mcap", "--out", "flight.mcap"),
        ("recover", "flight.mcap", "--out", "flight.mcap"),
        ("import", "flight.mcap", "--pose", "/pose", "--out", "flight.mcap"),
        ("identify", "flight.mcap", "--out", "flight.mcap"),
    ],
)
def test_force_does_not_give_up_what_the_command_reads(
    words: tuple[str, ...], log_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    here = log_path.parent
    shutil.copy(MISSIONS / "gtmax-2.toml", here / "m.toml")
    shutil.copy(libraries.FOLDER / "gtmax-sim.json", here / "l.json")
    (here / "link").symlink_to("m.toml")
    before = {path.name: path.read_bytes() for path in here.iterdir()}
    assert "expected another file than the input" in refusal(capsys, *words, "--force")
    assert {path.name: path.read_bytes() for path in here.iterdir()} == before


@pytest.mark.parametrize(
    "words",
    [
        (*PLAN, "--out", "x.png", "--picture", "./x.png"),
        ("plan", "gtmax-2", "--pareto", "--out", "x.png", "--picture", "x.png"),
        ("fly", "--sequence", "figure-eight", "--out", "x.mp4", "--video", "x.mp4"),
        ("library", "kinematic", "--out", "x.md"),
        ("review", "flight.mcap", "--png", "--out", "r", "--still", "r/flight.png"),
    ],
)
def test_two_results_are_not_written_to_one_file(
    words: tuple[str, ...], log_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert "expected another file than the output" in refusal(capsys, *words, "--force")
    assert list(log_path.parent.iterdir()) == [log_path]


def test_what_exists_is_refused_before_anything_else_is_written(
    log_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    here = log_path.parent
    (here / "x.png").write_text("mine")
    (here / "x.md").write_text("mine")
    assert "x.png exists" in refusal(capsys, *PLAN, "--out", "p.json", "--picture", "x.png")
    assert "x.md exists" in refusal(capsys, "library", "kinematic", "--out", "x.json")
    assert "x.png exists" in refusal(capsys, "review", "flight.mcap", "--html", "--still", "x.png")
    assert {path.name for path in here.iterdir()} == {"flight.mcap", "x.png", "x.md"}


def test_a_picture_is_named_for_what_is_in_it(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "ends with .png, got x.jpg" in refusal(capsys, *PLAN, "--picture", "x.jpg")
    assert list(here.iterdir()) == []


def test_what_one_command_made_another_makes_again_by_force(here: Path) -> None:
    for force in ((), ("--force",)):
        assert run((*PLAN, "--out", "p.json", "--picture", "p.png", *force)) == 0
    assert {path.name for path in here.iterdir()} == {"p.json", "p.png"}
