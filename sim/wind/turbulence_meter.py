"""Estimate of the wind from the vehicle's velocity errors.

The controller holds velocities; the remaining errors are caused by gusts and grow with them. The innovations
of the filter do not depend on gusts, because the inertial unit measures the motion caused by them; they show
whether the estimate, and so the velocity error, is reliable.
"""

from collections.abc import Sequence
from math import exp, hypot, sqrt

AVERAGING_TIME = 10.0
"""Averaging time of squared errors in seconds: a few turbulence lengths at the speeds flown."""

WARM_UP_TIME = 5.0
"""Seconds before the first estimate."""

STILL_AIR_ERROR = 0.017
"""Root mean square velocity error of trims in still air in m/s, measured."""

ERROR_PER_WIND = 0.0155
"""Root mean square velocity error for each m/s of wind at 20 ft in straight flight.

`benchmarks.flight.turbulence` measures 0.0137 in trims in `gtmax`; maneuvers of missions add errors.
"""

ERROR_PER_WIND_IN_TURNS = 0.046
"""Largest increase of that in turns, because the mean wind's direction rotates in the body; measured."""

TURN_CORNER = 0.2
"""Yaw rate in rad/s of a first-order response to the rotation, fitted to turns at 0.1 and 0.6 rad/s."""


def error_per_wind(yaw_rate: float) -> float:
    """Returns the velocity error for each m/s of wind at 20 ft."""
    return ERROR_PER_WIND + ERROR_PER_WIND_IN_TURNS * abs(yaw_rate) / hypot(yaw_rate, TURN_CORNER)


class TurbulenceMeter:
    """Estimator of the wind at 20 ft from velocity errors.

    Args:
        interval: seconds between two updates.
    """

    def __init__(self, interval: float) -> None:
        self._decay = exp(-interval / AVERAGING_TIME)
        self._interval = interval
        self._updates = 0
        self._square = 0.0

    def update(self, errors: Sequence[float], *, yaw_rate: float) -> None:
        """Adds velocity errors.

        Args:
            errors: velocity error of each axis, m/s.
            yaw_rate: commanded yaw rate, rad/s.
        """
        square = (sum(error**2 for error in errors) - STILL_AIR_ERROR**2) / error_per_wind(yaw_rate) ** 2
        self._square = self._decay * self._square + (1.0 - self._decay) * square
        self._updates += 1

    @property
    def wind_at_20_ft(self) -> float | None:
        """Estimated wind at 20 ft in m/s; None during warm-up."""
        if self._updates * self._interval < WARM_UP_TIME:
            return None
        mean_square = self._square / (1.0 - self._decay**self._updates)
        return sqrt(max(mean_square, 0.0))
