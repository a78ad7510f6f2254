"""Second-order step response between the velocities of two trims."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares

# Limits of a fit's natural frequency, rad/s, and damping ratio.
_FREQUENCIES = (0.05, 50.0)
_DAMPINGS = (0.3, 0.99)


@dataclass(frozen=True, slots=True)
class StepResponse:
    """Natural frequency in rad/s and damping ratio < 1 (thesis, 3.2.5)."""

    frequency: float
    damping: float

    def remaining_share(self, time: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
        """Returns the remaining share of a step after a time in seconds."""
        damped = self.frequency * np.sqrt(1 - self.damping**2)
        late = np.maximum(time, 0.0)
        decay = np.exp(-self.damping * self.frequency * late)
        ratio = self.damping * self.frequency / damped
        share: Float[np.ndarray, "n"] = decay * (np.cos(damped * late) + ratio * np.sin(damped * late))
        return share


def fit_response(
    steps: Sequence[Float[np.ndarray, "_"]], *, period: float, memory: float, guess: StepResponse
) -> StepResponse:
    """Fits a response to steps by least squares on their innovations.

    Args:
        steps: remaining share of each step, from its entry on.
        period: sampling period, seconds.
        memory: autocorrelation of deviations after one sample; deviations are of first order.
        guess: initial guess.
    """

    def misfit(numbers: Float[np.ndarray, "2"]) -> Float[np.ndarray, "samples"]:
        response = StepResponse(float(np.exp(numbers[0])), float(numbers[1]))
        off = [step - response.remaining_share(np.arange(len(step)) * period) for step in steps]
        return np.concatenate([one[1:] - memory * one[:-1] for one in off])

    lowest, highest = np.log(_FREQUENCIES)
    begin = [np.log(guess.frequency), guess.damping]
    bounds = ([lowest, _DAMPINGS[0]], [highest, _DAMPINGS[1]])
    found: Any = least_squares(misfit, begin, bounds=bounds, loss="soft_l1", f_scale=0.05)
    return StepResponse(float(np.exp(found.x[0])), float(found.x[1]))
