"""Units of imported data, and evidence of them in the motion."""

from collections.abc import Mapping
from math import pi
from typing import Literal

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError

Quantity = Literal["time", "length", "speed", "angle", "rate"]
LengthUnit = Literal["m", "km", "cm", "mm", "ft"]
SpeedUnit = Literal["m/s", "km/h", "kn", "ft/s", "mph", "cm/s", "mm/s"]
AngleUnit = Literal["rad", "deg"]
RateUnit = Literal["rad/s", "deg/s"]

LENGTHS: Mapping[str, float] = {"m": 1.0, "km": 1e3, "cm": 1e-2, "mm": 1e-3, "ft": 0.3048}
SPEEDS: Mapping[str, float] = {
    **{"m/s": 1.0, "km/h": 1.0 / 3.6, "kn": 1852.0 / 3600.0, "ft/s": 0.3048},
    **{"mph": 0.44704, "cm/s": 1e-2, "mm/s": 1e-3},
}
ANGLES: Mapping[str, float] = {"rad": 1.0, "deg": pi / 180.0}
RATES: Mapping[str, float] = {"rad/s": 1.0, "deg/s": pi / 180.0}
"""Sizes of units in SI."""

_TOLERANCE = 1.25
"""Largest ratio of velocity to slope of position that noise explains."""
_FIT = 1.08
_MIN_SPEED, _MIN_WINDOWS, _MOST_WINDOWS = 0.2, 5, 5_000
_WINDOW = 1.0
_MIN_COURSE_SPEED, _MIN_TURN = 0.5, 0.05

Column = Float[np.ndarray, "n"]


class UnitError(FlightError):
    """Numbers that cannot be in the unit that is assumed."""


def check_angles(angles: Mapping[str, Column], course: Column | None) -> None:
    """Refuses angles that are not radians, or may not be.

    Args:
        angles: roll, pitch and yaw as they are in the file, those known.
        course: course over ground in radians, not-a-number at rest; None if not known.

    Raises:
        UnitError: they are in degrees, or the data do not tell.
    """
    for name, largest in (("roll", pi), ("pitch", pi / 2)):
        if name in angles and _largest(angles[name]) > 1.01 * largest:
            raise UnitError(
                f"{name} reaches {_largest(angles[name]):.4g}, more than {largest:.2f} rad: "
                "give --angle-unit deg"
            )
    yaw = angles.get("yaw")
    if yaw is None or not np.isfinite(yaw).any():
        return
    steps = np.abs(np.diff(yaw[np.isfinite(yaw)]))
    if ((steps > 300.0) & (steps < 420.0)).any() and _largest(yaw) <= 361.0:
        raise UnitError(f"yaw jumps by 360 and reaches {_largest(yaw):.4g}: give --angle-unit deg")
    factor = _better_in_degrees(yaw, course)
    if factor is None and _largest(yaw) > 2.02 * pi:
        raise UnitError(
            f"yaw reaches {_largest(yaw):.4g}, and the motion does not tell its unit: give --angle-unit deg "
            "or --angle-unit rad"
        )
    if factor:
        raise UnitError("yaw fits the motion as degrees and not as radians: give --angle-unit deg")


def check_speeds(
    time: Column,
    position: Float[np.ndarray, "n k"],
    velocity: Float[np.ndarray, "n k"],
    *,
    stated: frozenset[Quantity],
) -> None:
    """Refuses velocities whose size differs from the position's slope.

    Args:
        time: seconds, increasing.
        position: metres, if the unit is right.
        velocity: metres per second, if the unit is right, in axes of any kind.
        stated: quantities whose unit the file or an option states.

    Raises:
        UnitError: a unit of one of them explains the ratio.
    """
    ratio = slope_ratio(time, position, velocity)
    if ratio is None or 1.0 / _TOLERANCE < ratio < _TOLERANCE:
        return
    fitting = [
        f"--{quantity}-unit {unit}"
        for quantity, sizes, sign in (("speed", SPEEDS, 1.0), ("length", LENGTHS, -1.0))
        for unit, size in sizes.items()
        if size != 1.0 and 1.0 / _FIT < ratio / size**sign < _FIT and quantity not in stated
    ]
    if "time" not in stated and 1.0 / _FIT < ratio / 1e-3 < _FIT:
        fitting.append("--time-unit ms")
    if fitting:
        raise UnitError(
            f"the position changes {ratio:.3g} times as fast as the velocity says: "
            f"give {' or '.join(fitting)}"
        )


def slope_ratio(
    time: Column, position: Float[np.ndarray, "n k"], velocity: Float[np.ndarray, "n k"]
) -> float | None:
    """Returns the speed by positions over that by velocities; None at rest.

    It is the median over spans of a second in which the vehicle moves.
    """
    known = np.isfinite(position).all(axis=1) & np.isfinite(velocity).all(axis=1)
    time, position, velocity = time[known], position[known], velocity[known]
    if len(time) < 3:
        return None
    interval = float(np.median(np.diff(time)))
    span = max(_WINDOW, 3.0 * interval)
    first = np.unique(np.linspace(0, len(time) - 1, _MOST_WINDOWS).astype(np.int64))
    last = np.searchsorted(time, time[first] + span)
    inside = last < len(time)
    first, last = first[inside], last[inside]
    inside = (time[last] - time[first] < 1.5 * span) & (last - first >= 2)
    first, last = first[inside], last[inside]
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(position, axis=0), axis=1))])
    moved = np.linalg.norm(position[last] - position[first], axis=1)
    size = np.linalg.norm(velocity, axis=1)
    path = np.concatenate([[0.0], np.cumsum(0.5 * (size[1:] + size[:-1]) * np.diff(time))])
    said = path[last] - path[first]
    # On a straight path, so that noise and turns do not count.
    straight = (moved > 0.8 * (way[last] - way[first])) & (said > 0.0)
    fast = straight & (said > 0.5 * np.percentile(said, 90) if len(said) else straight)
    if fast.sum() < _MIN_WINDOWS or max(np.median(said[fast]), np.median(moved[fast])) < _MIN_SPEED * span:
        return None
    return float(np.median(moved[fast] / said[fast]))


def _better_in_degrees(yaw: Column, course: Column | None) -> bool | None:
    """Returns True if degrees fit the course better; None if unclear."""
    if course is None:
        return None
    moving = np.isfinite(yaw) & np.isfinite(course)
    if moving.sum() < 20 or np.ptp(np.unwrap(course[moving])) < _MIN_TURN:
        return None
    scatter = {
        unit: 1.0 - abs(np.exp(1j * (size * yaw - course)[moving]).mean()) for unit, size in ANGLES.items()
    }
    if scatter["rad"] < 0.2 * scatter["deg"] or scatter["rad"] < 1e-3:
        return False
    return True if scatter["deg"] < 0.2 * scatter["rad"] else None


def check_rates(yaw: Column, rate: Column, time: Column) -> None:
    """Refuses body rates that are degrees per second.

    Args:
        yaw: radians.
        rate: rate about the axis down, assumed in radians per second.
        time: seconds.

    Raises:
        UnitError: they are about 57 times the slope of the yaw.
    """
    known = np.isfinite(yaw) & np.isfinite(rate)
    if known.sum() < 20:
        return
    turned = np.unwrap(yaw[known])
    way = np.concatenate(
        [[0.0], np.cumsum(0.5 * (rate[known][1:] + rate[known][:-1]) * np.diff(time[known]))]
    )
    slope = np.polyfit(turned - turned.mean(), way - way.mean(), 1)[0] if np.ptp(turned) > _MIN_TURN else 1.0
    size = 180.0 / pi
    if size / 1.5 < abs(slope) < size * 1.5:
        raise UnitError(f"body rates are {abs(slope):.3g} times the slope of the yaw: give --rate-unit deg/s")


def course_of(
    time: Column, velocity: Float[np.ndarray, "n 2"] | None, position: Float[np.ndarray, "n 2"] | None
) -> Column | None:
    """Returns the course over ground in radians, not-a-number at rest."""
    if velocity is None and position is not None and len(time) > 2:
        with np.errstate(all="ignore"):
            velocity = np.column_stack([np.gradient(column, time) for column in position.T])
    if velocity is None:
        return None
    course = np.arctan2(velocity[:, 1], velocity[:, 0])
    return np.where(np.linalg.norm(velocity, axis=1) > _MIN_COURSE_SPEED, course, np.nan)


def _largest(values: Column) -> float:
    finite = np.abs(values[np.isfinite(values)])
    return float(finite.max()) if len(finite) else 0.0
