"""A walk's numbers as intervals, rounded outward, for the check of certificates.

Positions are complex (north + i east), seen from the start with heading 0; what the maneuvers of a walk turn
is folded into its vectors, so that headings are those that coasting alone makes.
"""

from dataclasses import dataclass, replace
from math import inf

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.mission.mission import Mission

from .intervals import TURN, Interval, cos, hypot, interval, sin

Numbers = Float[np.ndarray, "leaves"]

ASTRAY = 1e-4
"""Metres by which a walk may end elsewhere if its slowest turns are taken as straight lines."""

ASKEW = 1e-7
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
        """Outward."""
        return Complex(self.real + other.real, self.imag + other.imag)

    def __sub__(self, other: "Complex") -> "Complex":
        """Outward."""
        return Complex(self.real - other.real, self.imag - other.imag)

    def __mul__(self, other: "Complex") -> "Complex":
        """Outward."""
        return Complex(
            self.real * other.real - self.imag * other.imag, self.real * other.imag + self.imag * other.real
        )

    def times(self, factor: Interval | Numbers) -> "Complex":
        """Returns multiples."""
        return Complex(self.real * factor, self.imag * factor)


@dataclass(frozen=True, slots=True, eq=False)
class Place:
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
class WalkNumbers:
    """A walk at one level: its places, seconds in maneuvers, and what these turn, in radians.

    Attributes:
        astray: metres that its end is off at most, for turns that were taken as straight lines.
        askew: radians, likewise.
    """

    places: tuple[Place, ...]
    fixed: Interval
    turned: Interval
    astray: float = 0.0
    askew: float = 0.0


def walk_numbers(library: Library, sequence: tuple[int, ...], gamma: float) -> WalkNumbers:
    """Returns a walk's numbers, value + gamma * error rounded outward.

    Raises:
        UnknownTrimError: the library lacks a trim.
        NoManeuverError: the library does not join two of the trims.
    """
    places = []
    fixed = turned = interval(0.0)
    maneuvers = (None, *library.maneuvers_along(sequence))
    for identity, maneuver in zip(sequence, maneuvers, strict=True):
        displacement = exact(0.0, 0.0)
        if maneuver is not None:
            error = maneuver.error
            displacement = Complex.turned(turned) * Complex(
                scaled(maneuver.displacement.x, error.forward, gamma),
                scaled(maneuver.displacement.y, error.side, gamma),
            )
            turned = turned + scaled(maneuver.displacement.heading, error.heading_change, gamma)
            fixed = fixed + scaled(maneuver.duration, error.duration, gamma)
        places.append(_place(library, identity, gamma, turned, displacement))
    return WalkNumbers(tuple(places), fixed, turned)


def _place(library: Library, trim: int, gamma: float, turned: Interval, displacement: Complex) -> Place:
    velocity, error = library.trim(trim).velocity, library.trim(trim).error
    moved = Complex(scaled(velocity.forward, error.forward, gamma), scaled(velocity.side, error.side, gamma))
    folded = Complex.turned(turned) * moved
    rate = scaled(velocity.yaw_rate, error.yaw_rate, gamma)
    if rate.low == rate.high == 0:
        still = all(part.low == part.high == 0 for part in (moved.real, moved.imag))
        return Place(None, folded, displacement, exact(0.0, 0.0), 0.0 if still else inf)
    if rate.contains(0.0):
        return Place(rate, folded, displacement, exact(0.0, 0.0), inf)
    size = rate if rate.low > 0 else -rate
    # v / (i r)
    centre = Complex(folded.imag / rate, -folded.real / rate)
    return Place(rate, folded, displacement, centre, float((TURN / size).high))


def straightened(walk: WalkNumbers, mission: Mission, seconds: float) -> WalkNumbers:
    """Returns a walk with the turns made straight that do not show in so many seconds.

    With headings off by no more than an angle, the end is off by no more than the length of the way times the
    angle: what counts as reached is widened by both.

    Raises:
        ValueError: a yaw rate that cannot be told from 0 does show.
    """
    spare = float(np.maximum((interval(seconds) - walk.fixed).high, 0.0))
    length = interval(0.0)
    fastest = 0.0
    for place in walk.places:
        length = length + hypot(place.displacement.real, place.displacement.imag)
        fastest = max(fastest, float(hypot(place.velocity.real, place.velocity.imag).high))
    with np.errstate(over="ignore", invalid="ignore"):
        way = length + interval(fastest) * spare
    places, worst = [], interval(0.0)
    for number, place in enumerate(walk.places):
        if place.rate is None:
            places.append(place)
            continue
        with np.errstate(over="ignore", invalid="ignore"):
            angle = interval(spare) * place.rate.magnitude
            astray = float((angle * way).high)
        shows = not astray <= ASTRAY or (mission.goal_heading is not None and angle.high > ASKEW)
        if not shows:
            worst = worst.hull(angle)
            still = all(part.low == part.high == 0 for part in (place.velocity.real, place.velocity.imag))
            longest = 0.0 if still else inf
            places.append(replace(place, rate=None, centre=exact(0.0, 0.0), longest=longest))
        elif place.rate.contains(0.0):
            raise ValueError(f"the yaw rate at place {number} cannot be told from 0")
        else:
            places.append(place)
    off = float((worst * way).high) if worst.high > 0 else 0.0
    return replace(walk, places=tuple(places), astray=off, askew=float(worst.high))


def scaled(value: float, error: float, gamma: float) -> Interval:
    """Returns value + gamma * error."""
    if gamma == 0 or error == 0:
        return interval(value)
    # 0 + gamma * error is as exact as gamma * error; a sum that is exactly 0 stays 0.
    exact = interval(gamma) * error
    return exact if value == 0 else exact + value


def exact(north: float, east: float) -> Complex:
    """Returns a complex number without doubt."""
    return Complex(interval(north), interval(east))
