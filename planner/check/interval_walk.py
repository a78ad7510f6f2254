"""Coefficients of a walk as intervals, rounded outward, for certificate checks.

Positions are complex (north + i east), seen from the start with heading 0; what the maneuvers of a walk turn
is folded into its vectors, so that headings are those that coasting alone makes.
"""

from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.mission.mission import Mission

from .intervals import TURN, Interval, as_interval, cos, hypot, sin

LeafValues = Float[np.ndarray, "leaves"]

POSITION_SLACK = 1e-4
"""Metres by which the end may shift if negligible turns are made straight."""

HEADING_SLACK = 1e-7
"""Radians, likewise, where a heading is wanted."""


@dataclass(frozen=True, slots=True, eq=False)
class Complex:
    """Complex numbers in boxes."""

    real: Interval
    imag: Interval

    @classmethod
    def turned(cls, angle: Interval) -> "Complex":
        """Returns exp(i angle)."""
        return cls(cos(angle), sin(angle))

    def __add__(self, other: "Complex") -> "Complex":
        """Returns sums, rounded outward."""
        return Complex(self.real + other.real, self.imag + other.imag)

    def __sub__(self, other: "Complex") -> "Complex":
        """Returns differences, rounded outward."""
        return Complex(self.real - other.real, self.imag - other.imag)

    def __mul__(self, other: "Complex") -> "Complex":
        """Returns products, rounded outward."""
        return Complex(
            self.real * other.real - self.imag * other.imag, self.real * other.imag + self.imag * other.real
        )

    def times(self, factor: Interval | LeafValues) -> "Complex":
        """Returns multiples."""
        return Complex(self.real * factor, self.imag * factor)


@dataclass(frozen=True, slots=True, eq=False)
class WalkPlace:
    """One trim of a walk, and the maneuver before it.

    Attributes:
        rate: yaw rate in radians per second; None where it is exactly 0.
        velocity: metres per second.
        displacement: of the maneuver, metres.
        centre: of the turn; 0 where there is none.
        longest: seconds after which holding on repeats what was; infinite on a straight line, 0 at rest.
    """

    rate: Interval | None
    velocity: Complex
    displacement: Complex
    centre: Complex
    longest: float


@dataclass(frozen=True, slots=True, eq=False)
class IntervalWalk:
    """A walk at one level: places, maneuver seconds and maneuver turns.

    Attributes:
        position_slack: metres that its end is off at most, for turns that were taken as straight lines.
        heading_slack: radians, likewise.
    """

    places: tuple[WalkPlace, ...]
    fixed: Interval
    turned: Interval
    position_slack: float = 0.0
    heading_slack: float = 0.0


def interval_walk(library: Library, sequence: tuple[int, ...], gamma: float) -> IntervalWalk:
    """Returns the coefficients of a walk at gamma, rounded outward.

    Raises:
        UnknownTrimError: the library lacks a trim.
        NoManeuverError: the library does not join two of the trims.
    """
    places = []
    fixed = turned = as_interval(0.0)
    maneuvers = (None, *library.maneuvers_along(sequence))
    for identity, maneuver in zip(sequence, maneuvers, strict=True):
        displacement = exact_point(0.0, 0.0)
        if maneuver is not None:
            error = maneuver.error
            displacement = Complex.turned(turned) * Complex(
                value_at_gamma(maneuver.displacement.x, error.forward, gamma),
                value_at_gamma(maneuver.displacement.y, error.side, gamma),
            )
            turned = turned + value_at_gamma(maneuver.displacement.heading, error.heading_change, gamma)
            fixed = fixed + value_at_gamma(maneuver.duration, error.duration, gamma)
        places.append(_walk_place(library, identity, gamma, turned, displacement))
    return IntervalWalk(tuple(places), fixed, turned)


def _walk_place(
    library: Library, trim: int, gamma: float, turned: Interval, displacement: Complex
) -> WalkPlace:
    velocity, error = library.trim(trim).velocity, library.trim(trim).error
    moved = Complex(
        value_at_gamma(velocity.forward, error.forward, gamma),
        value_at_gamma(velocity.side, error.side, gamma),
    )
    folded = Complex.turned(turned) * moved
    rate = value_at_gamma(velocity.yaw_rate, error.yaw_rate, gamma)
    if rate.low == rate.high == 0:
        still = all(part.low == part.high == 0 for part in (moved.real, moved.imag))
        return WalkPlace(None, folded, displacement, exact_point(0.0, 0.0), 0.0 if still else inf)
    if rate.contains(0.0):
        return WalkPlace(rate, folded, displacement, exact_point(0.0, 0.0), inf)
    size = rate if rate.low > 0 else -rate
    # v / (i r)
    centre = Complex(folded.imag / rate, -folded.real / rate)
    return WalkPlace(rate, folded, displacement, centre, float((TURN / size).high))


def straighten_slow_turns(walk: IntervalWalk, mission: Mission, seconds: float) -> IntervalWalk:
    """Returns a walk with turns negligible within the given seconds made straight.

    If headings differ by at most an angle, the end shifts by at most the path length times the angle: the
    goal's tolerances are widened by both.

    Raises:
        ValueError: a yaw rate whose interval contains 0 is not negligible.
    """
    spare = float(np.maximum((as_interval(seconds) - walk.fixed).high, 0.0))
    length = as_interval(0.0)
    fastest = 0.0
    for place in walk.places:
        length = length + hypot(place.displacement.real, place.displacement.imag)
        fastest = max(fastest, float(hypot(place.velocity.real, place.velocity.imag).high))
    with np.errstate(over="ignore", invalid="ignore"):
        way = length + as_interval(fastest) * spare
    places, worst = [], as_interval(0.0)
    for number, place in enumerate(walk.places):
        if place.rate is None:
            places.append(place)
            continue
        with np.errstate(over="ignore", invalid="ignore"):
            angle = as_interval(spare) * place.rate.magnitude
            position_slack = float((angle * way).high)
        shows = not position_slack <= POSITION_SLACK or (
            mission.goal_heading is not None and angle.high > HEADING_SLACK
        )
        if not shows:
            worst = worst.hull(angle)
            still = all(part.low == part.high == 0 for part in (place.velocity.real, place.velocity.imag))
            longest = 0.0 if still else inf
            places.append(replace(place, rate=None, centre=exact_point(0.0, 0.0), longest=longest))
        elif place.rate.contains(0.0):
            raise ValueError(f"the interval of the yaw rate at place {number} contains 0")
        else:
            places.append(place)
    off = float((worst * way).high) if worst.high > 0 else 0.0
    return replace(walk, places=tuple(places), position_slack=off, heading_slack=float(worst.high))


def value_at_gamma(value: float, error: float, gamma: float) -> Interval:
    """Returns value + gamma * error."""
    if gamma == 0 or error == 0:
        return as_interval(value)
    # 0 + gamma * error is as exact as gamma * error; a sum that is exactly 0 stays 0: a turn made straight.
    if value + gamma * error == 0 and Fraction(value) + Fraction(gamma) * Fraction(error) == 0:
        return as_interval(0.0)
    product = as_interval(gamma) * error
    return product if value == 0 else product + value


def exact_point(north: float, east: float) -> Complex:
    """Returns a complex number of zero width."""
    return Complex(as_interval(north), as_interval(east))
