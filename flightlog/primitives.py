"""Primitives of a flight, with consecutive coasts in one trim merged."""

from dataclasses import dataclass, replace
from enum import IntEnum

from flight.se2 import Twist

from .log import FlightLog
from .topics import PRIMITIVE


class PrimitiveKind(IntEnum):
    """Values of `/primitive` `kind`."""

    COAST = 0
    MANEUVER = 1


@dataclass(frozen=True, slots=True)
class FlownPrimitive:
    """One row of `/primitive` as a value.

    Attributes:
        kind: coast or maneuver.
        id: id of the trim held, or of the maneuver.
        from_trim: id of the trim left; of the trim held in a coast.
        to_trim: id of the trim reached; of the trim held in a coast.
        target: nominal velocity of that trim.
        start: start, seconds.
        end: start of the next primitive or end of the log, seconds.
        timed_out: True if it ended by time-out.
    """

    kind: PrimitiveKind
    id: int
    from_trim: int
    to_trim: int
    target: Twist
    start: float
    end: float
    timed_out: bool


def flown_primitives(log: FlightLog) -> tuple[FlownPrimitive, ...]:
    """Returns the primitives of a log in the order flown."""
    series = log[PRIMITIVE]
    ends = [*series.time[1:].tolist(), log.duration]
    timed_out = [*series["timed_out"][1:].tolist(), 0.0]
    return tuple(
        FlownPrimitive(
            kind=PrimitiveKind(int(row[0])),
            id=int(row[1]),
            from_trim=int(row[2]),
            to_trim=int(row[3]),
            target=Twist(row[4], row[5], row[6]),
            start=start,
            end=end,
            timed_out=bool(late),
        )
        for row, start, end, late in zip(
            series.values.tolist(), series.time.tolist(), ends, timed_out, strict=True
        )
    )


def merged_primitives(log: FlightLog) -> tuple[FlownPrimitive, ...]:
    """Returns the primitives with consecutive coasts in one trim merged.

    Empty coasts are dropped; an imported log has no primitives.
    """
    if PRIMITIVE.name not in log.series:
        return ()
    merged: list[FlownPrimitive] = []
    for part in flown_primitives(log):
        coast = part.kind is PrimitiveKind.COAST
        if coast and part.end <= part.start:
            continue
        if coast and merged and merged[-1].kind is part.kind and merged[-1].id == part.id:
            merged[-1] = replace(merged[-1], end=part.end)
        else:
            merged.append(part)
    return tuple(merged)
