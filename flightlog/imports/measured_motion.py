"""States from measured positions, velocities and attitudes of any vehicle."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from flightlog.consistency import LARGEST_VALUE
from flightlog.series import Series, Topic

from .motion.derived_fields import (
    BODY_RATES,
    HEADING_RATE,
    WORLD_RATES,
    body_rates,
    level_velocities,
    yaw_rate,
)

Column = Float[np.ndarray, "n"]

MAX_GAP = 10.0
"""Largest gap bridged by interpolation, in median sample intervals of the source."""

LEAST_KNOWN = 0.1
"""Smallest share of the states at which a field is known; below it is absent."""

_MIN_GAP, _MOST_GAP = 0.5, 10.0
_MOST_COMPARED = 20_000
_KEPT = 0.9
# Incomplete states that are left out at the ends, in seconds.
_RAGGED = 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """Data of one sensor or estimator.

    Attributes:
        time: seconds, on the clock of all sources.
        columns: measured fields of a state: positions north, east, down in metres; angles roll, pitch,
            heading; body rates about forward, right, down. Velocities are velocity_north, velocity_east,
            velocity_down or body_forward, body_right, body_down; body rates about world axes are turn_north,
            turn_east, turn_down.
    """

    time: Column
    columns: Mapping[str, Column]


def attitude_source(time: Column, quaternions: Float[np.ndarray, "n 4"]) -> Source:
    """Returns the Euler angles of body-to-world quaternions w, x, y, z."""
    with np.errstate(all="ignore"):
        w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    known = np.isfinite(w)
    w, x, y, z = w[known], x[known], y[known], z[known]
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    heading = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return Source(time[known], {"roll": roll, "pitch": pitch, "heading": heading})


def differentiate_position(position: Source) -> Source:
    """Returns the velocity as derivative of a position, not across holes."""
    known = _drop_invalid_samples(position)
    return Source(
        known.time,
        {f"velocity_{name}": slope(column, known.time) for name, column in known.columns.items()},
    )


def slope(column: Column, time: Column) -> Column:
    """Returns the derivative of a column, one-sided at holes; not-a-number where alone."""
    rate = np.full(len(time), np.nan)
    for rows in stretches(time):
        if len(rows) > 1:
            rate[rows] = np.gradient(column[rows], time[rows])
    return rate


def stretches(time: Column) -> list[Int[np.ndarray, "k"]]:
    """Returns the rows of each stretch without a hole."""
    rows = np.arange(len(time))
    return [rows] if len(time) < 2 else np.split(rows, np.flatnonzero(np.diff(time) > longest_gap(time)) + 1)


def longest_gap(time: Column) -> float:
    """Returns the longest gap between samples that is no hole, seconds."""
    return min(max(MAX_GAP * float(np.median(np.diff(time))), _MIN_GAP), _MOST_GAP)


def measured_states(sources: Sequence[Source], topic: Topic) -> Series | None:
    """Returns states at the fastest source's rate, others interpolated linearly.

    A field is not-a-number where its source has a hole. The topic has only the known fields: velocities along
    and across the heading need an attitude; the yaw rate follows from the body rates, or else from the
    derivative of the heading.

    Args:
        sources: sources of one vehicle with disjoint columns.
        topic: topic of the states: estimate or truth.
    """
    cleaned = [part for part in map(_drop_invalid_samples, sources) if len(part.time) > 1]
    if not cleaned:
        return None
    measured = {name for part in cleaned for name in part.columns}
    rates = {"roll", "pitch"} <= measured and any({*names} <= measured for names in (BODY_RATES, WORLD_RATES))
    time = _base_times(cleaned)
    known: dict[str, Column] = {}
    for part in cleaned:
        along = _along_heading(part, cleaned)
        known |= _interpolate_source(along if rates else _with_heading_rate(along), time)
    known |= dict(body_rates(known))
    turning = yaw_rate(known)
    if turning is not None:
        known["yaw_rate"] = turning
    enough = max(2.0, LEAST_KNOWN * len(time))
    names = [name for name in topic.field_names if name in known and np.isfinite(known[name]).sum() >= enough]
    if not names:
        return None
    values = np.column_stack([known[name] for name in names])
    values[~_is_plausible(values).all(axis=1)] = np.nan
    rows = _without_ragged_ends(time, np.isfinite(values))
    return Series(topic.only(names), time[rows], values[rows]) if len(rows) > 1 else None


def velocity_disagreement(states: Series) -> tuple[float, float] | None:
    """Returns RMS velocity error against positions, and RMS speed, in m/s.

    Velocities are compared with displacements over one second without holes, and the tenth of the spans with
    the largest error is left out, as a position may jump; None if one of them is unknown or the flight is too
    short.
    """
    needed = ("north", "east", "forward", "side", "heading")
    if not states.has_fields(*needed):
        return None
    known = np.isfinite(np.column_stack([states[name] for name in needed])).all(axis=1)
    time, fields = states.time[known], {name: states[name][known] for name in needed}
    if len(time) < 2 or time[-1] - time[0] < 2.0:
        return None
    c, s = np.cos(fields["heading"]), np.sin(fields["heading"])
    forward, side = fields["forward"], fields["side"]
    velocity = (c * forward - s * side, s * forward + c * side)
    spacing = max(0.5, float(time[-1] - time[0]) / _MOST_COMPARED)
    begins = np.arange(time[0], time[-1] - 1.0, spacing)
    holes = np.concatenate([[0], np.cumsum(np.diff(time) > longest_gap(time))])
    first, last = np.searchsorted(time, begins), np.searchsorted(time, begins + 1.0)
    begins = begins[holes[np.minimum(last, len(time) - 1)] == holes[np.maximum(first - 1, 0)]]
    if not len(begins):
        return None
    squares, speeds = np.zeros(len(begins)), np.zeros(len(begins))
    for axis, along in zip(("north", "east"), velocity, strict=True):
        reckoned = np.concatenate([[0.0], np.cumsum(0.5 * (along[1:] + along[:-1]) * np.diff(time))])
        moved, integrated = (
            np.interp(begins + 1.0, time, position) - np.interp(begins, time, position)
            for position in (fields[axis], reckoned)
        )
        squares += (moved - integrated) ** 2
        speeds += moved**2
    kept = np.argsort(squares)[: max(1, int(np.ceil(_KEPT * len(squares))))]
    return float(np.sqrt(squares[kept].mean())), float(np.sqrt(speeds[kept].mean()))


def _base_times(sources: Sequence[Source]) -> Column:
    """Returns the fastest source's times, and others in its holes.

    Of sources of about one rate it is the first.
    """
    intervals = [float(np.median(np.diff(source.time))) for source in sources]
    order = sorted(
        range(len(sources)),
        key=lambda place: (
            intervals[place] > 1.2 * min(intervals),
            intervals[place] if intervals[place] > 1.2 * min(intervals) else 0.0,
            place,
        ),
    )
    time = sources[order[0]].time
    for place in order[1:]:
        other = sources[place].time
        time = np.union1d(time, other[~_has_neighbours(time, other)])
    return time


def _along_heading(source: Source, sources: Sequence[Source]) -> Source:
    """Returns velocities along and across the heading at their own times."""
    if not {"velocity_north", "velocity_down", "body_forward"} & source.columns.keys():
        return source
    known = dict(source.columns)
    for other in sources:
        if "heading" in other.columns:
            known |= _interpolate_source(other, source.time)
    along = {**source.columns, **dict(level_velocities(known))}
    return Source(source.time, along)


def _with_heading_rate(source: Source) -> Source:
    if "heading" not in source.columns:
        return source
    rate = slope(np.unwrap(source.columns["heading"]), source.time)
    return Source(source.time, {**source.columns, HEADING_RATE: rate})


def _without_ragged_ends(time: Column, known: Bool[np.ndarray, "n k"]) -> Int[np.ndarray, "m"]:
    """Returns rows with a known field, without incomplete ones at the ends."""
    rows = np.flatnonzero(known.any(axis=1))
    whole = np.flatnonzero(known.all(axis=1))
    if not len(whole):
        return rows
    first, last = whole[0], whole[-1]
    first = first if time[first] - time[rows[0]] <= _RAGGED else rows[0]
    last = last if time[rows[-1]] - time[last] <= _RAGGED else rows[-1]
    return np.asarray(rows[(rows >= first) & (rows <= last)])


def _drop_invalid_samples(source: Source) -> Source:
    """Returns a source without implausible values and non-increasing times."""
    columns = {name: np.asarray(column, np.float64) for name, column in source.columns.items()}
    values = np.column_stack([*columns.values()])
    good = np.isfinite(source.time) & (np.isfinite(values) & _is_plausible(values)).all(axis=1)
    latest = np.maximum.accumulate(np.where(good, source.time, -np.inf))
    good &= source.time > np.concatenate([[-np.inf], latest[:-1]])
    return Source(source.time[good], {name: column[good] for name, column in columns.items()})


def _is_plausible(values: Float[np.ndarray, "n k"]) -> Bool[np.ndarray, "n k"]:
    return np.asarray(~(np.abs(values) >= LARGEST_VALUE))


def _has_neighbours(time: Column, wanted: Float[np.ndarray, "wanted"]) -> Bool[np.ndarray, "wanted"]:
    """Returns a mask of times with samples close on both sides."""
    longest = longest_gap(time)
    after = np.searchsorted(time, wanted).clip(1, len(time) - 1)
    within = (wanted >= time[0]) & (wanted <= time[-1])
    sampled = (time[after] == wanted) | (time[after - 1] == wanted)
    return np.asarray(within & (sampled | (time[after] - time[after - 1] <= longest)))


def _interpolate_source(source: Source, time: Column) -> dict[str, Column]:
    """Returns the columns at other times; not-a-number in holes."""
    near = _has_neighbours(source.time, time)
    found = {}
    for name, column in source.columns.items():
        turning = name in {"heading", "roll"}
        between = np.interp(time, source.time, np.unwrap(column) if turning else column)
        if name == "roll":
            between = np.pi - np.remainder(np.pi - between, 2.0 * np.pi)
        found[name] = np.where(near, between, np.nan)
    return found
