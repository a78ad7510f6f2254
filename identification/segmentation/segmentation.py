"""Cutting a flight log into primitives: maneuvers from command change to settling, coasts between."""

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
from flightlog.topic import Series


@dataclass(frozen=True, slots=True)
class ManeuverSegment:
    """A maneuver as it truly happened.

    Attributes:
        id: of the maneuver.
        start: time of the change of trim, seconds.
        duration: seconds to the end of the dwell; to the next command or time-out where it did not settle.
        displacement: forward, to the right, heading change, in the body frame at entry.
        settled: whether it ended by the rule.
    """

    id: int
    start: float
    duration: float
    displacement: SE2
    settled: bool


@dataclass(frozen=True, slots=True, eq=False)
class CoastSegment:
    """A trim as it was truly held.

    Attributes:
        trim: id of the trim.
        start: seconds.
        duration: seconds.
        velocity: forward and side in metres per second, yaw rate in radians per second, at every sample.
    """

    trim: int
    start: float
    duration: float
    velocity: Float[np.ndarray, "n 3"]


@dataclass(frozen=True, slots=True)
class Segments:
    """All primitives of one flight, in the order flown."""

    maneuvers: tuple[ManeuverSegment, ...]
    coasts: tuple[CoastSegment, ...]


@dataclass(frozen=True, slots=True)
class TrimEntry:
    """A change of trim: seconds, ids of the trims left and led to."""

    time: float
    from_trim: int
    to_trim: int


@dataclass(frozen=True, slots=True)
class ObservedWalk:
    """The trims of a flight.

    Attributes:
        first: id of the trim held at the start; None where the flight begins in a maneuver.
        entries: the changes of trim, in their order.
    """

    first: int | None
    entries: tuple[TrimEntry, ...]


def segment(log: FlightLog) -> Segments:
    """Cuts a log into primitives by its command channel, judging the motion (thesis, 3.2.2).

    Raises:
        FlightError: the log lacks a topic or the rule.
    """
    return cut_into_segments(log, commanded_walk(log), log.library())


def commanded_walk(log: FlightLog) -> ObservedWalk:
    """Returns the changes of trim that were commanded.

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
    """Cuts a log into primitives where the trim changes.

    A maneuver ends by the rule of `flight.automaton.maneuver_end`, applied to the true body velocity, or to
    the
    believed one in a log that knows no truth. Where no positions are known, displacements are the way that
    the velocities make. A coast begins at the end of a maneuver and lasts to the next
    change. What follows a maneuver that did not settle is no coast: the vehicle was never seen in that trim.

    Args:
        log: the motion.
        walk: where the trim changes.
        library: names the maneuvers, and says when one has ended.

    Raises:
        FlightError: the log has no motion, or the library no rule or no such maneuver.
    """
    rule = library.conditions.maneuver_end
    if rule is None:
        raise FlightError(
            "the log's library has no conditions.maneuver_end: nothing says when a maneuver ends"
        )
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
    judge = ManeuverEndDetector(rule, to_trim=entry.to_trim, target=target, entry_time=entry.time)
    first, last = _row_range(motion, entry.time, until)
    velocity = _velocity(motion, first, last).tolist()
    end, verdict = last - 1, ManeuverStatus.UNDER_WAY
    for place, (time, sample) in enumerate(zip(motion.time[first:last].tolist(), velocity, strict=True)):
        verdict = judge.update(time, Twist(*sample))
        if verdict is not ManeuverStatus.UNDER_WAY:
            end = first + place
            break
    return ManeuverSegment(
        id=library.maneuver(entry.from_trim, entry.to_trim).id,
        start=entry.time,
        duration=float(motion.time[end]) - entry.time,
        displacement=_pose(motion, first).inverse() @ _pose(motion, end),
        settled=verdict is ManeuverStatus.ENDED,
    )


def _coast_segments(motion: Series, trim: int, begin: float, until: float) -> list[CoastSegment]:
    """Returns the coast, or none where it is over before a second sample."""
    first, last = _row_range(motion, begin, until)
    if last - first < 2:
        return []
    return [CoastSegment(trim, begin, until - begin, _velocity(motion, first, last))]


def _row_range(motion: Series, start: float, end: float) -> tuple[int, int]:
    """Returns the rows from a time to another, both included, within half a microsecond."""
    return (
        int(np.searchsorted(motion.time, start - 5e-7)),
        int(np.searchsorted(motion.time, end + 5e-7)),
    )


def _velocity(motion: Series, first: int, last: int) -> Float[np.ndarray, "n 3"]:
    columns = [motion[name][first:last] for name in ("forward", "side", "yaw_rate")]
    return np.stack(columns, axis=1)


def _pose(motion: Series, row: int) -> SE2:
    return SE2(float(motion["north"][row]), float(motion["east"][row]), float(motion["heading"][row]))
