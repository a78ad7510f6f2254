"""A refused command, as a user sees it."""

import pytest

from maneuver.app import run


def refusal(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Returns the one line that a refused command prints."""
    try:
        code: object = run(arguments)
    except SystemExit as stop:  # raised by the parser of the command line
        code = stop.code
    printed = capsys.readouterr()
    assert code == 2, printed
    assert printed.out == ""
    assert printed.err.count("\n") == 1, printed.err
    assert printed.err.startswith("maneuver: ")
    return printed.err
