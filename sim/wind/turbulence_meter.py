"""How hard it blows, as the vehicle itself can tell: from how far its velocity is off the one asked for.

The controller holds velocities; what is left is the work of gusts, and grows with them. The innovations of
the filter do not: an inertial unit feels what a gust does to the vehicle as it feels any motion. They tell
whether the estimate, and so the error against it, can be trusted.
"""

from collections.abc import Sequence
from math import exp, sqrt

AVERAGING_TIME = 10.0
"""Seconds over which squares are averaged: a few lengths of turbulence at the speeds flown."""

WARM_UP_TIME = 5.0
"""Seconds before anything is said."""

STILL_AIR_ERROR = 0.017
"""Velocity error in m/s, root mean square, of trims held in still air; measured."""

ERROR_PER_WIND = 0.0125
"""Velocity error in m/s, root mean square, for each m/s of wind at 20 ft, flying straight: between what
`benchmarks.flight.turbulence` measures where trims are held, 0.011, and what missions need, whose maneuvers
add to
it.
"""

ERROR_PER_WIND_AND_YAW_RATE = 0.016
"""What is added to that for each rad/s of yaw rate: the mean wind comes from everywhere in turn."""


class TurbulenceMeter:
    """Averages velocity errors.

    Args:
        interval: seconds between two looks.
    """

    def __init__(self, interval: float) -> None:
        self._kept = exp(-interval / AVERAGING_TIME)
        self._interval = interval
        self._looks = 0
        self._square = 0.0

    def update(self, errors: Sequence[float], *, yaw_rate: float) -> None:
        """Takes velocity errors, one for each axis, in m/s, at a yaw rate that is asked for, in rad/s."""
        a_wind = ERROR_PER_WIND + ERROR_PER_WIND_AND_YAW_RATE * abs(yaw_rate)
        square = (sum(error**2 for error in errors) - STILL_AIR_ERROR**2) / a_wind**2
        self._square = self._kept * self._square + (1.0 - self._kept) * square
        self._looks += 1

    @property
    def wind_at_20_ft(self) -> float | None:
        """How hard it blows, in m/s; None where too little was seen."""
        if self._looks * self._interval < WARM_UP_TIME:
            return None
        seen = self._square / (1.0 - self._kept**self._looks)
        return sqrt(max(seen, 0.0))
