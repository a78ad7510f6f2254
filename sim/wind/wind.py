"""Wind classes, and mean wind with turbulence at the vehicle.

Turbulence axes are fixed to the world: x into the wind (the direction of flight through the air in hover), y
to the right of it, z down.
"""

from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np

from flight.errors import FlightError
from flight.units import FOOT
from sim.loop.backend import Backend
from sim.loop.bound_function import Recursion
from sim.loop.motion import Motion, Wind
from sim.loop.noise import Noise
from sim.loop.signals import Signals

from .dryden import draw_turbulence, dryden, wind_function

_KNOT = 1852.0 / 3600.0


@dataclass(frozen=True, slots=True)
class WindClass:
    """Wind class: turbulence and mean wind.

    Attributes:
        name: name in missions, sequences and libraries.
        wind_at_20_ft: wind at 20 ft, the standard's measure of turbulence, m/s.
        mean_wind: mean wind at the flight's height, m/s.
    """

    name: str
    wind_at_20_ft: float
    mean_wind: float


# Turbulence depends on the wind at 20 ft: 15, 30, 45 kt are light, moderate, severe. The mean wind is chosen
# as a third of it: at 30 m over open ground it would be 1.3 times, and a vehicle at ground speeds of 1 and
# 3 m/s would mostly fly sideways through the air. `gtmax` corresponds to the thesis's Table 9.
WIND_CLASSES = {
    wind.name: wind
    for wind in (
        WindClass("calm", 0.0, 0.0),
        WindClass("gtmax", 20.0 * FOOT, 20.0 * FOOT / 3.0),
        WindClass("light", 15.0 * _KNOT, 5.0 * _KNOT),
        WindClass("moderate", 30.0 * _KNOT, 10.0 * _KNOT),
        WindClass("severe", 45.0 * _KNOT, 15.0 * _KNOT),
    )
}


class UnknownWindError(FlightError):
    """Name of a wind class that does not exist."""

    def __init__(self, name: str) -> None:
        super().__init__(f"no wind class {name!r}; there are {list(WIND_CLASSES)}")


def wind_class(name: str) -> WindClass:
    """Returns a wind class by name.

    Raises:
        UnknownWindError: it does not exist.
    """
    try:
        return WIND_CLASSES[name]
    except KeyError:
        raise UnknownWindError(name) from None


class DrydenWind:
    """Wind and turbulence at the vehicle, period by period.

    Args:
        wind: wind class.
        height: height above ground, m.
        span: span of the vehicle, m.
        direction: direction of origin of the mean wind, rad clockwise from north; random if None.
        step: period, s.
        rng: random generator.
        signals: input true motion, output wind; its own if None.
        backend: numeric back-end.
    """

    def __init__(
        self,
        wind: WindClass,
        *,
        height: float,
        span: float,
        direction: float | None,
        step: float,
        rng: np.random.Generator,
        signals: Signals | None = None,
        backend: Backend = Backend.INTERPRETED,
    ) -> None:
        self.signals = signals = signals or Signals()
        model = dryden(wind.wind_at_20_ft, height=height, span=span)
        drawn = float(rng.uniform(-pi, pi))
        self._direction = drawn if direction is None else direction
        self._speed = wind.mean_wind
        self._still = wind.wind_at_20_ft == 0.0
        self._mean, noise = np.zeros(4), np.zeros(6)
        memory = draw_turbulence(model, rng.standard_normal(6).tolist())
        self._gusts = Recursion(
            wind_function(model, step),
            (signals.truth, noise, self._mean, memory),
            (signals.wind,),
            backend=backend,
        )
        self._noise = Noise(noise, lambda periods: rng.standard_normal((periods, len(noise))))
        self.rotate_world(0.0)

    @property
    def direction(self) -> float:
        """Direction of origin of the mean wind, rad clockwise from north."""
        return self._direction

    def rotate_world(self, angle: float) -> None:
        """Applies a rotation of the world about the vertical, in rad."""
        self._direction += angle
        c, s = cos(self._direction), sin(self._direction)
        self._mean[:] = (-c * self._speed, -s * self._speed, c, s)

    def run(self) -> None:
        """Advances the air by one period."""
        if self._still:
            self.signals.wind[:] = (*self._mean[:2], 0.0, 0.0, 0.0, 0.0)
            return
        self._noise.next()
        self._gusts.step()

    def step(self, *, velocity_north: float, velocity_east: float) -> Wind:
        """Returns the wind after one period.

        Args:
            velocity_north: north velocity of the vehicle over the ground, m/s.
            velocity_east: east velocity of the vehicle over the ground, m/s.
        """
        truth = Motion._make([0.0] * len(Motion._fields))
        self.signals.truth[:] = truth._replace(forward=velocity_north, side=velocity_east)
        self.run()
        return Wind._make(self.signals.wind.tolist())
