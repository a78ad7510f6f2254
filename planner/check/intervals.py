"""Interval arithmetic, rounded outward: every true result lies between `low` and `high`.

The four operations and the square root are correctly rounded by IEEE 754, so the next number outward is a
bound; sine and cosine are taken to be within 4 units in the last place of 1, which every common library
keeps [1].
Numbers that are no intervals count as exact. Arrays broadcast as in NumPy.

[1] Gladman, Innocente, Mather, Zimmermann, Accuracy of Mathematical Functions in Single, Double, Extended
Double and Quadruple Precision, 2024, table 2: below 1 unit for every sine and cosine of the common libraries.
"""

from dataclasses import dataclass
from typing import Any, Self, TypeAlias

import numpy as np
from jaxtyping import Bool, Float

Array = Float[np.ndarray, "..."]
Operand: TypeAlias = "Interval | Array | float"

LIBRARY_ERROR = 4 * 2.0**-52
"""Error bound of a sine or cosine."""

LARGEST_ANGLE = 1e6
"""Radians up to which the reduction modulo 2 pi is trusted; beyond, a sine is anything from -1 to 1."""


def _round_down(value: Array) -> Array:
    lower: Array = np.nextafter(value, -np.inf)
    return lower


def _round_up(value: Array) -> Array:
    upper: Array = np.nextafter(value, np.inf)
    return upper


@dataclass(frozen=True, slots=True, eq=False)
class Interval:
    """All numbers from `low` to `high`, elementwise."""

    low: Array
    high: Array

    # NumPy leaves an operation between an array and an interval to the interval.
    __array_ufunc__ = None

    @classmethod
    def of(cls, low: Array | float, high: Array | float | None = None) -> Self:
        """Returns the interval between two numbers, or of one alone."""
        lower = np.asarray(low, dtype=float)
        return cls(lower, lower if high is None else np.asarray(high, dtype=float))

    @property
    def middle(self) -> Array:
        """A number inside, near the middle."""
        inside: Array = 0.5 * (self.low + self.high)
        return inside

    @property
    def width(self) -> Array:
        """The distance from low to high, rounded up."""
        return _round_up(self.high - self.low)

    @property
    def magnitude(self) -> Array:
        """The largest absolute value."""
        largest: Array = np.maximum(np.abs(self.low), np.abs(self.high))
        return largest

    def __getitem__(self, index: Any) -> "Interval":
        """Returns some of the intervals, as NumPy indexes."""
        return Interval(np.asarray(self.low[index]), np.asarray(self.high[index]))

    def contains(self, value: Array | float) -> Bool[np.ndarray, "..."]:
        """Returns True where a number lies inside."""
        return np.asarray((self.low <= value) & (value <= self.high))

    def hull(self, other: Operand) -> "Interval":
        """Returns the smallest interval around both."""
        wide = as_interval(other)
        return Interval(np.minimum(self.low, wide.low), np.maximum(self.high, wide.high))

    def __neg__(self) -> "Interval":
        """Returns the negatives, exactly."""
        return Interval(-self.high, -self.low)

    def __add__(self, other: Operand) -> "Interval":
        """Returns sums, rounded outward."""
        term = as_interval(other)
        return Interval(_round_down(self.low + term.low), _round_up(self.high + term.high))

    def __sub__(self, other: Operand) -> "Interval":
        """Returns differences, rounded outward."""
        return self + -as_interval(other)

    def __mul__(self, other: Operand) -> "Interval":
        """Returns products, rounded outward."""
        factor = as_interval(other)
        products = (
            self.low * factor.low,
            self.low * factor.high,
            self.high * factor.low,
            self.high * factor.high,
        )
        return Interval(_round_down(np.minimum.reduce(products)), _round_up(np.maximum.reduce(products)))

    def __truediv__(self, other: Operand) -> "Interval":
        """Returns quotients, rounded outward; the whole line for divisors containing 0."""
        divisor = as_interval(other)
        through_zero = divisor.contains(0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            quotients = (
                self.low / divisor.low,
                self.low / divisor.high,
                self.high / divisor.low,
                self.high / divisor.high,
            )
            low, high = np.minimum.reduce(quotients), np.maximum.reduce(quotients)
        return Interval(
            _round_down(np.where(through_zero, -np.inf, low)), _round_up(np.where(through_zero, np.inf, high))
        )

    def __radd__(self, other: Array | float) -> "Interval":
        """Returns sums, rounded outward."""
        return self + other

    def __rsub__(self, other: Array | float) -> "Interval":
        """Returns differences, rounded outward."""
        return as_interval(other) - self

    def __rmul__(self, other: Array | float) -> "Interval":
        """Returns products, rounded outward."""
        return self * other

    def __rtruediv__(self, other: Array | float) -> "Interval":
        """Returns quotients, rounded outward."""
        return as_interval(other) / self


def as_interval(value: Operand) -> Interval:
    """Returns the zero-width interval of a number."""
    return value if isinstance(value, Interval) else Interval.of(value)


TURN = Interval.of(_round_down(np.array(2 * np.pi)), _round_up(np.array(2 * np.pi)))
"""Enclosure of 2 pi."""


def square(value: Interval) -> Interval:
    """Returns the squares, none of them negative."""
    small = np.where(value.contains(0.0), 0.0, np.minimum(np.abs(value.low), np.abs(value.high)))
    return Interval(np.maximum(_round_down(small * small), 0.0), _round_up(value.magnitude * value.magnitude))


def sqrt(value: Interval) -> Interval:
    """Returns the square roots of non-negative numbers."""
    low, high = np.sqrt(np.maximum(value.low, 0.0)), np.sqrt(np.maximum(value.high, 0.0))
    return Interval(np.maximum(_round_down(low), 0.0), _round_up(high))


def hypot(one: Interval, other: Interval) -> Interval:
    """Returns the lengths of vectors."""
    return sqrt(square(one) + square(other))


def cos(angle: Interval) -> Interval:
    """Returns the cosines: maximum at even multiples of pi, minimum at odd."""
    ends = np.cos(angle.low), np.cos(angle.high)
    anything = angle.magnitude > LARGEST_ANGLE
    top = anything | _may_contain_peak(angle, 0.0)
    bottom = anything | _may_contain_peak(angle, np.pi)
    low = np.where(bottom, -1.0, np.maximum(_round_down(np.minimum(*ends)) - LIBRARY_ERROR, -1.0))
    high = np.where(top, 1.0, np.minimum(_round_up(np.maximum(*ends)) + LIBRARY_ERROR, 1.0))
    return Interval(low, high)


def sin(angle: Interval) -> Interval:
    """Returns the sines."""
    return cos(angle - TURN * 0.25)


SERIES = 0.01
"""Radians below which sin(x) / x is its series."""


def sinc(angle: Interval) -> Interval:
    """Returns sin(x) / x, with value 1 at 0."""
    near = np.where(angle.contains(0.0), 0.0, np.minimum(np.abs(angle.low), np.abs(angle.high)))
    far = angle.magnitude
    most, least = _sinc(near), _sinc(far)
    # Beyond the first fall, a quotient where there is one; -0.25 is below its least value.
    quotient = sin(Interval(near, far)) / Interval(np.maximum(near, 1.0), np.maximum(far, 1.0))
    risen = _round_up(1 / np.maximum(near, np.pi))
    beyond = far >= np.pi
    high = np.where(beyond, np.where(near >= 1, quotient.high, np.maximum(most.high, risen)), most.high)
    low = np.where(beyond, np.where(near >= 1, quotient.low, -0.25), least.low)
    return Interval(low, np.minimum(high, 1.0))


def _sinc(size: Array) -> Interval:
    """Returns sin(x) / x for x >= 0; small x by series."""
    quotient = sin(as_interval(np.maximum(size, SERIES))) / np.maximum(size, SERIES)
    x = square(as_interval(np.minimum(size, SERIES)))
    upper = 1.0 - x / 6.0 + square(x) / 120.0
    lower = upper - x * square(x) / 5040.0
    small = size < SERIES
    low = np.where(small, lower.low, quotient.low)
    return Interval(low, np.where(small, upper.high, quotient.high))


def _may_contain_peak(angle: Interval, peak: float) -> Bool[np.ndarray, "..."]:
    """Returns True where the interval may contain a peak modulo 2 pi."""
    hair = 1e-15 * (1 + angle.magnitude)
    first = np.ceil((angle.low - hair - peak) / (2 * np.pi) - 1e-15 * angle.magnitude)
    return np.asarray(first * (2 * np.pi) + peak <= angle.high + 2 * hair)


@dataclass(frozen=True, slots=True, eq=False)
class PoseBox:
    """Poses or displacements as intervals: metres, metres, radians (not wrapped)."""

    x: Interval
    y: Interval
    heading: Interval

    def __matmul__(self, other: "PoseBox") -> "PoseBox":
        """Composes as `flight.se2.SE2` does."""
        c, s = cos(self.heading), sin(self.heading)
        return PoseBox(
            self.x + c * other.x - s * other.y,
            self.y + s * other.x + c * other.y,
            self.heading + other.heading,
        )

    @classmethod
    def exp(cls, forward: Interval, side: Interval, yaw_rate: Interval, duration: Interval) -> "PoseBox":
        """Returns displacements of a constant body velocity (thesis, eq. 17-18).

        Args:
            forward: metres per second.
            side: metres per second.
            yaw_rate: radians per second.
            duration: seconds.
        """
        half = 0.5 * (yaw_rate * duration)
        chord = duration * sinc(half)
        c, s = chord * cos(half), chord * sin(half)
        return cls(forward * c - side * s, forward * s + side * c, yaw_rate * duration)
