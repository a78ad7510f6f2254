"""Tests of error messages: each is listed, and one plain line."""

import ast
import re
import shlex
from pathlib import Path

import pytest

import libraries
from flight.errors import FlightError
from flight.plan.plan import plan_text
from tests.support.packages import SHIPPED
from tests.support.refusal import refusal

from .error_messages import MESSAGES, NO_PLAN
from .error_sites import error_classes, message_patterns
from .text_rules import DIALECT_IN_HELP, sources

HERE = Path(__file__).parent
_LINES = (HERE / "refused_commands.txt").read_text(encoding="utf-8").splitlines()
REFUSED = list(zip(_LINES[::2], (line.strip() for line in _LINES[1::2]), strict=True))
"""Commands that are refused, with the line that each prints."""

PLACES = (HERE / "error_places.txt").read_text(encoding="utf-8").splitlines()
"""Examples of the other messages, without the file's name before them."""

ALL = [*(text for _, text in MESSAGES), *(text for _, text in REFUSED), *PLACES]

PRODUCT = [(place, module) for place, module in sources() if place.split("/")[0] in SHIPPED]
CLASSES = error_classes(module for _, module in PRODUCT)

RELAYS = {"BadFileError", "CannotWriteError"}
"""Errors that write a file's name before the message of the place that raises them."""


RAISED = {name for name, writes in CLASSES.items() if not writes} | RELAYS


def unlisted(place: str, module: ast.Module) -> list[str]:
    """Returns the messages of a module's raise statements that no list has."""
    return [
        f"{place}:{line}: {pattern}"
        for line, pattern in message_patterns(module, RAISED)
        if not any(re.search(pattern, text) for text in ALL)
    ]


@pytest.mark.parametrize(("error", "text"), MESSAGES, ids=lambda part: type(part).__name__)
def test_an_error_writes_the_message_of_the_list(error: FlightError, text: str) -> None:
    assert str(error) == text


def test_every_error_that_writes_a_message_is_in_the_list() -> None:
    assert {type(error).__name__ for error, _ in MESSAGES} == {
        name for name, writes in CLASSES.items() if writes
    }


def test_every_message_written_where_an_error_is_raised_is_in_a_list() -> None:
    assert not [message for place, module in PRODUCT for message in unlisted(place, module)]


def test_every_message_of_a_place_is_still_written_there() -> None:
    patterns = [pattern for _, module in PRODUCT for _, pattern in message_patterns(module, RAISED)]
    assert not [text for text in PLACES if not any(re.fullmatch(pattern, text) for pattern in patterns)]


@pytest.mark.parametrize("error", ["FlightError", "FilmError", "BadFileError"])
def test_a_message_that_is_in_no_list_is_found(error: str) -> None:
    source = f'def f(x):\n    raise {error}(x, f"a riddle of {{x}} in no list")\n'
    assert unlisted("flight/riddle.py", ast.parse(source)) == [
        "flight/riddle.py:2: a\\ riddle\\ of\\ .*\\ in\\ no\\ list"
    ]


def test_an_error_class_of_any_depth_is_found() -> None:
    source = (
        "class LateError(FlightError):\n    pass\n"
        "class TooLateError(LateError):\n    def __init__(self):\n        super().__init__('late')\n"
    )
    found = error_classes([ast.parse(source)])
    assert (found["LateError"], found["TooLateError"]) == (False, True)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Working folder with files that are refused."""
    monkeypatch.chdir(tmp_path)
    for name in ("empty", "full"):
        (tmp_path / name).mkdir()
    for name in ("full/a.txt", "text.mcap", "text.csv", "text.ulg"):
        (tmp_path / name).write_text("no data\n", encoding="utf-8")
    (tmp_path / "table.csv").write_text("s,x,y\n0,1,north\n1,2,north\n2,3,north\n", encoding="utf-8")
    library = (libraries.FOLDER / "thesis-gtmax.json").read_text(encoding="utf-8")
    (tmp_path / "library.json").write_text(library, encoding="utf-8")
    newer = library.replace("maneuver-library/1", "maneuver-library/2")
    (tmp_path / "newer.json").write_text(newer, encoding="utf-8")
    (tmp_path / "infeasible.json").write_text(plan_text(NO_PLAN), encoding="utf-8")
    return tmp_path


def test_every_refused_command_prints_the_line_of_the_list(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = sorted(folder.rglob("*"))
    printed = [refusal(capsys, *shlex.split(command)) for command, _ in REFUSED]
    assert printed == [f"maneuver: {line}\n" for _, line in REFUSED]
    assert sorted(folder.rglob("*")) == files


@pytest.mark.parametrize("text", ALL)
def test_a_message_is_one_plain_line(text: str) -> None:
    assert "\n" not in text
    assert not DIALECT_IN_HELP.search(text)
    assert not text.endswith(".")
