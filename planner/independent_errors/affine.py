"""Affine arithmetic: numbers affine in symbols between -1 and 1, plus radius.

The true value is middle + slope . symbols + something no larger than the radius, the same symbols in every
number, so that what two numbers have in common cancels when one is taken from the other (de Figueiredo and
Stolfi, Numerical Algorithms 37, 2004). Every operation adds to the radius what it makes of the symbols beyond
first order; a radius is infinite where an operation is not defined for all values that a number may have.
Rows are independent boxes.
"""

from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import Self

import numpy as np
from jaxtyping import Complex, Float

BoxValues = Float[np.ndarray, "n"]

SERIES = 0.02
"""Radians below which the derivative of the sinc is taken from its series."""

WIDE = 2.0
"""Radians; a rotation of larger uncertainty is bounded by its size only."""


@dataclass(frozen=True, eq=False)
class AffineForm:
    """Real numbers, a row for each box.

    Attributes:
        middle: value where all symbols are 0.
        slope: coefficient of each symbol.
        radius: bound of the remaining error.
    """

    middle: BoxValues
    slope: Float[np.ndarray, "n symbols"]
    radius: BoxValues

    @classmethod
    def exact(cls, middle: BoxValues, slope: Float[np.ndarray, "n symbols"]) -> Self:
        """Returns numbers without a radius."""
        return cls(middle, slope, np.zeros(len(middle)))

    @cached_property
    def reach(self) -> BoxValues:
        """Largest distance from the middle."""
        reach: BoxValues = np.abs(self.slope).sum(axis=1) + self.radius
        return reach

    @property
    def high(self) -> BoxValues:
        """Upper bound."""
        high: BoxValues = self.middle + self.reach
        return high

    @property
    def low(self) -> BoxValues:
        """Lower bound."""
        low: BoxValues = self.middle - self.reach
        return low

    def __add__(self, other: "AffineForm") -> "AffineForm":
        return AffineForm(self.middle + other.middle, self.slope + other.slope, self.radius + other.radius)

    def __sub__(self, other: "AffineForm") -> "AffineForm":
        return AffineForm(self.middle - other.middle, self.slope - other.slope, self.radius + other.radius)

    def __neg__(self) -> "AffineForm":
        return AffineForm(-self.middle, -self.slope, self.radius)

    def __mul__(self, other: "AffineForm") -> "AffineForm":
        one, two = self.middle, other.middle
        return AffineForm(
            one * two,
            one[:, None] * other.slope + two[:, None] * self.slope,
            np.abs(one) * other.radius + np.abs(two) * self.radius + self.reach * other.reach,
        )

    def shifted(self, by: BoxValues | float) -> "AffineForm":
        """Returns the numbers plus constants."""
        return AffineForm(self.middle + by, self.slope, self.radius)

    def scaled(self, by: BoxValues | float) -> "AffineForm":
        """Returns the numbers times constants."""
        return AffineForm(self.middle * by, self.slope * np.asarray(by)[..., None], self.radius * np.abs(by))

    def inverse(self) -> "AffineForm":
        """Returns reciprocals; the numbers must not contain 0."""
        size, inverse = np.abs(self.middle), 1 / self.middle
        nearest = size - self.reach
        off = np.where(nearest > 0, self.reach**2 / (size**2 * np.where(nearest > 0, nearest, 1.0)), np.inf)
        negative = inverse < 0
        below, above = np.where(negative, off, 0.0), np.where(negative, 0.0, off)
        return self._nonlinear(inverse, -(inverse**2), below, above)

    def root(self) -> "AffineForm":
        """Returns square roots; infinite radius where numbers may not be positive."""
        fine = self.low > 0
        reach = np.where(fine, self.reach, 0.0)
        middle = np.where(fine, self.middle, 1.0)
        root = np.sqrt(middle)
        # The tangent is above, most at the lower end.
        below = root - 0.5 * reach / root - np.sqrt(middle - reach)
        return self._nonlinear(root, 0.5 / root, np.where(fine, below, np.inf), np.zeros(len(root)))

    def sinc(self) -> "AffineForm":
        """Returns sin x / x, whose second derivative is at most 1/3."""
        x = self.middle
        near = np.abs(x) < SERIES
        safe = np.where(near, 1.0, x)
        slope = np.where(near, -x / 3 + x**3 / 30, (np.cos(safe) - np.sin(safe) / safe) / safe)
        off = self.reach**2 / 6
        return self._nonlinear(np.sinc(x / pi), slope, off, off)

    def _nonlinear(
        self, value: BoxValues, slope: BoxValues, below: BoxValues, above: BoxValues
    ) -> "AffineForm":
        """Returns a nonlinear function as its tangent plus an error radius."""
        with np.errstate(invalid="ignore"):
            return AffineForm(
                value + np.where(np.isfinite(below + above), 0.5 * (above - below), 0.0),
                slope[:, None] * self.slope,
                np.abs(slope) * self.radius + 0.5 * (above + below),
            )

    def cosine_and_sine(self) -> tuple["AffineForm", "AffineForm"]:
        """Returns cosine and sine of the offsets from the angles' middle."""
        wide, nothing = self.reach, np.zeros(len(self.reach))
        narrow = np.minimum(wide, WIDE)
        dip = np.where(wide < WIDE, 1 - np.cos(narrow), 2.0)
        bow = np.where(wide < WIDE, narrow - np.sin(narrow), 1 + wide)
        return self._nonlinear(nothing + 1, nothing, dip, nothing), self._nonlinear(
            nothing, nothing + 1, bow, bow
        )


@dataclass(frozen=True, eq=False)
class AffinePoint:
    """Points or directions in the plane: north and east, or body axes."""

    x: AffineForm
    y: AffineForm

    @classmethod
    def exact(cls, middle: Complex[np.ndarray, "n"], slope: Complex[np.ndarray, "n symbols"]) -> Self:
        """Returns points without a radius."""
        return cls(AffineForm.exact(middle.real, slope.real), AffineForm.exact(middle.imag, slope.imag))

    @property
    def middle(self) -> Complex[np.ndarray, "n"]:
        """Values where all symbols are 0."""
        return self.x.middle + 1j * self.y.middle

    def __add__(self, other: "AffinePoint") -> "AffinePoint":
        return AffinePoint(self.x + other.x, self.y + other.y)

    def __neg__(self) -> "AffinePoint":
        return AffinePoint(-self.x, -self.y)

    def __mul__(self, other: AffineForm) -> "AffinePoint":
        return AffinePoint(self.x * other, self.y * other)

    def rotated_left(self) -> "AffinePoint":
        """Returns the points turned left by a right angle."""
        return AffinePoint(self.y, -self.x)

    def turned(self, by: Complex[np.ndarray, "n"]) -> "AffinePoint":
        """Returns the points times complex constants."""
        c, s = by.real, by.imag
        return AffinePoint(self.x.scaled(c) - self.y.scaled(s), self.x.scaled(s) + self.y.scaled(c))

    def rotated(self, angle: AffineForm) -> "AffinePoint":
        """Returns the points rotated by an angle, clockwise from north."""
        point = self
        if angle.reach.any():
            cosine, sine = angle.cosine_and_sine()
            point = AffinePoint(self.x * cosine - self.y * sine, self.x * sine + self.y * cosine)
        return point.turned(np.exp(1j * angle.middle)) if angle.middle.any() else point

    def distance(self) -> AffineForm:
        """Returns the distance from the origin.

        Scaled to 1 + u + i w, the distance is 1 + u plus a lateral term from 0 to hypot(1 + u, w) - 1 - u.
        """
        unit, nearest, aside = self._ahead()
        nothing = np.zeros(len(nearest))
        more = np.hypot(nearest, aside) - nearest
        return unit.x._nonlinear(unit.x.middle, nothing + 1, nothing, more).scaled(np.abs(self._size))

    def bearing(self) -> AffineForm:
        """Returns the bearings of points, relative to their middle.

        atan(w / (1 + u)) is w, but for w u / (1 + u) and at most a third of the cube of w / (1 + u).
        """
        unit, nearest, aside = self._ahead()
        fine = nearest > 0
        steep = aside / np.where(fine, nearest, 1.0)
        off = np.where(fine, steep * unit.x.reach + np.minimum(steep**3 / 3, steep), np.inf)
        one = np.ones(len(off))
        return unit.y._nonlinear(np.angle(self.middle), one, off, off)

    def _ahead(self) -> tuple["AffinePoint", BoxValues, BoxValues]:
        """Returns points scaled to middle 1, their least distance and lateral reach."""
        unit = self.turned(1 / self._size)
        return unit, unit.x.low, unit.y.reach

    @property
    def _size(self) -> Complex[np.ndarray, "n"]:
        return np.where(self.middle == 0, 1.0, self.middle)


def affine_coast(velocity: AffinePoint, rate: AffineForm, time: AffineForm) -> tuple[AffinePoint, AffineForm]:
    """Returns displacement and heading change of a coast (thesis, eq. 17-18).

    It is velocity times time, along the chord: turned by half the angle, and shorter by its sinc.
    """
    angle = rate * time
    half = angle.scaled(0.5)
    return (velocity * (time * half.sinc())).rotated(half), angle
