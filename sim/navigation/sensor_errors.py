"""Sizes of the sensors' errors."""

from dataclasses import dataclass
from math import radians

import casadi as ca

# Height in m below which the more accurate altimeter is used.
_LOW = 3.0


@dataclass(frozen=True, slots=True)
class GaussMarkovError:
    """Gauss-Markov error: standard deviation and correlation time in s."""

    sigma: float
    time: float


@dataclass(frozen=True, slots=True)
class SensorErrors:
    """Standard deviations of the sensors' errors, SI units.

    Attributes:
        accelerometer_noise: each axis, over one control period, m/s2.
        accelerometer_bias: each axis, m/s2.
        gyro_noise: each axis, over one control period, rad/s.
        gyro_bias: each axis, rad/s.
        position_noise: white position noise of a fix, north, east, down, m.
        position_drift: drift of the fixes' position, each axis, m.
        velocity_noise: white velocity noise of a fix, each axis, m/s.
        fix_periods: control periods between two fixes.
        fix_latency: age of a fix on arrival, control periods.
        antenna: position from the centre of mass, forward, right, down, m.
        heading_noise: white noise of the magnetometer, rad.
        heading_drift: drift of the magnetometer, rad.
        height_noise: white noise of the altimeter, m.
        low_height_noise: white noise of the altimeter near the ground, m.
        slow_periods: control periods between readings of magnetometer and altimeter.
    """

    accelerometer_noise: float = 0.05
    accelerometer_bias: GaussMarkovError = GaussMarkovError(0.03, 300.0)
    gyro_noise: float = radians(0.2)
    gyro_bias: GaussMarkovError = GaussMarkovError(radians(0.05), 300.0)
    position_noise: tuple[float, float, float] = (0.02, 0.02, 0.03)
    position_drift: GaussMarkovError = GaussMarkovError(0.03, 60.0)
    velocity_noise: float = 0.03
    fix_periods: int = 10
    fix_latency: int = 5
    antenna: tuple[float, float, float] = (-1.0, 0.0, -0.2)
    heading_noise: float = radians(1.5)
    heading_drift: GaussMarkovError = GaussMarkovError(radians(1.5), 120.0)
    height_noise: float = 0.3
    low_height_noise: float = 0.05
    slow_periods: int = 10

    @property
    def drifts(self) -> tuple[GaussMarkovError, ...]:
        """Gauss-Markov errors: accelerometers, gyros, fixes (three each), heading."""
        biases = (self.accelerometer_bias,) * 3 + (self.gyro_bias,) * 3
        return (*biases, *(self.position_drift,) * 3, self.heading_drift)

    @property
    def inertial_noise(self) -> tuple[float, ...]:
        """White noise of accelerometers and gyros."""
        return (self.accelerometer_noise,) * 3 + (self.gyro_noise,) * 3

    @property
    def fix_noise(self) -> tuple[float, ...]:
        """White noise of a fix's position and velocity."""
        return (*self.position_noise, *(self.velocity_noise,) * 3)

    def height_sigma(self, height: ca.SX) -> ca.SX:
        """Returns the altimeter's standard deviation at a height, m."""
        return ca.if_else(height > _LOW, self.height_noise, self.low_height_noise)
