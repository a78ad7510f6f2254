"""What the sensors read: inertial unit, GPS with an antenna on the boom, magnetometer and altimeter.

Every reading is the truth with white noise and, where stated, an error that wanders (Gauss-Markov: standard
deviation and correlation time). The inertial unit gives the mean over a control period.
"""

from collections import deque
from dataclasses import dataclass
from math import exp, radians, sqrt
from typing import NamedTuple

import numpy as np

from flight.se2 import SE2

from .bound_function import BoundFunction
from .filter_equations import ideal_readings
from .motion import Motion

_BLOCK = 512
# Below this height in m the altimeter is the better one of two.
_LOW = 3.0


@dataclass(frozen=True, slots=True)
class Wander:
    """A Gauss-Markov error: standard deviation in the unit of what it spoils, correlation time in s."""

    sigma: float
    time: float


@dataclass(frozen=True, slots=True)
class SensorErrors:
    """One-sigma errors of the sensors; SI.

    Attributes:
        accelerometer_noise: each axis, over one control period, m/s2.
        accelerometer_bias: each axis, m/s2.
        gyro_noise: each axis, over one control period, rad/s.
        gyro_bias: each axis, rad/s.
        position_noise: of a fix, north, east, down, m.
        position_wander: of a fix, each axis, m.
        velocity_noise: of a fix, each axis, m/s.
        fix_periods: control periods between two fixes.
        fix_latency: age of a fix when it arrives, control periods.
        antenna: forward, right, down of the centre of mass, m.
        heading_noise: of the magnetometer, rad.
        heading_wander: of the same, rad.
        height_noise: of the altimeter, m.
        low_height_noise: of the same near the ground, m.
        slow_periods: control periods between readings of magnetometer and altimeter.
    """

    accelerometer_noise: float = 0.05
    accelerometer_bias: Wander = Wander(0.03, 300.0)
    gyro_noise: float = radians(0.2)
    gyro_bias: Wander = Wander(radians(0.05), 300.0)
    position_noise: tuple[float, float, float] = (0.02, 0.02, 0.03)
    position_wander: Wander = Wander(0.03, 60.0)
    velocity_noise: float = 0.03
    fix_periods: int = 10
    fix_latency: int = 5
    antenna: tuple[float, float, float] = (-1.0, 0.0, -0.2)
    heading_noise: float = radians(1.5)
    heading_wander: Wander = Wander(radians(1.5), 120.0)
    height_noise: float = 0.3
    low_height_noise: float = 0.05
    slow_periods: int = 10

    def height_variance(self, height: float) -> float:
        """Returns the variance of a height that was read, m2."""
        return (self.height_noise if height > _LOW else self.low_height_noise) ** 2


class Readings(NamedTuple):
    """What is read in a control period; None where a sensor is silent.

    Attributes:
        inertial: specific force (m/s2) and body rates (rad/s), mean over the period that ends.
        fix: antenna position (m) and velocity (m/s) in the world, as they were a latency ago.
        heading: rad, not wrapped.
        height: m above ground.
    """

    inertial: np.ndarray
    fix: np.ndarray | None
    heading: float | None
    height: float | None


class Sensors:
    """Reads a vehicle's motion, period by period.

    Args:
        errors: their sizes.
        truth: motion at the start.
        step: control period in s.
        gravity: m/s2.
        rng: source of all their chance.
    """

    def __init__(
        self, errors: SensorErrors, truth: Motion, *, step: float, gravity: float, rng: np.random.Generator
    ) -> None:
        self._errors, self._rng = errors, rng
        wanders = (
            *(errors.accelerometer_bias,) * 3,
            *(errors.gyro_bias,) * 3,
            *(errors.position_wander,) * 3,
            errors.heading_wander,
        )
        sigma = np.array([wander.sigma for wander in wanders])
        self._keep = np.array([exp(-step / wander.time) for wander in wanders])
        self._drive = sigma * np.sqrt(1.0 - self._keep**2)
        self._wandering = sigma * rng.standard_normal(10)
        self._white = np.array(
            [errors.accelerometer_noise] * 3
            + [errors.gyro_noise] * 3
            + [*errors.position_noise]
            + [errors.velocity_noise] * 3
            + [errors.heading_noise, 1.0]
        )
        self._before, self._now, self._ideal = np.zeros(13), np.array(truth), np.zeros(12)
        self._observe = BoundFunction(
            ideal_readings(step, gravity, errors.antenna), (self._before, self._now), (self._ideal,)
        )
        self._fixes: deque[np.ndarray] = deque(maxlen=errors.fix_latency + 1)
        self._turned = 0.0
        self._period, self._row = 0, _BLOCK

    @property
    def biases(self) -> np.ndarray:
        """Errors of accelerometers and gyros that wander, as they are: what a filter looks for."""
        return np.asarray(self._slow[:6])

    def move(self, displacement: SE2, truth: Motion) -> None:
        """Follows a motion of the whole world, after which the truth is `truth`."""
        self._now[:] = truth
        self._turned += displacement.heading
        for fix in self._fixes:
            pose = displacement @ SE2(fix[0], fix[1], 0.0)
            velocity = SE2(0.0, 0.0, displacement.heading) @ SE2(fix[3], fix[4], 0.0)
            fix[:2], fix[3:5] = (pose.x, pose.y), (velocity.x, velocity.y)

    def read(self, truth: Motion) -> Readings:
        """Returns what is read at the end of a control period."""
        self._before[:] = self._now
        self._now[:] = truth
        self._observe.evaluate()
        if self._row == _BLOCK:
            self._draw_block()
        self._slow, white = self._slows[self._row], self._whites[self._row]
        self._row += 1
        self._period += 1
        errors, slow = self._errors, self._slow
        self._fixes.append(self._ideal[6:] + white[6:12])
        fix = None
        if self._period % errors.fix_periods == 0 and len(self._fixes) > errors.fix_latency:
            fix = self._fixes[0].copy()
            wander = SE2(0.0, 0.0, self._turned) @ SE2(slow[6], slow[7], 0.0)
            fix[:3] += (wander.x, wander.y, slow[8])
        heading = height = None
        if self._period % errors.slow_periods == 0:
            heading = truth.heading + float(slow[9] + white[12])
            height = -truth.down + sqrt(errors.height_variance(-truth.down)) * float(white[13])
        return Readings(self._ideal[:6] + slow[:6] + white[:6], fix, heading, height)

    def _draw_block(self) -> None:
        """Draws the errors of many periods at once; the same bytes as period by period."""
        driven = self._drive * self._rng.standard_normal((_BLOCK, 10))
        self._whites = self._white * self._rng.standard_normal((_BLOCK, 14))
        for row in driven:
            self._wandering = self._keep * self._wandering + row
            row[:] = self._wandering
        self._slows, self._row = driven, 0
