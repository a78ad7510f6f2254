"""Where a flight left the bounds of the library that it was flown with."""

from dataclasses import dataclass

import numpy as np

from flight.library import Library
from flight.log import LIBRARY_ATTACHMENT, TRUTH, FlightLog, PrimitiveFlown, PrimitiveKind
from flight.se2 import SE2
from flight.stretches import stretches_flown

from .tracking import VELOCITIES

# Bounds of a library are observed extremes; rounding in their sums is not a departure.
ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class Departure:
    """The worst excess of one primitive over its bound.

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


@dataclass(frozen=True, slots=True)
class Bounds:
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
    departures: tuple[Departure, ...]

    def left_by(self, kind: PrimitiveKind) -> int:
        """Returns how many primitives of a kind left their bounds."""
        return sum(departure.kind is kind for departure in self.departures)


def bounds_kept(log: FlightLog) -> Bounds | None:
    """Holds the true motion against the attached library's errors; None where no library is attached.

    Raises:
        FlightError: the attached library is broken, or the log lacks truth or primitives.
    """
    if LIBRARY_ATTACHMENT not in log.attachments:
        return None
    library = log.library()
    flown = stretches_flown(log)
    coasts = [part for part in flown if part.kind is PrimitiveKind.COAST]
    # The last primitive was ended by the end of the log; that is no end of a maneuver.
    maneuvers = [part for part in flown[:-1] if part.kind is PrimitiveKind.MANEUVER]
    found = [_coast_departure(log, library, part) for part in coasts]
    found += [_maneuver_departure(log, library, part) for part in maneuvers]
    return Bounds(
        library=library.name,
        trim_error_kind=library.conditions.trim_error_kind,
        coasts=len(coasts),
        maneuvers=len(maneuvers),
        departures=tuple(sorted((d for d in found if d is not None), key=lambda d: d.start)),
    )


def _coast_departure(log: FlightLog, library: Library, part: PrimitiveFlown) -> Departure | None:
    trim, truth = library.trim(part.id), log[TRUTH]
    rows = slice(*np.searchsorted(truth.time, [part.start - ROUNDING, part.end + ROUNDING]))
    velocity = np.column_stack([truth[field][rows] for field in VELOCITIES])
    if library.conditions.trim_error_kind == "averaged":
        velocity = velocity.mean(axis=0, keepdims=True)
    nominal = np.array([getattr(trim.velocity, field) for field in VELOCITIES])
    deviations = velocity - nominal
    largest = deviations[np.argmax(np.abs(deviations), axis=0), np.arange(len(VELOCITIES))]
    bounds = [abs(getattr(trim.error, field)) for field in VELOCITIES]
    return _worst(part, VELOCITIES, largest.tolist(), bounds)


def _maneuver_departure(log: FlightLog, library: Library, part: PrimitiveFlown) -> Departure | None:
    maneuver = library.maneuver(part.from_trim, part.to_trim)
    displacement = pose_at(log, part.start).inverse() @ pose_at(log, part.end)
    nominal, error = maneuver.displacement, maneuver.error
    deviations = [
        part.end - part.start - maneuver.duration,
        displacement.x - nominal.x,
        displacement.y - nominal.y,
        displacement.heading - nominal.heading,
    ]
    bounds = [abs(error.duration), abs(error.forward), abs(error.side), abs(error.heading_change)]
    return _worst(part, ("duration", "forward", "side", "heading change"), deviations, bounds)


def pose_at(log: FlightLog, time: float) -> SE2:
    """Returns the true pose at a time, between samples by straight lines."""
    truth = log[TRUTH]
    x, y, heading = (float(np.interp(time, truth.time, truth[name])) for name in ("north", "east", "heading"))
    return SE2(x, y, heading)


def _worst(
    part: PrimitiveFlown, names: tuple[str, ...], deviations: list[float], bounds: list[float]
) -> Departure | None:
    """Returns the number that left its bound by the largest part of the bound, or None."""
    excess = [
        abs(deviation) / max(bound, ROUNDING) for deviation, bound in zip(deviations, bounds, strict=True)
    ]
    worst = int(np.argmax(excess))
    if abs(deviations[worst]) <= bounds[worst] + ROUNDING:
        return None
    return Departure(part.kind, part.id, part.start, names[worst], deviations[worst], bounds[worst])
