"""Where a flight left the bounds of the library that it was flown with."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.automaton.library_file import library_text, parse_library
from flight.errors import FlightError
from flight.se2 import SE2, Twist
from flightlog.attachment_names import LIBRARY_ATTACHMENT
from flightlog.channels import TRUTH
from flightlog.log import FlightLog
from flightlog.primitives import FlownPrimitive, PrimitiveKind, merged_primitives

from .tracking import VELOCITIES

BOUNDS_ATTACHMENT = "judge.json"
"""Name under which a log in memory carries a library of one's choice; no log on disk has it."""

IDENTIFICATION_KINDS = ("campaign", "nominal")
"""Kinds of flights that bounds are identified from."""

TRIM_TOLERANCE = 1e-6
"""Metres a second and radians a second by which equal trims may differ."""

# Bounds of a library are observed extremes; rounding in their sums is not a departure.
ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class BoundDeviation:
    """What came nearest to its bound in one primitive, or left it by the most.

    Attributes:
        kind: coast or maneuver.
        id: id of the trim or maneuver.
        start: seconds since the flight's start.
        number: what left its bound, such as `side` or `duration`.
        deviation: from the nominal value, in the number's unit.
        bound: the library's error, absolute.
    """

    kind: PrimitiveKind
    id: int
    start: float
    number: str
    deviation: float
    bound: float

    @property
    def exceeds_bound(self) -> bool:
        """Whether it left its bound."""
        return abs(self.deviation) > self.bound + ROUNDING

    @property
    def share(self) -> float:
        """The deviation as a share of the bound, >= 0; above 1 it left it."""
        return abs(self.deviation) / max(self.bound, ROUNDING)


@dataclass(frozen=True, slots=True)
class BoundCheck:
    """How the primitives of a flight kept to the library's errors.

    Attributes:
        library: name of the library whose errors these are.
        trim_error_kind: how trim errors are meant, and therefore judged: each instant, or a coast's average.
        coasts: how many were judged.
        maneuvers: how many were judged: flown to their end, and in the library.
        departures: those that left their bounds, in the order flown.
    """

    library: str
    trim_error_kind: str
    coasts: int
    maneuvers: int
    departures: tuple[BoundDeviation, ...]

    def count_violations(self, kind: PrimitiveKind) -> int:
        """Returns how many primitives of a kind left their bounds."""
        return sum(violation.kind is kind for violation in self.departures)


def with_bounds_of(log: FlightLog, library: Library) -> FlightLog:
    """Returns a log that is judged by a library of one's choice, to be looked at and not to be written.

    Raises:
        FlightError: the library does not have what was flown.
    """
    for part in merged_primitives(log):
        if part.kind is PrimitiveKind.MANEUVER:
            library.maneuver(part.from_trim, part.to_trim)
        velocity = library.trim(part.to_trim).velocity
        if not np.allclose(_numbers(velocity), _numbers(part.target), rtol=0.0, atol=TRIM_TOLERANCE):
            raise FlightError(
                f"trim {part.to_trim} of library {library.name} is {_words(velocity)}, "
                f"the flight held {_words(part.target)}: another automaton"
            )
    return replace(log, attachments={**log.attachments, BOUNDS_ATTACHMENT: library_text(library).encode()})


def bounding_library(log: FlightLog) -> Library | None:
    """Returns the library whose errors are a flight's bounds; None where none applies.

    That is the one of one's choice, or the one flown with. A campaign is flown to find bounds: those in the
    library that names its trims are not its own.

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
    """Holds the true motion against the errors of the library that judges; None where none applies.

    Raises:
        FlightError: the library is broken, or the log lacks truth.
    """
    library = bounding_library(log)
    if library is None:
        return None
    judged = compute_deviations(log, library)
    return BoundCheck(
        library=library.name,
        trim_error_kind=library.conditions.trim_error_kind,
        coasts=sum(one.kind is PrimitiveKind.COAST for one in judged),
        maneuvers=sum(one.kind is PrimitiveKind.MANEUVER for one in judged),
        departures=tuple(one for one in judged if one.exceeds_bound),
    )


def compute_deviations(log: FlightLog, library: Library) -> tuple[BoundDeviation, ...]:
    """Returns one for each primitive that can be judged, in the order flown.

    Raises:
        FlightError: the log lacks truth, or flew what the library does not have.
    """
    flown = merged_primitives(log)
    judged = []
    for place, part in enumerate(flown):
        if part.kind is PrimitiveKind.COAST:
            velocity = _velocities(log, part)
            # A log that was recovered may have lost what was true in a coast.
            if len(velocity):
                judged.append(_coast_deviation(velocity, library, part))
        # The last primitive was ended by the end of the log; that is no end of a maneuver.
        elif place < len(flown) - 1:
            judged.append(_maneuver_deviation(log, library, part))
    return tuple(judged)


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
    apart = velocity - nominal
    largest = apart[np.argmax(np.abs(apart), axis=0), np.arange(len(VELOCITIES))]
    bounds = [abs(getattr(trim.error, field)) for field in VELOCITIES]
    return _largest_deviation(part, VELOCITIES, largest.tolist(), bounds)


def _maneuver_deviation(log: FlightLog, library: Library, part: FlownPrimitive) -> BoundDeviation:
    maneuver = library.maneuver(part.from_trim, part.to_trim)
    displacement = pose_at(log, part.start).inverse() @ pose_at(log, part.end)
    nominal, error = maneuver.displacement, maneuver.error
    apart = [
        part.end - part.start - maneuver.duration,
        displacement.x - nominal.x,
        displacement.y - nominal.y,
        displacement.heading - nominal.heading,
    ]
    bounds = [abs(error.duration), abs(error.forward), abs(error.side), abs(error.heading_change)]
    return _largest_deviation(part, ("duration", "forward", "side", "heading change"), apart, bounds)


def pose_at(log: FlightLog, time: float) -> SE2:
    """Returns the pose at a time, between samples by straight lines: the true one where it is known.

    Raises:
        FlightError: the log lacks motion, or positions in it.
    """
    motion = log.motion
    north, east = (float(np.interp(time, motion.time, motion[name])) for name in ("north", "east"))
    heading = float(np.interp(time, motion.time, motion["heading"])) if motion.has_fields("heading") else 0.0
    return SE2(north, east, heading)


def _largest_deviation(
    part: FlownPrimitive, names: tuple[str, ...], apart: list[float], bounds: list[float]
) -> BoundDeviation:
    """Returns the number that deviates by the largest share of its bound."""
    all_of_it = [
        BoundDeviation(part.kind, part.id, part.start, *one) for one in zip(names, apart, bounds, strict=True)
    ]
    return max(all_of_it, key=lambda one: one.share)
