"""Estimate of the wind from the vehicle's vertical velocity errors.

The controller holds height; the remaining vertical velocity is caused by gusts and grows with them. Errors of
the forward and side velocity do so too, but a vehicle that is not the one believed shows them in any wind:
with the centre of mass 3 cm off they look like three times the wind, the vertical ones do not change. The
innovations of the filter do not depend on gusts, because the inertial unit measures the motion caused by
them; they show whether the estimate, and so the velocity error, is reliable.
"""

from math import exp, sqrt

AVERAGING_TIME = 10.0
"""Averaging time of squared errors in seconds: a few turbulence lengths at the speeds flown."""

WARM_UP_TIME = 5.0
"""Seconds before the first estimate."""

STILL_AIR_ERROR = 0.010
"""Root mean square vertical velocity in still air in m/s, measured over trims and maneuvers."""

ERROR_PER_WIND = 0.0115
"""Root mean square vertical velocity for each m/s of wind at 20 ft in straight flight.

`benchmarks.flight.turbulence` measures 0.010 in `gtmax` and 0.014 in `light`.
"""

ERROR_PER_WIND_IN_TURNS = 0.083
"""Increase of that for each (rad/s)^2 of yaw rate, because the mean wind's direction rotates in the body."""


class TurbulenceMeter:
    """Estimator of the wind at 20 ft from vertical velocities.

    Args:
        interval: seconds between two updates.
    """

    def __init__(self, interval: float) -> None:
        self._decay = exp(-interval / AVERAGING_TIME)
        self._interval = interval
        self._updates = 0
        self._square = 0.0

    def update(self, descent: float, *, yaw_rate: float) -> None:
        """Adds a vertical velocity.

        Args:
            descent: estimated vertical velocity, m/s.
            yaw_rate: commanded yaw rate, rad/s.
        """
        per_wind = ERROR_PER_WIND + ERROR_PER_WIND_IN_TURNS * yaw_rate**2
        square = (descent**2 - STILL_AIR_ERROR**2) / per_wind**2
        self._square = self._decay * self._square + (1.0 - self._decay) * square
        self._updates += 1

    @property
    def wind_at_20_ft(self) -> float | None:
        """Estimated wind at 20 ft in m/s; None during warm-up."""
        if self._updates * self._interval < WARM_UP_TIME:
            return None
        mean_square = self._square / (1.0 - self._decay**self._updates)
        return sqrt(max(mean_square, 0.0))
