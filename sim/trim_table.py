"""Attitude and controls of level flight over speed and yaw rate, for the controller's feed-forward."""

from functools import cache
from math import inf
from typing import NamedTuple

from flight.se2 import Twist

from .equilibrium import EquilibriumFinder
from .parameters import Parameters

# From slow backward flight to the end of the speed range, 80 ft/s; in m/s.
_SPEEDS = tuple(float(speed) for speed in range(-2, 26))
# Beyond the fastest turn of the thesis's Table 3, 0.6 rad/s.
_YAW_RATES = tuple(0.15 * i for i in range(-5, 6))
# Steady turns are tabulated up to this sideward acceleration in m/s2, a bank of some 30 degrees.
_CENTRIPETAL_LIMIT = 5.0


class TrimPoint(NamedTuple):
    """Attitude and controls in rad that hold a velocity in still air."""

    roll: float
    pitch: float
    lateral: float
    longitudinal: float
    collective: float
    pedal: float


class TrimTable:
    """Equilibria on a grid, read between the points by bilinear interpolation."""

    def __init__(self, parameters: Parameters) -> None:
        finder = EquilibriumFinder(parameters)
        self._rows = tuple(tuple(_point(finder, speed, rate) for rate in _YAW_RATES) for speed in _SPEEDS)

    def at(self, forward: float, yaw_rate: float) -> TrimPoint:
        """Returns the trim at a forward speed in m/s and a yaw rate in rad/s, held to the table's range."""
        i, x = _locate(_SPEEDS, forward)
        j, y = _locate(_YAW_RATES, yaw_rate)
        low, high = self._rows[i], self._rows[i + 1]
        a, b, c, d = (1.0 - x) * (1.0 - y), (1.0 - x) * y, x * (1.0 - y), x * y
        return TrimPoint._make(
            [
                a * p + b * q + c * r + d * s
                for p, q, r, s in zip(low[j], low[j + 1], high[j], high[j + 1], strict=True)
            ]
        )


@cache
def trim_table(parameters: Parameters) -> TrimTable:
    """Returns the table of a vehicle, made once in a process."""
    return TrimTable(parameters)


def _point(finder: EquilibriumFinder, speed: float, yaw_rate: float) -> TrimPoint:
    limit = _CENTRIPETAL_LIMIT / abs(speed) if speed else inf
    found = finder.find(Twist(speed, 0.0, max(-limit, min(limit, yaw_rate))))
    return TrimPoint(
        found.roll, found.pitch, found.lateral, found.longitudinal, found.collective, found.pedal
    )


def _locate(grid: tuple[float, ...], value: float) -> tuple[int, float]:
    """Returns the cell of an even grid that a value lies in and its place in it, from 0 to 1."""
    along = (value - grid[0]) / (grid[1] - grid[0])
    along = max(0.0, min(len(grid) - 1.0, along))
    cell = min(int(along), len(grid) - 2)
    return cell, along - cell
