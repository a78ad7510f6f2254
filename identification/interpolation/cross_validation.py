"""Scaled velocities and cross-validation figures of interpolated primitives."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.automaton.statistics import Statistics
from flight.se2 import Twist
from flight.units import FOOT

# Differences in m/s and rad/s that count as equal distances.
SPEED_SCALE, YAW_RATE_SCALE = 8 * FOOT, 0.2


@dataclass(frozen=True, slots=True)
class InterpolationFit:
    """Cross-validation result of one interpolated number.

    Attributes:
        number: name of a trim's deviation or of a maneuver's value.
        cross_validation_error: rms leave-one-out error, in the number's unit; for a trim's deviation, of its
            logarithm.
        smoothing: smoothing of the spline.
    """

    number: str
    cross_validation_error: float
    smoothing: float


def scaled_velocity(velocity: Twist) -> tuple[float, float]:
    """Returns forward speed and yaw rate in units of equal distance."""
    return velocity.forward / SPEED_SCALE, velocity.yaw_rate / YAW_RATE_SCALE


def largest_deviation(statistics: Statistics | None, name: str) -> float:
    """Returns the largest deviation of a number of a flown primitive."""
    assert statistics is not None
    return next(one.largest_deviation for one in statistics.scalars if one.name == name)


def least_flights(found: Iterable[Statistics | None]) -> int:
    """Returns the smallest number of flights of these primitives."""
    return min(one.samples for one in found if one is not None)


def root_mean_square(values: Float[np.ndarray, "n"]) -> float:
    """Returns the root of the mean square."""
    return float(np.sqrt((values**2).mean()))
