"""Attribution of exceeded errors to primitives."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy.stats import binom

from flight.automaton.library import Library
from flightlog.log import FlightLog
from flightlog.topics import PRIMITIVE
from identification.segmentation.segmentation import (
    CoastSegment,
    ManeuverSegment,
    SegmentEnd,
    entry_bounds,
    segment,
)
from identification.statistics.samples import MANEUVER_SCALARS, maneuver_row


@dataclass(frozen=True, slots=True)
class Performance:
    """Largest deviation of one flown primitive, relative to its errors.

    Attributes:
        kind: `trim` or `maneuver`.
        id: id of the trim or maneuver.
        time: time of the largest deviation, seconds since the flight's start; a maneuver's end.
        scalar: name of the number with the largest deviation.
        share: deviation over the library's error; above 1, the error was exceeded.
    """

    kind: str
    id: int
    time: float
    scalar: str
    share: float


def performances(log: FlightLog) -> tuple[Performance, ...]:
    """Returns the true deviations of a flight's primitives.

    A maneuver that was cut before its end has none.
    Numbers without an error in the library are left out; a flight without a plan has no primitives. Where the
    library claims bounds for a maneuver's entry, the deviation is from the mean for that entry.

    Raises:
        FlightError: the log lacks a topic, the library or its maneuver-end rule.
    """
    if PRIMITIVE.name not in log.series:
        return ()
    library, cut = log.library(), segment(log)
    whole = [part for part in cut.maneuvers if part.end is not SegmentEnd.CUT]
    flown = [_of_maneuver(part, library) for part in whole]
    flown += [_of_coast(part, library) for part in cut.coasts]
    return tuple(sorted((one for one in flown if one is not None), key=lambda one: one.time))


def _of_maneuver(part: ManeuverSegment, library: Library) -> Performance | None:
    known = next(maneuver for maneuver in library.maneuvers if maneuver.id == part.id)
    bounds = entry_bounds(library, known, part)
    rows = zip(MANEUVER_SCALARS, maneuver_row(part), bounds.centre, bounds.size, strict=True)
    shares = {scalar: _share(value - centre, size) for scalar, value, centre, size in rows}
    return _worst_performance(
        "maneuver", part.id, {scalar: (share, part.start + part.duration) for scalar, share in shares.items()}
    )


def _of_coast(part: CoastSegment, library: Library) -> Performance | None:
    trim = library.trim(part.trim)
    times = np.linspace(part.start, part.start + part.duration, len(part.velocity))
    shares = {}
    for place, scalar in enumerate(("forward", "side", "yaw_rate")):
        deviation = np.abs(part.velocity[:, place] - getattr(trim.velocity, scalar))
        row = int(deviation.argmax())
        shares[scalar] = (_share(float(deviation[row]), getattr(trim.error, scalar)), float(times[row]))
    return _worst_performance("trim", part.trim, shares)


def _share(deviation: float, error: float) -> float | None:
    return abs(deviation) / abs(error) if error else None


def _worst_performance(
    kind: str, number: int, shares: dict[str, tuple[float | None, float]]
) -> Performance | None:
    known = [(share, scalar, time) for scalar, (share, time) in shares.items() if share is not None]
    if not known:
        return None
    share, scalar, time = max(known)
    return Performance(kind, number, round(time, 3), scalar, round(share, 4))


@dataclass(frozen=True, slots=True)
class ErrorAttribution:
    """Deviations of one primitive over many flights.

    A flight is one sample, as in identification.

    Attributes:
        kind: `trim` or `maneuver`.
        id: id of the trim or maneuver.
        flights: flights with the primitive.
        performances: number of times it was flown.
        outside: flights in which an error was exceeded.
        claimed: the library's coverage; None without a claim.
        p_value: probability of at least this many flights outside if the claim is true; None without a claim.
        worst: performance with the largest deviation.
        flight: name of the flight with the worst performance.
    """

    kind: str
    id: int
    flights: int
    performances: int
    outside: int
    claimed: float | None
    p_value: float | None
    worst: Performance
    flight: str


def attribute_errors(
    flights: Iterable[tuple[str, Iterable[Performance]]], library: Library
) -> tuple[ErrorAttribution, ...]:
    """Returns the deviations of each flown primitive, trims first, by id.

    Args:
        flights: name and performances of each flight.
        library: library flown with, with its coverage.
    """
    seen: dict[tuple[str, int], dict[str, list[Performance]]] = {}
    for name, flown in flights:
        for one in flown:
            seen.setdefault((one.kind, one.id), {}).setdefault(name, []).append(one)
    order = sorted(seen, key=lambda key: (key[0] == "maneuver", key[1]))
    return tuple(_attribute(kind, number, seen[kind, number], library) for kind, number in order)


def _attribute(
    kind: str, number: int, flown: dict[str, list[Performance]], library: Library
) -> ErrorAttribution:
    claimed = _claim(kind, number, library)
    worst = {name: max(parts, key=lambda one: one.share) for name, parts in flown.items()}
    outside = sum(one.share > 1 for one in worst.values())
    furthest = max(worst, key=lambda name: worst[name].share)
    return ErrorAttribution(
        kind=kind,
        id=number,
        flights=len(flown),
        performances=sum(len(parts) for parts in flown.values()),
        outside=outside,
        claimed=claimed,
        p_value=None if claimed is None else float(binom.sf(outside - 1, len(flown), 1 - claimed)),
        worst=worst[furthest],
        flight=furthest,
    )


def _claim(kind: str, number: int, library: Library) -> float | None:
    """Returns the coverage of the bounds that deviations are compared with."""
    if kind == "trim":
        statistics = library.trim(number).statistics
        return None if statistics is None else statistics.coverage
    maneuver = next(one for one in library.maneuvers if one.id == number)
    return maneuver.bounds_after(None, 0.0, (0.0, 0.0, 0.0)).coverage
