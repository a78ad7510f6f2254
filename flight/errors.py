"""Errors that callers may handle, each a one-line sentence."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from jaxtyping import Float


class FlightError(Exception):
    """Base class of all errors raised on purpose; one line of text."""

    def __reduce__(self) -> tuple[object, ...]:
        """Pickles an error by its text; subclasses build that from own arguments."""
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
    """Invalid file: its name, the place in it, the value expected there."""

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
    """Library to be flown without a maneuver-end rule."""

    def __init__(self, library: str) -> None:
        super().__init__(
            f"library {library!r}: expected conditions.maneuver_end (a band for each trim, dwell, timeout) "
            "for a flight, got none"
        )
