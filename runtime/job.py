"""Work whose result is a file: what is there of it, and what doing it gives."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from flight.errors import FlightError

Result = TypeVar("Result")


class CodeMismatchError(FlightError):
    """A process was to work that has other code than the one that asked."""

    def __init__(self, expected: str, here: str) -> None:
        super().__init__(
            f"expected every worker to have code {expected}, one has {here}; "
            "install the same version there, with the same packages, and do not change it meanwhile"
        )


class JobState(StrEnum):
    """What there is of a piece of work."""

    WHOLE = "whole"
    MISSING = "missing"
    DAMAGED = "damaged"
    ANOTHER = "of something else"


@dataclass(frozen=True, slots=True)
class JobStatus(Generic[Result]):
    """A piece of work as its file shows it.

    Attributes:
        state: of the file.
        result: what the work came to; None unless whole.
        reason: what is wrong with the file, in words.
    """

    state: JobState
    result: Result | None = None
    reason: str = ""


@dataclass(frozen=True, slots=True)
class JobResult(Generic[Result]):
    """A piece of work, done.

    Attributes:
        files: where each goes and its content; once the last is there, the work is kept.
        result: what the work came to.
    """

    files: tuple[tuple[Path, bytes], ...]
    result: Result


class Job(Protocol[Result]):
    """A piece of work that any process with the same code does to the same bytes."""

    @property
    def path(self) -> Path:
        """The file that says that it is done, and what it came to."""

    def status(self) -> JobStatus[Result]:
        """Looks at the file; nothing but its content says whether it is whole and of this work."""

    def run(self) -> JobResult[Result]:
        """Does the work, and writes nothing.

        Raises:
            OtherCodeError: this process has other code than the one that asked.
        """


def check_code_version(expected: str, here: str) -> None:
    """Refuses to work where the code is not the one that is wanted.

    Raises:
        OtherCodeError: it is another.
    """
    if here != expected:
        raise CodeMismatchError(expected, here)
