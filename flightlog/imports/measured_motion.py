"""States from measured positions, velocities and attitudes of any vehicle."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from flightlog.consistency import LARGEST_VALUE
from flightlog.series import Series, Topic

Column = Float[np.ndarray, "n"]

BODY_RATES = ("roll_rate", "pitch_rate", "body_yaw_rate")
WORLD_RATES = ("turn_north", "turn_east", "turn_down")

MAX_GAP = 10.0
"""Largest gap bridged by interpolation, in median sample intervals of the source."""

_MIN_GAP = 0.5
_MOST_COMPARED = 20_000
_MIN_COS_PITCH = 0.01


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
    with np.errstate(invalid="ignore", divide="ignore"):
        w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    known = np.isfinite(w)
    w, x, y, z = w[known], x[known], y[known], z[known]
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    heading = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return Source(time[known], {"roll": roll, "pitch": pitch, "heading": heading})


def differentiate_position(position: Source) -> Source:
    """Returns the velocity as derivative of a position."""
    known = _drop_invalid_samples(position)
    if len(known.time) < 2:
        return Source(known.time, {f"velocity_{name}": column for name, column in known.columns.items()})
    return Source(
        known.time,
        {f"velocity_{name}": np.gradient(column, known.time) for name, column in known.columns.items()},
    )


def measured_states(sources: Sequence[Source], topic: Topic) -> Series | None:
    """Returns states at the first source's times, the others interpolated linearly.

    A state is kept if every source has samples near it. The topic has only the known fields: velocities along
    and across the heading need an attitude; the yaw rate follows from the body rates, or else from the
    derivative of the heading.

    Args:
        sources: sources of one vehicle with disjoint columns.
        topic: topic of the states: estimate or truth.
    """
    cleaned = [part for part in map(_drop_invalid_samples, sources) if len(part.time) > 1]
    if not cleaned:
        return None
    time = cleaned[0].time
    time = time[np.all([_has_neighbours(part.time, time) for part in cleaned], axis=0)]
    if len(time) < 2:
        return None
    known = {name: column for part in cleaned for name, column in _interpolate_source(part, time)}
    known |= dict(_body_rates(known))
    known |= dict(_derived_fields(known, time))
    names = [name for name in topic.field_names if name in known]
    if not names:
        return None
    values = np.column_stack([known[name] for name in names])
    sound = _is_plausible(values)
    return Series(topic.only(names), time[sound], values[sound]) if sound.sum() > 1 else None


def velocity_disagreement(states: Series) -> tuple[float, float] | None:
    """Returns RMS velocity error against positions, and RMS speed, in m/s.

    Velocities are compared with displacements over one second; None if one of them is unknown or the flight
    is too short.
    """
    needed = ("north", "east", "forward", "side", "heading")
    if not states.has_fields(*needed) or states.time[-1] - states.time[0] < 2.0:
        return None
    time = states.time
    c, s = np.cos(states["heading"]), np.sin(states["heading"])
    velocity = (c * states["forward"] - s * states["side"], s * states["forward"] + c * states["side"])
    spacing = max(0.5, float(time[-1] - time[0]) / _MOST_COMPARED)
    begins = np.arange(time[0], time[-1] - 1.0, spacing)
    squares, speeds = np.zeros(len(begins)), np.zeros(len(begins))
    for axis, along in zip(("north", "east"), velocity, strict=True):
        reckoned = np.concatenate([[0.0], np.cumsum(0.5 * (along[1:] + along[:-1]) * np.diff(time))])
        moved, integrated = (
            np.interp(begins + 1.0, time, position) - np.interp(begins, time, position)
            for position in (states[axis], reckoned)
        )
        squares += (moved - integrated) ** 2
        speeds += moved**2
    return float(np.sqrt(squares.mean())), float(np.sqrt(speeds.mean()))


def _drop_invalid_samples(source: Source) -> Source:
    """Returns a source without implausible values and non-increasing times."""
    columns = {name: np.asarray(column, np.float64) for name, column in source.columns.items()}
    good = np.isfinite(source.time) & _is_plausible(np.column_stack([*columns.values()]))
    latest = np.maximum.accumulate(np.where(good, source.time, -np.inf))
    good &= source.time > np.concatenate([[-np.inf], latest[:-1]])
    return Source(source.time[good], {name: column[good] for name, column in columns.items()})


def _is_plausible(values: Float[np.ndarray, "n k"]) -> Bool[np.ndarray, "n"]:
    return np.asarray((np.abs(values) < LARGEST_VALUE).all(axis=1))


def _has_neighbours(time: Column, wanted: Float[np.ndarray, "wanted"]) -> Bool[np.ndarray, "wanted"]:
    """Returns a mask of times with samples close on both sides."""
    longest = max(MAX_GAP * float(np.median(np.diff(time))), _MIN_GAP)
    after = np.searchsorted(time, wanted).clip(1, len(time) - 1)
    within = (wanted >= time[0]) & (wanted <= time[-1])
    return np.asarray(within & (time[after] - time[after - 1] <= longest))


def _interpolate_source(source: Source, time: Column) -> Iterator[tuple[str, Column]]:
    for name, column in source.columns.items():
        if name == "heading":
            yield name, np.interp(time, source.time, np.unwrap(column))
        elif name == "roll":
            between = np.interp(time, source.time, np.unwrap(column))
            yield name, np.pi - np.remainder(np.pi - between, 2.0 * np.pi)
        else:
            yield name, np.interp(time, source.time, column)


def _body_rates(known: Mapping[str, Column]) -> Iterator[tuple[str, Column]]:
    """Yields body rates from rates about the world axes."""
    if not {*WORLD_RATES, "roll", "pitch", "heading"} <= known.keys():
        return
    north, east, down = (known[name] for name in WORLD_RATES)
    (cr, cp, ch), (sr, sp, sh) = (
        [turn(known[name]) for name in ("roll", "pitch", "heading")] for turn in (np.cos, np.sin)
    )
    ahead, right = ch * north + sh * east, ch * east - sh * north
    below = sp * ahead + cp * down
    yield "roll_rate", cp * ahead - sp * down
    yield "pitch_rate", cr * right + sr * below
    yield "body_yaw_rate", cr * below - sr * right


def _derived_fields(known: Mapping[str, Column], time: Column) -> Iterator[tuple[str, Column]]:
    """Yields state fields derived from the known ones."""
    if {"velocity_north", "velocity_east", "heading"} <= known.keys():
        c, s = np.cos(known["heading"]), np.sin(known["heading"])
        yield "forward", c * known["velocity_north"] + s * known["velocity_east"]
        yield "side", c * known["velocity_east"] - s * known["velocity_north"]
    if "velocity_down" in known:
        yield "descent", known["velocity_down"]
    if {"body_forward", "body_right", "body_down", "roll", "pitch"} <= known.keys():
        u, v, w = (known[f"body_{axis}"] for axis in ("forward", "right", "down"))
        roll, pitch = known["roll"], known["pitch"]
        below = np.sin(roll) * v + np.cos(roll) * w
        yield "forward", np.cos(pitch) * u + np.sin(pitch) * below
        yield "side", np.cos(roll) * v - np.sin(roll) * w
        yield "descent", np.cos(pitch) * below - np.sin(pitch) * u
    if "heading" in known:
        yield "yaw_rate", _yaw_rate(known, time)


def _yaw_rate(known: Mapping[str, Column], time: Column) -> Column:
    if not {"pitch_rate", "body_yaw_rate", "roll", "pitch"} <= known.keys():
        return np.asarray(np.gradient(known["heading"], time))
    upright = np.cos(known["pitch"])
    # The yaw rate is singular at vertical pitch.
    level = np.where(np.abs(upright) > _MIN_COS_PITCH, upright, np.nan)
    turning = known["pitch_rate"] * np.sin(known["roll"]) + known["body_yaw_rate"] * np.cos(known["roll"])
    return np.asarray(turning / level)
