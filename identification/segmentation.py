"""Cutting a flight log into primitives: maneuvers from command change to settling, coasts between."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError
from flight.log import TRUTH, FlightLog, PrimitiveFlown, PrimitiveKind, Series, primitives_flown
from flight.maneuver_end import ManeuverEnd, ManeuverEndJudge, Verdict
from flight.se2 import SE2, Twist


@dataclass(frozen=True, slots=True)
class ManeuverSegment:
    """A maneuver as it truly happened.

    Attributes:
        id: of the maneuver.
        start: time of the command change, seconds.
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


def segment(log: FlightLog) -> Segments:
    """Cuts a log into primitives, judging the true motion (thesis, 3.2.2).

    A maneuver is entered when the command changes and ends by the rule of `flight.maneuver_end`, applied to
    the true body velocity. A coast begins at the end of a maneuver and lasts to the next command change. What
    follows a maneuver that did not settle is no coast: the vehicle was never seen in that trim.

    Raises:
        FlightError: the log lacks a topic or the rule.
    """
    rule = log.library().conditions.maneuver_end
    if rule is None:
        raise FlightError(
            "the log's library has no conditions.maneuver_end: nothing says when a maneuver ends"
        )
    truth = log[TRUTH]
    maneuvers: list[ManeuverSegment] = []
    coasts: list[CoastSegment] = []
    for trim, entry, until in _held(log):
        begin = 0.0
        if entry is not None:
            maneuver = _maneuver_segment(truth, rule, entry, until)
            maneuvers.append(maneuver)
            begin = maneuver.start + maneuver.duration
            if not maneuver.settled:
                continue
        coast = _coast_segment(truth, trim, begin, until)
        if coast is not None:
            coasts.append(coast)
    return Segments(tuple(maneuvers), tuple(coasts))


def _held(log: FlightLog) -> Iterator[tuple[int, PrimitiveFlown | None, float]]:
    """Yields each trim led to, the maneuver that led to it (none at the start), the next command change."""
    primitives = primitives_flown(log)
    entries = [primitive for primitive in primitives if primitive.kind is PrimitiveKind.MANEUVER]
    changes = [*(entry.start for entry in entries), log.duration]
    if not primitives:
        return
    if primitives[0].kind is PrimitiveKind.COAST:
        yield primitives[0].to_trim, None, changes[0]
    for entry, until in zip(entries, changes[1:], strict=True):
        yield entry.to_trim, entry, until


def _maneuver_segment(
    truth: Series, rule: ManeuverEnd, entry: PrimitiveFlown, until: float
) -> ManeuverSegment:
    judge = ManeuverEndJudge(rule, to_trim=entry.to_trim, target=entry.target, entry_time=entry.start)
    first, last = _span(truth, entry.start, until)
    velocity = _velocity(truth, first, last).tolist()
    end, verdict = last - 1, Verdict.UNDER_WAY
    for place, (time, sample) in enumerate(zip(truth.time[first:last].tolist(), velocity, strict=True)):
        verdict = judge.judge(time, Twist(*sample))
        if verdict is not Verdict.UNDER_WAY:
            end = first + place
            break
    return ManeuverSegment(
        id=entry.id,
        start=entry.start,
        duration=float(truth.time[end]) - entry.start,
        displacement=_pose(truth, first).inverse() @ _pose(truth, end),
        settled=verdict is Verdict.ENDED,
    )


def _coast_segment(truth: Series, trim: int, begin: float, until: float) -> CoastSegment | None:
    first, last = _span(truth, begin, until)
    if last - first < 2:
        return None
    return CoastSegment(trim, begin, until - begin, _velocity(truth, first, last))


def _span(truth: Series, start: float, end: float) -> tuple[int, int]:
    """Returns the rows from a time to another, both included, within half a microsecond."""
    return (
        int(np.searchsorted(truth.time, start - 5e-7)),
        int(np.searchsorted(truth.time, end + 5e-7)),
    )


def _velocity(truth: Series, first: int, last: int) -> Float[np.ndarray, "n 3"]:
    columns = [truth[name][first:last] for name in ("forward", "side", "yaw_rate")]
    return np.stack(columns, axis=1)


def _pose(truth: Series, row: int) -> SE2:
    return SE2(float(truth["north"][row]), float(truth["east"][row]), float(truth["heading"][row]))
