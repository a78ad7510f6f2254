"""Segmentation of a flight log: maneuvers to settling, coasts between."""

from dataclasses import dataclass
from enum import Enum

import numpy as np
from jaxtyping import Float

from flight.automaton.joint_law import PATH_INSTANTS, Row3
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverBounds
from flight.automaton.maneuver_end import ManeuverEnd, ManeuverEndDetector, ManeuverStatus
from flight.errors import FlightError
from flight.se2 import SE2, Twist
from flightlog.dead_reckoning import with_dead_reckoning
from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveKind, flown_primitives
from flightlog.series import Series
from flightlog.topics import ESTIMATE


class SegmentEnd(Enum):
    """End of a maneuver as flown."""

    SETTLED = "by the rule"
    CUT = "cut by the next command or the log's end"
    TIMED_OUT = "by time-out"


@dataclass(frozen=True, slots=True)
class ManeuverSegment:
    """A maneuver as flown, between the ends that the vehicle executed.

    Attributes:
        id: id of the maneuver.
        start: time of the change of trim, seconds.
        duration: seconds to its end: by the rule applied to the estimate, or at the next command.
        displacement: true forward, right, heading change, in the body frame at entry.
        end: kind of its end.
        believed: body velocity at entry as the vehicle believed it.
        previous: id of the maneuver before, where that settled; None for the first.
        coast: seconds since the end of that maneuver, or since the log's start.
        path: displacement at shares 0, 1/8 ... 1 of the duration.
    """

    id: int
    start: float
    duration: float
    displacement: SE2
    end: SegmentEnd
    believed: Twist
    previous: int | None = None
    coast: float = 0.0
    path: tuple[Row3, ...] = ()

    @property
    def settled(self) -> bool:
        """True if it ended by the rule."""
        return self.end is SegmentEnd.SETTLED


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
    """A change of trim: seconds, ids of the trims left and reached.

    Attributes:
        time: seconds.
        from_trim: id of the trim left.
        to_trim: id of the trim reached.
        until: time of the next command, a coast or a maneuver; None where no command was logged.
        timed_out: whether the vehicle logged a time-out.
    """

    time: float
    from_trim: int
    to_trim: int
    until: float | None = None
    timed_out: bool = False


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
        TrimEntry(primitive.start, primitive.from_trim, primitive.to_trim, primitive.end, primitive.timed_out)
        for primitive in primitives
        if primitive.kind is PrimitiveKind.MANEUVER
    )
    held = bool(primitives) and primitives[0].kind is PrimitiveKind.COAST
    return ObservedWalk(primitives[0].to_trim if held else None, entries)


def cut_into_segments(log: FlightLog, walk: ObservedWalk, library: Library) -> Segments:
    """Segments a log at given changes of trim.

    A maneuver ends where the vehicle ended it: at the next command, or by the rule of
    `flight.automaton.maneuver_end` applied to the estimate (to the motion in a log without one), whichever is
    first. With commands only a logged time-out is one; a maneuver that the next command or the log's end cut
    is neither settled nor timed out. Displacements are of the true motion; without positions they are
    integrated from velocities. A coast begins at the end of a settled maneuver and lasts to the next change.

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
    motion, believed = with_dead_reckoning(log.motion), estimated_motion(log)
    maneuvers: list[ManeuverSegment] = []
    coasts: list[CoastSegment] = []
    changes = [*(entry.time for entry in walk.entries), log.duration]
    if walk.first is not None:
        coasts += _coast_segments(motion, walk.first, float(motion.time[0]), changes[0])
    previous, free = None, float(motion.time[0])
    for entry, until in zip(walk.entries, changes[1:], strict=True):
        number = library.maneuver(entry.from_trim, entry.to_trim).id
        end, kind = _executed_end(believed, rule, library, entry, until)
        first, last = _row_at(motion, entry.time), max(_row_at(motion, end), _row_at(motion, entry.time))
        start, instant = _pose(motion, first), _velocity_at(believed, entry.time)
        maneuver = ManeuverSegment(
            id=number,
            start=entry.time,
            duration=float(motion.time[last]) - entry.time,
            displacement=start.inverse() @ _pose(motion, last),
            end=kind,
            believed=instant,
            previous=previous,
            coast=entry.time - free,
            path=_path(motion, first, last),
        )
        maneuvers.append(maneuver)
        previous, free = (number if maneuver.settled else None), maneuver.start + maneuver.duration
        if maneuver.settled:
            coasts += _coast_segments(motion, entry.to_trim, free, until)
    return Segments(tuple(maneuvers), tuple(coasts))


def entry_bounds(library: Library, maneuver: Maneuver, part: ManeuverSegment) -> ManeuverBounds:
    """Returns a maneuver's bounds for the entry of one performance."""
    believed, command = part.believed, library.trim(maneuver.from_trim).velocity
    offset = (
        believed.forward - command.forward,
        believed.side - command.side,
        believed.yaw_rate - command.yaw_rate,
    )
    return maneuver.bounds_after(part.previous, part.coast, offset)


def estimated_motion(log: FlightLog) -> Series:
    """Returns the motion that the vehicle applies the rule to."""
    return log[ESTIMATE] if ESTIMATE.name in log.series else log.motion


def _executed_end(
    believed: Series, rule: ManeuverEnd, library: Library, entry: TrimEntry, until: float
) -> tuple[float, SegmentEnd]:
    """Returns time and kind of a maneuver's end."""
    commanded = entry.until is not None
    limit = until if entry.until is None else entry.until
    if entry.timed_out:
        return limit, SegmentEnd.TIMED_OUT
    target = library.trim(entry.to_trim).velocity
    detector = ManeuverEndDetector(rule, to_trim=entry.to_trim, target=target, entry_time=entry.time)
    first, last = _row_range(believed, entry.time, limit)
    velocity = _velocity(believed, first, last).tolist()
    for time, sample in zip(believed.time[first:last].tolist(), velocity, strict=True):
        status = detector.update(time, Twist(*sample))
        if status is ManeuverStatus.ENDED:
            # A vehicle begins with the sample after the entry, so that its end may be a sample later.
            return (limit if commanded and limit - time < _SAMPLE else time), SegmentEnd.SETTLED
        if status is ManeuverStatus.TIMED_OUT and not commanded:
            return time, SegmentEnd.TIMED_OUT
    return limit, SegmentEnd.CUT


# Seconds: above the period of logged motion, below what a bound resolves.
_SAMPLE = 0.051


def _path(motion: Series, first: int, last: int) -> tuple[Row3, ...]:
    """Returns the displacements at evenly spaced shares of the duration."""
    time = motion.time[first : last + 1]
    shares = np.linspace(float(time[0]), float(time[-1]), PATH_INSTANTS)
    north, east, heading = (
        np.interp(shares, time, motion[name][first : last + 1]) - motion[name][first]
        for name in ("north", "east", "heading")
    )
    body = np.exp(-1j * motion["heading"][first]) * (north + 1j * east)
    rows = zip(body.real.tolist(), body.imag.tolist(), heading.tolist(), strict=True)
    return tuple(rows)


def _row_at(motion: Series, time: float) -> int:
    """Returns the first row not before a time, or the last."""
    return min(int(np.searchsorted(motion.time, time - 5e-7)), len(motion.time) - 1)


def _velocity_at(motion: Series, time: float) -> Twist:
    row = _row_at(motion, time)
    return Twist(*_velocity(motion, row, row + 1)[0].tolist())


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
