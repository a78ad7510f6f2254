"""Mean wind and turbulence: how hard it blows in a wind class, and the air of a flight, period by period.

Turbulence axes are fixed to the world: x into the wind (the way the vehicle flies through the air when it
hovers), y to the right of it, z down.
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
    """How hard it blows.

    Attributes:
        name: as missions, sequences and libraries call it.
        wind_at_20_ft: the standard's measure of turbulence, m/s.
        mean_wind: at the flight's height, m/s.
    """

    name: str
    wind_at_20_ft: float
    mean_wind: float


# The standard ties turbulence to the wind at 20 ft: 15, 30, 45 kt are light, moderate, severe. The mean wind
# flown is a third of it, chosen: at 30 m over open ground it would be 1.3 times, and a vehicle held to ground
# velocities of 1 and 3 m/s would mostly be flying sideways through the air. `gtmax` has the size of the
# thesis's Table 9.
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
    """A wind class was named that does not exist."""

    def __init__(self, name: str) -> None:
        super().__init__(f"no wind class {name!r}; there are {list(WIND_CLASSES)}")


def wind_class(name: str) -> WindClass:
    """Returns a wind class by its name.

    Raises:
        UnknownWindError: there is none of that name.
    """
    try:
        return WIND_CLASSES[name]
    except KeyError:
        raise UnknownWindError(name) from None


class DrydenWind:
    """The air's motion at the vehicle, period by period.

    Args:
        wind: wind class.
        height: above ground, m.
        span: breadth of the vehicle, m.
        direction: where the mean wind comes from, rad clockwise from north; drawn where None.
        step: period in s.
        rng: source of all its chance.
        signals: where it finds the vehicle's true motion and leaves the wind; its own where None.
        backend: what evaluates the gusts.
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
        """Where the mean wind comes from, rad clockwise from north."""
        return self._direction

    def rotate_world(self, angle: float) -> None:
        """Follows a turn of the whole world about the vertical, in rad."""
        self._direction += angle
        c, s = cos(self._direction), sin(self._direction)
        self._mean[:] = (-c * self._speed, -s * self._speed, c, s)

    def run(self) -> None:
        """Moves the air on by one period."""
        if self._still:
            self.signals.wind[:] = (*self._mean[:2], 0.0, 0.0, 0.0, 0.0)
            return
        self._noise.next()
        self._gusts.step()

    def step(self, *, velocity_north: float, velocity_east: float) -> Wind:
        """Moves on by one period.

        Args:
            velocity_north: velocity of the vehicle over the ground, m/s.
            velocity_east: likewise.
        """
        truth = Motion._make([0.0] * len(Motion._fields))
        self.signals.truth[:] = truth._replace(forward=velocity_north, side=velocity_east)
        self.run()
        return Wind._make(self.signals.wind.tolist())
