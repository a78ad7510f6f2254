"""Segmentation of a flight log: maneuvers to settling, coasts between."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.automaton.maneuver_end import ManeuverEnd, ManeuverEndDetector, ManeuverStatus
from flight.errors import FlightError
from flight.se2 import SE2, Twist
from flightlog.dead_reckoning import with_dead_reckoning
from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveKind, flown_primitives
from flightlog.series import Series


@dataclass(frozen=True, slots=True)
class ManeuverSegment:
    """A maneuver as flown.

    Attributes:
        id: id of the maneuver.
        start: time of the change of trim, seconds.
        duration: seconds to the end of the dwell; to the next command or time-out where it did not settle.
        displacement: forward, to the right, heading change, in the body frame at entry.
        settled: True if it ended by the rule.
    """

    id: int
    start: float
    duration: float
    displacement: SE2
    settled: bool


@dataclass(frozen=True, slots=True, eq=False)
class CoastSegment:
    """A coast as flown.

    Attributes:
        trim: id of the trim.
        start: seconds.
        duration: seconds.
        velocity: forward and side in m/s, yaw rate in rad/s, at every sample.
    """

    trim: int
    start: float
    duration: float
    velocity: Float[np.ndarray, "n 3"]


@dataclass(frozen=True, slots=True)
class Segments:
    """Primitives of one flight, in the order flown."""

    maneuvers: tuple[ManeuverSegment, ...]
    coasts: tuple[CoastSegment, ...]


@dataclass(frozen=True, slots=True)
class TrimEntry:
    """A change of trim: seconds, ids of the trims left and reached."""

    time: float
    from_trim: int
    to_trim: int


@dataclass(frozen=True, slots=True)
class ObservedWalk:
    """The sequence of trims of a flight.

    Attributes:
        first: id of the trim at the start; None where the flight begins in a maneuver.
        entries: the changes of trim in order.
    """

    first: int | None
    entries: tuple[TrimEntry, ...]


def segment(log: FlightLog) -> Segments:
    """Segments a log by its commands (thesis, 3.2.2).

    Raises:
        FlightError: the log lacks a topic or the rule.
    """
    return cut_into_segments(log, commanded_walk(log), log.library())


def commanded_walk(log: FlightLog) -> ObservedWalk:
    """Returns the commanded changes of trim.

    Raises:
        MissingTopicError: the log has no `/primitive`.
    """
    primitives = flown_primitives(log)
    entries = tuple(
        TrimEntry(primitive.start, primitive.from_trim, primitive.to_trim)
        for primitive in primitives
        if primitive.kind is PrimitiveKind.MANEUVER
    )
    held = bool(primitives) and primitives[0].kind is PrimitiveKind.COAST
    return ObservedWalk(primitives[0].to_trim if held else None, entries)


def cut_into_segments(log: FlightLog, walk: ObservedWalk, library: Library) -> Segments:
    """Segments a log at given changes of trim.

    A maneuver ends by the rule of `flight.automaton.maneuver_end`, applied to the true body velocity, or to
    the estimated one in a log without truth. Without positions, displacements are integrated from velocities.
    A coast begins at the end of a maneuver and lasts to the next change. After a maneuver that did not settle
    there is no coast, because the vehicle was not observed in that trim.

    Args:
        log: log with the motion.
        walk: changes of trim.
        library: maneuvers and maneuver-end rule.

    Raises:
        FlightError: the log has no motion, or the library lacks the rule or a maneuver.
    """
    rule = library.conditions.maneuver_end
    if rule is None:
        raise FlightError("expected conditions.maneuver_end in the log's library, got none")
    motion = with_dead_reckoning(log.motion)
    maneuvers: list[ManeuverSegment] = []
    coasts: list[CoastSegment] = []
    changes = [*(entry.time for entry in walk.entries), log.duration]
    if walk.first is not None:
        coasts += _coast_segments(motion, walk.first, float(motion.time[0]), changes[0])
    for entry, until in zip(walk.entries, changes[1:], strict=True):
        maneuver = _maneuver_segment(motion, rule, library, entry, until)
        maneuvers.append(maneuver)
        if maneuver.settled:
            coasts += _coast_segments(motion, entry.to_trim, maneuver.start + maneuver.duration, until)
    return Segments(tuple(maneuvers), tuple(coasts))


def _maneuver_segment(
    motion: Series, rule: ManeuverEnd, library: Library, entry: TrimEntry, until: float
) -> ManeuverSegment:
    target = library.trim(entry.to_trim).velocity
    detector = ManeuverEndDetector(rule, to_trim=entry.to_trim, target=target, entry_time=entry.time)
    first, last = _row_range(motion, entry.time, until)
    velocity = _velocity(motion, first, last).tolist()
    end, status = last - 1, ManeuverStatus.UNDER_WAY
    for place, (time, sample) in enumerate(zip(motion.time[first:last].tolist(), velocity, strict=True)):
        status = detector.update(time, Twist(*sample))
        if status is not ManeuverStatus.UNDER_WAY:
            end = first + place
            break
    return ManeuverSegment(
        id=library.maneuver(entry.from_trim, entry.to_trim).id,
        start=entry.time,
        duration=float(motion.time[end]) - entry.time,
        displacement=_pose(motion, first).inverse() @ _pose(motion, end),
        settled=status is ManeuverStatus.ENDED,
    )


def _coast_segments(motion: Series, trim: int, begin: float, until: float) -> list[CoastSegment]:
    """Returns the coast, or none with fewer than two samples."""
    first, last = _row_range(motion, begin, until)
    if last - first < 2:
        return []
    return [CoastSegment(trim, begin, until - begin, _velocity(motion, first, last))]


def _row_range(motion: Series, start: float, end: float) -> tuple[int, int]:
    """Returns the row range between two times, inclusive to 0.5 µs."""
    return (
        int(np.searchsorted(motion.time, start - 5e-7)),
        int(np.searchsorted(motion.time, end + 5e-7)),
    )


def _velocity(motion: Series, first: int, last: int) -> Float[np.ndarray, "n 3"]:
    columns = [motion[name][first:last] for name in ("forward", "side", "yaw_rate")]
    return np.stack(columns, axis=1)


def _pose(motion: Series, row: int) -> SE2:
    return SE2(float(motion["north"][row]), float(motion["east"][row]), float(motion["heading"][row]))
