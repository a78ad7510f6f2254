"""Table of trim attitude and controls for the feed-forward."""

from functools import cache
from math import inf
from typing import NamedTuple

import casadi as ca

from flight.se2 import Twist
from sim.vehicle.equilibrium import EquilibriumFinder
from sim.vehicle.parameters import Parameters

# From slow backward flight to the end of the speed range, 80 ft/s, in m/s.
_SPEEDS = tuple(float(speed) for speed in range(-2, 26))
# Beyond the fastest turn of the thesis's Table 3, 0.6 rad/s.
_YAW_RATES = tuple(0.15 * i for i in range(-5, 6))
# Steady turns are tabulated up to this sideward acceleration in m/s2, a bank of some 30 degrees.
_CENTRIPETAL_LIMIT = 5.0


class TrimPoint(NamedTuple):
    """Attitude and controls of a trim in still air, rad."""

    roll: float
    pitch: float
    lateral: float
    longitudinal: float
    collective: float
    pedal: float


class TrimTable:
    """Equilibria on a grid, interpolated bilinearly.

    Attributes:
        function: (forward speed in m/s, yaw rate in rad/s), clamped to the table's range -> trim point.
    """

    def __init__(self, parameters: Parameters) -> None:
        finder = EquilibriumFinder(parameters)
        values = [
            number for rate in _YAW_RATES for speed in _SPEEDS for number in _trim_point(finder, speed, rate)
        ]
        table = ca.interpolant("trim_table", "linear", [list(_SPEEDS), list(_YAW_RATES)], values)
        speed, rate = ca.MX.sym("speed"), ca.MX.sym("yaw_rate")
        place = ca.vertcat(_clamp(speed, _SPEEDS), _clamp(rate, _YAW_RATES))
        self.function = ca.Function("trim", [speed, rate], [table(place)])

    def at(self, forward: float, yaw_rate: float) -> TrimPoint:
        """Returns the trim at forward speed (m/s) and yaw rate (rad/s).

        Arguments are clamped to the table's range.
        """
        return TrimPoint._make(self.function(forward, yaw_rate).elements())


@cache
def trim_table(parameters: Parameters) -> TrimTable:
    """Returns the trim table of a vehicle, cached."""
    return TrimTable(parameters)


def _trim_point(finder: EquilibriumFinder, speed: float, yaw_rate: float) -> TrimPoint:
    limit = _CENTRIPETAL_LIMIT / abs(speed) if speed else inf
    found = finder.find(Twist(speed, 0.0, max(-limit, min(limit, yaw_rate))))
    return TrimPoint(
        found.roll, found.pitch, found.lateral, found.longitudinal, found.collective, found.pedal
    )


def _clamp(value: ca.MX, grid: tuple[float, ...]) -> ca.MX:
    """Returns a value clamped to the range of a grid."""
    return ca.fmin(ca.fmax(value, grid[0]), grid[-1])
