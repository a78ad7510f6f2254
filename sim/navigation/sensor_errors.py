"""Sizes of the sensors' errors, by class, read from `models/gtmax.toml`."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from math import hypot, sqrt
from pathlib import Path

import casadi as ca
from pydantic import NonNegativeFloat, PositiveFloat, PositiveInt

import models
from flight.errors import FlightError
from flight.file_value import FileValue
from flight.schema import parse_json, refusing, toml_table

# Height in m below which the more accurate altimeter is used.
_LOW = 3.0
# Yaw rate of the fastest trims, rad/s: a scale factor error is a bias of this size there.
_TURNING = 0.3
# Seconds in which the heading, and so the magnetometer's deviation, changes in a turn.
_DEVIATION_TIME = 20.0
NOISE, SYSTEMATIC = "noise", "systematic"
"""Parts of a class's errors, for studies: `rtk-noise` has white noise alone, `rtk-systematic` none."""


class UnknownSensorsError(FlightError):
    """Name of a sensor class that does not exist."""

    def __init__(self, name: str) -> None:
        super().__init__(f"no sensor class {name!r}; there are {sorted(sensor_classes())}")


@dataclass(frozen=True, slots=True)
class GaussMarkovError(FileValue):
    """Gauss-Markov error: standard deviation and correlation time in s."""

    sigma: NonNegativeFloat
    time: PositiveFloat


@dataclass(frozen=True, slots=True)
class SensorErrors(FileValue):
    """Standard deviations of the sensors' errors, SI units.

    Attributes:
        accelerometer_noise: each axis, over one control period, m/s2.
        accelerometer_bias: each axis, m/s2.
        vibration: amplitude of the accelerometers' vibration at the blade passing frequency, m/s2.
        gyro_noise: each axis, over one control period, rad/s.
        gyro_bias: each axis, rad/s.
        gyro_scale: scale factor of each axis.
        misalignment: of the inertial unit about each body axis, rad.
        position_noise: white position noise of a fix, north, east, down, m.
        position_drift: wander of the fixes' position, each axis, m.
        velocity_noise: white velocity noise of a fix, each axis, m/s.
        fix_periods: control periods between two fixes.
        fix_latency: age of a fix on arrival, control periods.
        antenna: position from the nominal centre of mass, forward, right, down, m.
        heading_noise: white noise of the magnetometer, rad.
        heading_drift: drift of the magnetometer, rad.
        heading_deviation: sine and cosine of heading and twice the heading in the deviation, each, rad.
        height_noise: white noise of the altimeter, m.
        low_height_noise: white noise of the altimeter near the ground, m.
        slow_periods: control periods between readings of magnetometer and altimeter.
    """

    accelerometer_noise: NonNegativeFloat
    accelerometer_bias: GaussMarkovError
    vibration: NonNegativeFloat
    gyro_noise: NonNegativeFloat
    gyro_bias: GaussMarkovError
    gyro_scale: NonNegativeFloat
    misalignment: NonNegativeFloat
    position_noise: tuple[NonNegativeFloat, NonNegativeFloat, NonNegativeFloat]
    position_drift: GaussMarkovError
    velocity_noise: NonNegativeFloat
    fix_periods: PositiveInt
    fix_latency: int
    antenna: tuple[float, float, float]
    heading_noise: NonNegativeFloat
    heading_drift: GaussMarkovError
    heading_deviation: NonNegativeFloat
    height_noise: NonNegativeFloat
    low_height_noise: NonNegativeFloat
    slow_periods: PositiveInt

    @property
    def drifts(self) -> tuple[GaussMarkovError, ...]:
        """Gauss-Markov errors: accelerometers, gyros, fixes (three each), heading."""
        biases = (self.accelerometer_bias,) * 3 + (self.gyro_bias,) * 3
        return (*biases, *(self.position_drift,) * 3, self.heading_drift)

    @property
    def believed_drifts(self) -> tuple[GaussMarkovError, ...]:
        """Gauss-Markov errors of the filter, enlarged by unmodelled ones."""
        gyro = replace(self.gyro_bias, sigma=hypot(self.gyro_bias.sigma, _TURNING * self.gyro_scale))
        # Four terms, each of mean square one half.
        deviation = sqrt(2.0) * self.heading_deviation
        heading = self.heading_drift
        if deviation:
            time = min(heading.time, _DEVIATION_TIME)
            heading = GaussMarkovError(hypot(heading.sigma, deviation), time)
        biases = (self.accelerometer_bias,) * 3 + (gyro,) * 3
        return (*biases, *(self.position_drift,) * 3, heading)

    @property
    def inertial_noise(self) -> tuple[float, ...]:
        """White noise of accelerometers and gyros."""
        return (self.accelerometer_noise,) * 3 + (self.gyro_noise,) * 3

    @property
    def fix_noise(self) -> tuple[float, ...]:
        """White noise of a fix's position and velocity."""
        return (*self.position_noise, *(self.velocity_noise,) * 3)

    @property
    def position_sigma(self) -> float:
        """Standard deviation of a fix, north or east, m."""
        return hypot(self.position_drift.sigma, self.position_noise[0])

    @property
    def heading_sigma(self) -> float:
        """Standard deviation of the heading that no averaging removes, rad."""
        return hypot(self.believed_drifts[-1].sigma, self.misalignment)

    def height_sigma(self, height: ca.SX) -> ca.SX:
        """Returns the altimeter's standard deviation at a height, m."""
        return ca.if_else(height > _LOW, self.height_noise, self.low_height_noise)

    def only_noise(self) -> "SensorErrors":
        """Returns the white noise alone."""
        return replace(
            self,
            accelerometer_bias=replace(self.accelerometer_bias, sigma=0.0),
            gyro_bias=replace(self.gyro_bias, sigma=0.0),
            position_drift=replace(self.position_drift, sigma=0.0),
            heading_drift=replace(self.heading_drift, sigma=0.0),
            gyro_scale=0.0,
            misalignment=0.0,
            heading_deviation=0.0,
            vibration=0.0,
        )

    def without_noise(self) -> "SensorErrors":
        """Returns everything but the white noise."""
        return replace(
            self,
            accelerometer_noise=0.0,
            gyro_noise=0.0,
            position_noise=(0.0, 0.0, 0.0),
            velocity_noise=0.0,
            heading_noise=0.0,
            height_noise=0.0,
            low_height_noise=0.0,
        )


@cache
def sensor_classes(path: Path | None = None) -> Mapping[str, SensorErrors]:
    """Returns the sensor classes of a vehicle file by name.

    Args:
        path: file in the format of `models/gtmax.toml`, the default.

    Raises:
        BadFileError: there are none, or a value is missing or invalid.
    """
    path = path or models.FOLDER / "gtmax.toml"
    content = toml_table(path)
    with refusing(path):
        if not content.get("sensors"):
            raise ValueError("expected tables sensors.NAME, got none")
    return {
        name: parse_json(json.dumps(table), path, SensorErrors) for name, table in content["sensors"].items()
    }


def sensor_errors(name: str) -> tuple[SensorErrors, SensorErrors]:
    """Returns believed and actual errors of a class by name.

    Raises:
        UnknownSensorsError: it does not exist.
    """
    family, _, part = name.partition("-")
    try:
        errors = sensor_classes()[family]
        made = {"": errors, NOISE: errors.only_noise(), SYSTEMATIC: errors.without_noise()}[part]
    except KeyError:
        raise UnknownSensorsError(name) from None
    return errors, made
