"""Mean wind with turbulence at the vehicle, period by period."""

from math import cos, pi, sin

import numpy as np

from sim.loop.backend import Backend
from sim.loop.bound_function import Recursion
from sim.loop.motion import Motion, Wind
from sim.loop.noise import Noise
from sim.loop.signals import Signals

from .dryden import MeanWind, Turbulence, draw_turbulence, dryden, wind_function
from .wind_class import WindClass

# Direction of the gusts' axes in the memory.
_AXES = slice(Turbulence._fields.index("axis_north"), None)


class DrydenWind:
    """Wind and turbulence at the vehicle, period by period.

    Args:
        wind: wind class.
        height: height above ground at the start, and in `step`, m.
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
        self._height, self._wind_at_20_ft = height, wind.wind_at_20_ft
        self._still = wind.wind_at_20_ft == 0.0
        self._mean, noise = np.zeros(len(MeanWind._fields)), np.zeros(6)
        self._memory = draw_turbulence(model, rng.standard_normal(6).tolist(), direction=self._direction)
        self._gusts = Recursion(
            wind_function(span, step),
            (signals.truth, noise, self._mean, self._memory),
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
        self._mean[:] = (self._wind_at_20_ft, cos(self._direction), sin(self._direction))
        if angle:
            c, s = cos(angle), sin(angle)
            north, east = self._memory[_AXES].tolist()
            self._memory[_AXES] = (c * north - s * east, s * north + c * east)

    def run(self) -> None:
        """Advances the air by one period."""
        if self._still:
            self.signals.wind[:] = 0.0
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
        self.signals.truth[:] = truth._replace(down=-self._height, forward=velocity_north, side=velocity_east)
        self.run()
        return Wind._make(self.signals.wind.tolist())
