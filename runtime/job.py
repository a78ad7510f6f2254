"""Jobs whose result is a file, and their status."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Generic, Protocol, TypeVar

from flight.errors import FlightError

Result = TypeVar("Result")


class CodeMismatchError(FlightError):
    """Difference of code version between a worker and the requesting process."""

    def __init__(self, expected: str, here: str) -> None:
        super().__init__(
            f"expected code {expected} on every worker, got {here}; install the same version and packages "
            "there, and do not change them during the run"
        )


class JobState(StrEnum):
    """State of a job's file."""

    WHOLE = "whole"
    MISSING = "missing"
    DAMAGED = "damaged"
    ANOTHER = "of something else"


@dataclass(frozen=True, slots=True)
class JobStatus(Generic[Result]):
    """Status of a job as its file shows it.

    Attributes:
        state: state of the file.
        result: result of the job; None unless the file is whole.
        reason: defect of the file in words.
    """

    state: JobState
    result: Result | None = None
    reason: str = ""


@dataclass(frozen=True, slots=True)
class JobResult(Generic[Result]):
    """Files and result of a finished job.

    Attributes:
        files: path and content of each file; the last one marks the job as done.
        result: result of the job.
    """

    files: tuple[tuple[Path, bytes], ...]
    result: Result


class Job(Protocol[Result]):
    """Job that gives the same bytes in any process of one code."""

    @property
    def path(self) -> Path:
        """File that marks the job as done and holds its result."""

    def status(self) -> JobStatus[Result]:
        """Returns the status, from the file's content alone."""

    def run(self) -> JobResult[Result]:
        """Runs the job without writing.

        Raises:
            CodeMismatchError: this process has another code version than requested.
        """


def check_code_version(expected: str, here: str) -> None:
    """Refuses to run with another code version than expected.

    Raises:
        CodeMismatchError: the versions differ.
    """
    if here != expected:
        raise CodeMismatchError(expected, here)
