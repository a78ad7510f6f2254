"""Failures that a caller may handle, each a sentence: what was expected, what came, what exists."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from jaxtyping import Float


class FlightError(Exception):
    """Base of every failure that this program raises on purpose; its text is one line for the user."""

    def __reduce__(self) -> tuple[object, ...]:
        """Travels between processes by its text: subclasses build that from arguments of their own."""
        return _rebuild_error, (type(self), str(self))


def _rebuild_error(kind: type[FlightError], text: str) -> FlightError:
    error = kind.__new__(kind)
    Exception.__init__(error, text)
    return error


class UnknownTrimError(FlightError):
    """A trim was named that the library does not hold."""

    def __init__(self, trim: int, known: Iterable[int]) -> None:
        super().__init__(f"no trim {trim}; the library has {sorted(known)}")


class NoManeuverError(FlightError):
    """Two trims were joined that no maneuver of the library joins."""

    def __init__(self, from_trim: int, to_trim: int, successors: Iterable[int]) -> None:
        super().__init__(
            f"no maneuver from trim {from_trim} to trim {to_trim}; "
            f"from trim {from_trim} the library reaches {sorted(successors)}"
        )


class BadFileError(FlightError):
    """A file is not what it should be; names the file, the place in it and what was expected there."""

    def __init__(self, path: Path | str, problem: str) -> None:
        super().__init__(f"{path}: {problem}")


class AlreadyExistsError(FlightError):
    """A result would overwrite an existing file or folder."""

    def __init__(self, path: Path | str) -> None:
        super().__init__(f"{path} exists; give --force to overwrite it, or another name")


class CannotWriteError(FlightError):
    """A result could not be written; nothing half-written was left."""

    def __init__(self, path: Path | str, problem: str) -> None:
        super().__init__(f"{path}: cannot be written: {problem}")


class FlightLostError(FlightError):
    """A simulated flight diverged or met the ground.

    Attributes:
        track: true motion of the primitive in which it did, up to there, as in
        `flight.automaton.vehicle.Leg`; None
            where nobody kept it.
    """

    track: Float[np.ndarray, "n 4"] | None = None

    def __init__(self, time: float, problem: str) -> None:
        super().__init__(f"flight lost at {time:.2f} s: {problem}")


class NoManeuverEndError(FlightError):
    """A library was to be flown that does not say when a maneuver has ended."""

    def __init__(self, library: str) -> None:
        super().__init__(
            f"library {library!r} cannot be flown: its conditions have no maneuver_end "
            "(a band for each trim, dwell, timeout)"
        )
