"""Mean wind and Dryden turbulence of MIL-F-8785C at low altitude, discretised exactly.

Turbulence axes are fixed to the world: x into the wind (the way the vehicle flies through the air when it
hovers), y to the right of it, z down. The spectra are those of the standard with the airspeed of the moment;
a floor stands in for hover, where a frozen field would never pass. The exact step holds for any airspeed and
any step, so the airspeed may change at every one.
"""

from dataclasses import dataclass
from math import cos, exp, hypot, pi, sin, sqrt

import numpy as np

from flight.errors import FlightError

from .motion import Wind

_FOOT = 0.3048
_KNOT = 1852.0 / 3600.0
# Below this the frozen field is no model of what a hovering rotor meets; in m/s.
AIRSPEED_FLOOR = 4.0
# Range of heights that the low-altitude model states, in m.
_LOWEST, _HIGHEST = 10.0 * _FOOT, 1000.0 * _FOOT
# Random numbers are drawn in blocks of this many periods.
_BLOCK = 512


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
        WindClass("gtmax", 20.0 * _FOOT, 20.0 * _FOOT / 3.0),
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


@dataclass(frozen=True, slots=True)
class Dryden:
    """The standard's turbulence at one height: intensities in m/s, length scales in m (MIL-F-8785C, 3.7.3.4).

    Attributes:
        sigma_horizontal: standard deviation of the gusts along x and y.
        sigma_vertical: standard deviation of the gusts along z.
        length_horizontal: of the gusts along x and y.
        length_vertical: of the gusts along z.
        span: the vehicle's breadth, of which gust rates are made, m.
    """

    sigma_horizontal: float
    sigma_vertical: float
    length_horizontal: float
    length_vertical: float
    span: float

    @property
    def sigma_roll_rate(self) -> float:
        """Standard deviation of the gust roll rate in rad/s; the integral of the standard's spectrum."""
        shape = 0.8 * pi**2 / (8.0 * self.span) * (pi / (4.0 * self.span)) ** (1.0 / 3.0)
        return float(self.sigma_vertical * sqrt(shape) / self.length_vertical ** (1.0 / 3.0))


def dryden(wind_at_20_ft: float, *, height: float, span: float) -> Dryden:
    """Returns the low-altitude model of MIL-F-8785C.

    Args:
        wind_at_20_ft: m/s.
        height: above ground, m; held to 10 to 1000 ft.
        span: breadth of the vehicle, m.
    """
    height_ft = max(_LOWEST, min(_HIGHEST, height)) / _FOOT
    factor = 0.177 + 0.000823 * height_ft
    sigma_vertical = 0.1 * wind_at_20_ft
    return Dryden(
        sigma_horizontal=sigma_vertical / factor**0.4,
        sigma_vertical=sigma_vertical,
        length_horizontal=height_ft / factor**1.2 * _FOOT,
        length_vertical=height_ft * _FOOT,
        span=span,
    )


class LongitudinalGust:
    """Unit gust with the spectrum of the standard's u."""

    def __init__(self, noise: float) -> None:
        self.value = noise

    def step(self, ratio: float, noise: float) -> float:
        """Moves on by `ratio` time constants."""
        keep = exp(-ratio)
        self.value = keep * self.value + sqrt(1.0 - keep * keep) * noise
        return self.value


class LateralGust:
    """Unit gust with the spectrum of the standard's v and w."""

    def __init__(self, noise: tuple[float, float]) -> None:
        # The stationary law: variances 1/2 and 1/4, covariance 1/4.
        self.x0 = sqrt(0.5) * noise[0]
        self.x1 = 0.5 * self.x0 + sqrt(0.125) * noise[1]

    def step(self, ratio: float, noise: tuple[float, float]) -> float:
        """Moves on by `ratio` time constants."""
        e = exp(-ratio)
        e2 = e * e
        q00 = 0.5 * (1.0 - e2)
        q01 = 0.25 * (1.0 - e2 * (1.0 + 2.0 * ratio))
        q11 = 0.25 * (1.0 - e2 * (1.0 + 2.0 * ratio + 2.0 * ratio * ratio))
        l00 = sqrt(q00)
        l10 = q01 / l00
        l11 = sqrt(max(0.0, q11 - l10 * l10))
        x0 = self.x0
        self.x0 = e * x0 + l00 * noise[0]
        self.x1 = e * self.x1 + ratio * e * x0 + l10 * noise[0] + l11 * noise[1]
        return self.value

    @property
    def value(self) -> float:
        """The gust now, in units of its standard deviation."""
        return sqrt(3.0) * self.x0 + (1.0 - sqrt(3.0)) * self.x1


class _Slope:
    """The standard's pitch and yaw gust: the slope along x of a gust, smoothed over the span.

    It begins without slope; it remembers for a second, which the settling time before a flight covers.
    """

    def __init__(self, value: float) -> None:
        self._smooth = value

    def step(self, ratio: float, value: float) -> float:
        """Returns gust less smoothed gust; to be divided by the smoothing length."""
        self._smooth = value + (self._smooth - value) * exp(-ratio)
        return value - self._smooth


class DrydenWind:
    """The air's motion at the vehicle, period by period.

    Args:
        wind: wind class.
        height: above ground, m.
        span: breadth of the vehicle, m.
        direction: where the mean wind comes from, rad clockwise from north; drawn where None.
        step: period in s.
        rng: source of all its chance.
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
    ) -> None:
        self._model = dryden(wind.wind_at_20_ft, height=height, span=span)
        drawn = float(rng.uniform(-pi, pi))
        self._direction = drawn if direction is None else direction
        self._sigma_roll_rate = self._model.sigma_roll_rate
        self._mean_wind, self._step, self._rng = wind.mean_wind, step, rng
        self._still = wind.wind_at_20_ft == 0.0
        first = rng.standard_normal(6).tolist()
        self._u = LongitudinalGust(first[0])
        self._v, self._w = LateralGust((first[1], first[2])), LateralGust((first[3], first[4]))
        self._p = LongitudinalGust(first[5])
        self._v_slope, self._w_slope = _Slope(self._v.value), _Slope(self._w.value)
        self._noise = rng.standard_normal((_BLOCK, 6)).tolist()
        self._row = 0
        self._axes = (0.0, 0.0)
        self.turn(0.0)

    @property
    def direction(self) -> float:
        """Where the mean wind comes from, rad clockwise from north."""
        return self._direction

    @property
    def mean(self) -> Wind:
        """The mean wind alone."""
        c, s = self._axes
        return Wind(-c * self._mean_wind, -s * self._mean_wind, 0.0, 0.0, 0.0, 0.0)

    def turn(self, angle: float) -> None:
        """Follows a turn of the whole world about the vertical, in rad."""
        self._direction += angle
        self._axes = (cos(self._direction), sin(self._direction))

    def step(self, *, velocity_north: float, velocity_east: float) -> Wind:
        """Moves on by one period.

        Args:
            velocity_north: velocity of the vehicle over the ground, m/s.
            velocity_east: likewise.
        """
        mean = self.mean
        if self._still:
            return mean
        model = self._model
        airspeed = max(AIRSPEED_FLOOR, hypot(velocity_north - mean.north, velocity_east - mean.east))
        travelled = airspeed * self._step
        n = self._next_noise()
        u = model.sigma_horizontal * self._u.step(travelled / model.length_horizontal, n[0])
        v = model.sigma_horizontal * self._v.step(travelled / model.length_horizontal, (n[1], n[2]))
        w = model.sigma_vertical * self._w.step(travelled / model.length_vertical, (n[3], n[4]))
        # Smoothing lengths of the standard: 4 b / pi for roll and pitch, 3 b / pi for yaw.
        long, short = 4.0 * model.span / pi, 3.0 * model.span / pi
        p = self._sigma_roll_rate * self._p.step(travelled / long, n[5])
        q = self._w_slope.step(travelled / long, w) / long
        r = -self._v_slope.step(travelled / short, v) / short
        c, s = self._axes
        return Wind(mean.north + c * u - s * v, mean.east + s * u + c * v, w, c * p - s * q, s * p + c * q, r)

    def _next_noise(self) -> list[float]:
        if self._row == _BLOCK:
            self._noise = self._rng.standard_normal((_BLOCK, 6)).tolist()
            self._row = 0
        row: list[float] = self._noise[self._row]
        self._row += 1
        return row
