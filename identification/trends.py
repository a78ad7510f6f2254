"""Trends over speed and yaw rate (thesis, 3.3, Figures 7 to 9)."""

from collections.abc import Callable
from dataclasses import dataclass

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim

# Tolerance of equal steps, m/s and rad/s.
SAME = 1e-3


@dataclass(frozen=True, slots=True)
class SpeedError:
    """Figure 7: a straight trim's forward error.

    Attributes:
        speed: m/s.
        error: largest deviation, m/s.
        percent: error in percent of the speed; None in hover.
        samples: number of flights.
    """

    speed: float
    error: float
    percent: float | None
    samples: int


@dataclass(frozen=True, slots=True)
class SpeedStep:
    """Figure 8: a change of speed in straight flight.

    Attributes:
        entry_speed: m/s.
        exit_speed: m/s.
        displacement: forward, m.
        error: largest deviation of it, m.
        percent: of the displacement.
        duration: s.
        duration_percent: largest deviation of the duration in percent of it.
        samples: number of flights.
    """

    entry_speed: float
    exit_speed: float
    displacement: float
    error: float
    percent: float
    duration: float
    duration_percent: float
    samples: int


@dataclass(frozen=True, slots=True)
class TurnStep:
    """Figure 9: a change of yaw rate at one speed.

    Attributes:
        speed: m/s.
        entry_rate: rad/s.
        exit_rate: rad/s.
        heading_change: rad.
        heading_error: largest deviation of it, rad.
        duration: s.
        duration_percent: largest deviation of the duration in percent of it.
        samples: number of flights.
    """

    speed: float
    entry_rate: float
    exit_rate: float
    heading_change: float
    heading_error: float
    duration: float
    duration_percent: float
    samples: int


@dataclass(frozen=True, slots=True)
class Trends:
    """Data of the three figures; empty where the library has none."""

    speed_errors: tuple[SpeedError, ...]
    speed_steps: tuple[SpeedStep, ...]
    turn_steps: tuple[TurnStep, ...]


def trends(library: Library, *, speed_step: float, rate_step: float) -> Trends:
    """Returns the trends of a library's flown primitives.

    Primitives without statistics were not flown and are ignored.

    Args:
        library: flown library.
        speed_step: size of the changes of speed, m/s.
        rate_step: size of the changes of yaw rate, rad/s.
    """
    straight = [trim for trim in library.trims if trim.statistics and _is_straight(trim)]
    steps = [row for row in library.maneuvers if row.statistics]
    return Trends(
        speed_errors=tuple(sorted((_speed_error(trim) for trim in straight), key=lambda row: row.speed)),
        speed_steps=tuple(
            _speed_step(library, row)
            for row in _sort_rows(library, steps, lambda trim: trim.velocity.forward)
            if _is_speed_step(library, row, speed_step)
        ),
        turn_steps=tuple(
            _turn_step(library, row)
            for row in _sort_rows(library, steps, lambda trim: trim.velocity.yaw_rate)
            if _is_turn_step(library, row, rate_step)
        ),
    )


def _sort_rows(library: Library, rows: list[Maneuver], key: Callable[[Trim], float]) -> list[Maneuver]:
    return sorted(rows, key=lambda row: (key(library.trim(row.from_trim)), key(library.trim(row.to_trim))))


def _is_straight(trim: Trim) -> bool:
    return abs(trim.velocity.side) < SAME and abs(trim.velocity.yaw_rate) < SAME


def _is_speed_step(library: Library, row: Maneuver, size: float) -> bool:
    left, reached = library.trim(row.from_trim), library.trim(row.to_trim)
    change = abs(reached.velocity.forward - left.velocity.forward)
    return _is_straight(left) and _is_straight(reached) and abs(change - size) < SAME


def _is_turn_step(library: Library, row: Maneuver, size: float) -> bool:
    left, reached = library.trim(row.from_trim).velocity, library.trim(row.to_trim).velocity
    return (
        abs(reached.forward - left.forward) < SAME
        and abs(reached.side - left.side) < SAME
        and abs(abs(reached.yaw_rate - left.yaw_rate) - size) < SAME
    )


def _speed_error(trim: Trim) -> SpeedError:
    speed, error = trim.velocity.forward, abs(trim.error.forward)
    return SpeedError(speed, error, 100 * error / speed if speed > SAME else None, _samples(trim))


def _speed_step(library: Library, row: Maneuver) -> SpeedStep:
    displacement, error = row.displacement.x, abs(row.error.forward)
    return SpeedStep(
        library.trim(row.from_trim).velocity.forward,
        library.trim(row.to_trim).velocity.forward,
        displacement,
        error,
        100 * error / abs(displacement),
        row.duration,
        100 * abs(row.error.duration) / row.duration,
        _samples(row),
    )


def _turn_step(library: Library, row: Maneuver) -> TurnStep:
    left, reached = library.trim(row.from_trim).velocity, library.trim(row.to_trim).velocity
    return TurnStep(
        left.forward,
        left.yaw_rate,
        reached.yaw_rate,
        row.displacement.heading,
        abs(row.error.heading_change),
        row.duration,
        100 * abs(row.error.duration) / row.duration,
        _samples(row),
    )


def _samples(primitive: Trim | Maneuver) -> int:
    return primitive.statistics.samples if primitive.statistics else 0
