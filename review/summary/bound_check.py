"""Check of a flight against a library's error bounds."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.automaton.library_file import library_text, parse_library
from flight.errors import FlightError
from flight.se2 import SE2, Twist
from flightlog.attachment_names import LIBRARY_ATTACHMENT
from flightlog.log import FlightLog
from flightlog.primitives import FlownPrimitive, PrimitiveKind, merged_primitives
from flightlog.topics import TRUTH

from .tracking import VELOCITIES

BOUNDS_ATTACHMENT = "judge.json"
"""Attachment with a chosen library of bounds; only logs in memory have it."""

IDENTIFICATION_KINDS = ("campaign", "nominal")
"""Kinds of flights from which bounds are identified."""

TRIM_TOLERANCE = 1e-6
"""Tolerance for equal trims, m/s and rad/s."""

# Bounds of a library are observed extremes; rounding in their sums is not a violation.
ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class BoundDeviation:
    """Largest deviation of one primitive relative to its bound.

    Attributes:
        kind: coast or maneuver.
        id: id of the trim or maneuver.
        start: seconds since the flight's start.
        number: name of the value, such as `side` or `duration`.
        deviation: deviation from the nominal value, in the value's unit.
        bound: absolute error in the library.
    """

    kind: PrimitiveKind
    id: int
    start: float
    number: str
    deviation: float
    bound: float

    @property
    def exceeds_bound(self) -> bool:
        """True if the deviation exceeds its bound."""
        return abs(self.deviation) > self.bound + ROUNDING

    @property
    def share(self) -> float:
        """Deviation over bound, >= 0; above 1 it exceeds the bound."""
        return abs(self.deviation) / max(self.bound, ROUNDING)


@dataclass(frozen=True, slots=True)
class BoundCheck:
    """Result of checking a flight's primitives against a library's errors.

    Attributes:
        library: name of the library.
        trim_error_kind: definition of trim errors: of each instant, or of a coast's average.
        coasts: number of coasts checked.
        maneuvers: number of maneuvers checked: flown to their end, and in the library.
        violations: primitives that left their bounds, in the order flown.
    """

    library: str
    trim_error_kind: str
    coasts: int
    maneuvers: int
    violations: tuple[BoundDeviation, ...]

    def count_violations(self, kind: PrimitiveKind) -> int:
        """Returns the number of primitives of a kind that left their bounds."""
        return sum(violation.kind is kind for violation in self.violations)


def with_bounds_of(log: FlightLog, library: Library) -> FlightLog:
    """Returns the log with a chosen library of bounds, for review only.

    Raises:
        FlightError: the library lacks a primitive flown, or has it with another velocity.
    """
    for part in merged_primitives(log):
        if part.kind is PrimitiveKind.MANEUVER:
            library.maneuver(part.from_trim, part.to_trim)
        velocity = library.trim(part.to_trim).velocity
        if not np.allclose(_numbers(velocity), _numbers(part.target), rtol=0.0, atol=TRIM_TOLERANCE):
            raise FlightError(
                f"library {library.name} is of another automaton: expected trim {part.to_trim} at "
                f"{_words(part.target)}, got {_words(velocity)}"
            )
    return replace(log, attachments={**log.attachments, BOUNDS_ATTACHMENT: library_text(library).encode()})


def bounding_library(log: FlightLog) -> Library | None:
    """Returns the library whose errors bound a flight; None without one.

    The chosen library comes before the one flown with. A campaign serves to find bounds: the library that
    names its trims does not bound it.

    Raises:
        FlightError: the library is broken.
    """
    if BOUNDS_ATTACHMENT in log.attachments:
        return parse_library(log.attachments[BOUNDS_ATTACHMENT], BOUNDS_ATTACHMENT)
    if LIBRARY_ATTACHMENT not in log.attachments or log.header.kind in IDENTIFICATION_KINDS:
        return None
    return log.library()


def _numbers(velocity: Twist) -> tuple[float, float, float]:
    return velocity.forward, velocity.side, velocity.yaw_rate


def _words(velocity: Twist) -> str:
    return f"{velocity.forward:.3g} m/s forward, {velocity.side:.3g} m/s right, {velocity.yaw_rate:.3g} rad/s"


def check_bounds(log: FlightLog) -> BoundCheck | None:
    """Checks the true motion against the bounding library; None without one.

    Raises:
        FlightError: the library is broken, or the log lacks truth.
    """
    library = bounding_library(log)
    if library is None:
        return None
    deviations = compute_deviations(log, library)
    return BoundCheck(
        library=library.name,
        trim_error_kind=library.conditions.trim_error_kind,
        coasts=sum(deviation.kind is PrimitiveKind.COAST for deviation in deviations),
        maneuvers=sum(deviation.kind is PrimitiveKind.MANEUVER for deviation in deviations),
        violations=tuple(deviation for deviation in deviations if deviation.exceeds_bound),
    )


def compute_deviations(log: FlightLog, library: Library) -> tuple[BoundDeviation, ...]:
    """Returns the deviation of each checkable primitive, in the order flown.

    Raises:
        FlightError: the log lacks truth, or the library lacks a primitive flown.
    """
    flown = merged_primitives(log)
    deviations = []
    for place, part in enumerate(flown):
        if part.kind is PrimitiveKind.COAST:
            velocity = _velocities(log, part)
            # A recovered log may lack the true states of a coast.
            if len(velocity):
                deviations.append(_coast_deviation(velocity, library, part))
        # The log's end cuts the last primitive, so a last maneuver is incomplete.
        elif place < len(flown) - 1:
            deviations.append(_maneuver_deviation(log, library, part))
    return tuple(deviations)


def _velocities(log: FlightLog, part: FlownPrimitive) -> Float[np.ndarray, "n 3"]:
    truth = log[TRUTH]
    rows = slice(*np.searchsorted(truth.time, [part.start - ROUNDING, part.end + ROUNDING]))
    return np.column_stack([truth[field][rows] for field in VELOCITIES])


def _coast_deviation(
    velocity: Float[np.ndarray, "n 3"], library: Library, part: FlownPrimitive
) -> BoundDeviation:
    trim = library.trim(part.id)
    if library.conditions.trim_error_kind == "averaged":
        velocity = velocity.mean(axis=0, keepdims=True)
    nominal = np.array([getattr(trim.velocity, field) for field in VELOCITIES])
    off = velocity - nominal
    largest = off[np.argmax(np.abs(off), axis=0), np.arange(len(VELOCITIES))]
    bounds = [abs(getattr(trim.error, field)) for field in VELOCITIES]
    return _largest_deviation(part, VELOCITIES, largest.tolist(), bounds)


def _maneuver_deviation(log: FlightLog, library: Library, part: FlownPrimitive) -> BoundDeviation:
    maneuver = library.maneuver(part.from_trim, part.to_trim)
    displacement = pose_at(log, part.start).inverse() @ pose_at(log, part.end)
    nominal, error = maneuver.displacement, maneuver.error
    off = [
        part.end - part.start - maneuver.duration,
        displacement.x - nominal.x,
        displacement.y - nominal.y,
        displacement.heading - nominal.heading,
    ]
    bounds = [abs(error.duration), abs(error.forward), abs(error.side), abs(error.heading_change)]
    return _largest_deviation(part, ("duration", "forward", "side", "heading change"), off, bounds)


def pose_at(log: FlightLog, time: float) -> SE2:
    """Returns the interpolated pose at a time: true, or else estimated.

    Raises:
        FlightError: the log lacks motion, or positions in it.
    """
    motion = log.motion

    def known(name: str) -> float:
        rows = np.isfinite(motion[name])
        return float(np.interp(time, motion.time[rows], motion[name][rows])) if rows.any() else 0.0

    return SE2(known("north"), known("east"), known("heading") if motion.has_fields("heading") else 0.0)


def _largest_deviation(
    part: FlownPrimitive, names: tuple[str, ...], off: list[float], bounds: list[float]
) -> BoundDeviation:
    """Returns the deviation that is the largest share of its bound."""
    deviations = [
        BoundDeviation(part.kind, part.id, part.start, *row) for row in zip(names, off, bounds, strict=True)
    ]
    return max(deviations, key=lambda deviation: deviation.share)
