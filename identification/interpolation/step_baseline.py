"""Baseline of maneuvers: second-order responses between trims.

Forward velocity and yaw rate follow second-order responses to the next trim's values; the maneuver ends by
the rule of `flight.automaton.maneuver_end`. Two responses are fitted to all flown maneuvers together.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares

from flight.automaton.library import Library
from flight.automaton.maneuver_end import Band
from flight.se2 import Twist
from identification.segmentation.second_order_response import StepResponse

# Time step of the baseline, s.
_STEP = 0.02
# Scales of equal misfit: s, m, m, rad.
_SCALES = np.array([0.2, 0.3, 0.3, 0.05])


@dataclass(frozen=True, slots=True)
class VelocityStep:
    """Velocities left and reached, with the band around the latter."""

    left: Twist
    reached: Twist
    band: Band


@dataclass(frozen=True, slots=True)
class Baseline:
    """Responses of forward velocity and yaw rate, dwell and time-out."""

    forward: StepResponse
    yaw_rate: StepResponse
    dwell: float
    timeout: float

    def maneuver(self, step: VelocityStep) -> tuple[float, float, float, float]:
        """Returns duration, s, displacement forward and right, m, heading change, rad."""
        time = np.arange(0.0, self.timeout, _STEP)
        speed_off = (step.left.forward - step.reached.forward) * self.forward.remaining_share(time)
        rate_off = (step.left.yaw_rate - step.reached.yaw_rate) * self.yaw_rate.remaining_share(time)
        outside = (np.abs(speed_off) > step.band.forward) | (np.abs(rate_off) > step.band.yaw_rate)
        last = int(np.flatnonzero(outside)[-1]) + 1 if outside.any() else 0
        count = min(last + round(self.dwell / _STEP), len(time) - 1)
        speed = step.reached.forward + 0.5 * (speed_off[1 : count + 1] + speed_off[:count])
        rate = step.reached.yaw_rate + 0.5 * (rate_off[1 : count + 1] + rate_off[:count])
        heading = np.concatenate([[0.0], np.cumsum(rate) * _STEP])
        middle = 0.5 * (heading[1:] + heading[:-1])
        forward, side = speed * np.cos(middle) * _STEP, speed * np.sin(middle) * _STEP
        return count * _STEP, float(forward.sum()), float(side.sum()), float(heading[-1])

    def residual(self, step: VelocityStep) -> tuple[float, float]:
        """Returns the largest residuals after a step's end, m/s and rad/s."""
        later = np.arange(self.maneuver(step)[0], self.timeout, _STEP)
        speed_off = (step.left.forward - step.reached.forward) * self.forward.remaining_share(later)
        rate_off = (step.left.yaw_rate - step.reached.yaw_rate) * self.yaw_rate.remaining_share(later)
        return float(np.abs(speed_off).max(initial=0.0)), float(np.abs(rate_off).max(initial=0.0))

    def maneuvers(self, steps: Sequence[VelocityStep]) -> Float[np.ndarray, "n 4"]:
        """Returns the rows of `maneuver` for several steps."""
        return np.array([self.maneuver(step) for step in steps])


def fit_baseline(
    library: Library, steps: Sequence[VelocityStep], flown: Float[np.ndarray, "n 4"]
) -> Baseline:
    """Fits the responses to all flown maneuvers together.

    Args:
        library: library with the rule.
        steps: velocity steps of the flown maneuvers.
        flown: their values: duration, forward, side, heading change.
    """
    rule = library.conditions.maneuver_end
    assert rule is not None

    def baseline(numbers: Float[np.ndarray, "4"]) -> Baseline:
        forward, damping, yaw_rate, yaw_damping = numbers.tolist()
        responses = StepResponse(forward, damping), StepResponse(yaw_rate, yaw_damping)
        return Baseline(*responses, dwell=rule.dwell, timeout=rule.timeout)

    def misfit(numbers: Float[np.ndarray, "4"]) -> Float[np.ndarray, "m"]:
        off = (baseline(numbers).maneuvers(steps) - flown) / _SCALES
        return np.asarray(off.ravel())

    bounds = ([0.2, 0.4, 0.2, 0.4], [8.0, 0.98, 8.0, 0.98])
    # Durations are quantised, so finite differences must exceed a time step.
    found: Any = least_squares(
        misfit, [0.9, 0.8, 1.1, 0.8], bounds=bounds, diff_step=[0.02] * 4, loss="soft_l1"
    )
    return baseline(found.x)
