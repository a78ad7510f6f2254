"""Resets of an estimator and jumps that no vehicle makes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flightlog.imports.measured_motion import Source

Column = Float[np.ndarray, "n"]

HIGHEST_ACCELERATION = 100.0
"""Acceleration that no vehicle reaches, m/s²."""

HIGHEST_YAW_RATE = 20.0
"""Yaw rate that no vehicle reaches, rad/s."""

_MIN_STEP, _MIN_SPEED_STEP, _MIN_TURN = 0.5, 2.0, 0.5
# Steps that the noise of a whole flight explains, in median steps.
_NOISE = 15.0
_STEEP = 0.3
_SAME = 0.25


@dataclass(frozen=True, slots=True)
class Break:
    """Moment at which a log's motion is broken, and why.

    Attributes:
        start: last sample before, seconds.
        time: first sample after, seconds.
        reason: in words.
    """

    start: float
    time: float
    reason: str


def counter_breaks(time: Column, counters: Sequence[tuple[str, Column]]) -> list[Break]:
    """Returns the moments at which reset counters of an estimator change."""
    found = []
    for name, counter in counters:
        for place in np.flatnonzero(np.diff(counter) != 0.0):
            found.append(Break(float(time[place]), float(time[place + 1]), f"the estimator reset its {name}"))
    return found


def jumps(sources: Sequence[Source]) -> list[Break]:
    """Returns the moments at which positions, velocities or headings jump."""
    found: list[Break] = []
    for source in sources:
        columns, time = source.columns, source.time
        if {"north", "east"} <= columns.keys():
            found += _position_jumps(*_known(time, columns["north"], columns["east"]))
        if {"velocity_north", "velocity_east"} <= columns.keys():
            found += _velocity_jumps(*_known(time, columns["velocity_north"], columns["velocity_east"]))
        if "heading" in columns:
            level = np.cos(columns["pitch"]) > _STEEP if "pitch" in columns else True
            found += _heading_jumps(*_known(time, np.where(level, columns["heading"], np.nan)))
    return found


def merged(breaks: Sequence[Break]) -> list[Break]:
    """Returns breaks by time, those of one moment as one."""
    kept: list[Break] = []
    for each in sorted(breaks, key=_time):
        if kept and each.time - kept[-1].time < _SAME:
            if each.reason.rpartition(" by ")[0] not in kept[-1].reason or "reset" in each.reason:
                kept[-1] = Break(kept[-1].start, each.time, f"{kept[-1].reason}; {each.reason}")
        else:
            kept.append(each)
    return kept


def _time(each: Break) -> float:
    return each.time


def _position_jumps(time: Column, place: Float[np.ndarray, "n 2"]) -> Iterator[Break]:
    if len(time) < 3:
        return
    step = np.diff(time)
    velocity = np.diff(place, axis=0) / step[:, None]
    # Against the nearer of the neighbouring steps: a jump is one step, a fast flight is many.
    before = np.vstack([velocity[1:2], velocity[:-1]])
    after = np.vstack([velocity[1:], velocity[-2:-1]])
    apart = np.minimum(*(np.linalg.norm(velocity - other, axis=1) * step for other in (before, after)))
    limit = np.maximum(_MIN_STEP + 0.5 * HIGHEST_ACCELERATION * step**2, _NOISE * np.median(apart))
    for at in np.flatnonzero(apart > limit):
        yield Break(float(time[at]), float(time[at + 1]), f"the position jumps by {apart[at]:.2f} m")


def _velocity_jumps(time: Column, velocity: Float[np.ndarray, "n 2"]) -> Iterator[Break]:
    if len(time) < 3:
        return
    step, apart = np.diff(time), np.linalg.norm(np.diff(velocity, axis=0), axis=1)
    limit = np.maximum(_MIN_SPEED_STEP + HIGHEST_ACCELERATION * step, _NOISE * np.median(apart))
    for at in np.flatnonzero(apart > limit):
        yield Break(float(time[at]), float(time[at + 1]), f"the velocity jumps by {apart[at]:.2f} m/s")


def _heading_jumps(time: Column, heading: Float[np.ndarray, "n 1"]) -> Iterator[Break]:
    if len(time) < 3:
        return
    step, apart = np.diff(time), np.abs(np.diff(np.unwrap(heading[:, 0])))
    limit = np.maximum(_MIN_TURN + HIGHEST_YAW_RATE * step, _NOISE * np.median(apart))
    for at in np.flatnonzero(apart > limit):
        yield Break(float(time[at]), float(time[at + 1]), f"the heading jumps by {apart[at]:.2f} rad")


def _known(time: Column, *columns: Column) -> tuple[Float[np.ndarray, "m"], Float[np.ndarray, "m k"]]:
    """Returns rows without holes in values or steps in time."""
    values = np.column_stack(columns)
    rows = np.flatnonzero(np.isfinite(values).all(axis=1) & np.isfinite(time))
    rows = rows[np.diff(time[rows], prepend=-np.inf) > 0.0]
    return time[rows], values[rows]
