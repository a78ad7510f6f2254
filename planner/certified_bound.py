"""The bound that multipliers give, in interval arithmetic: `docs/planner.md` has the formula.

Positions are complex (north + i east), seen from the start with heading 0; what the maneuvers of a walk turn
is folded into its vectors, so that headings are those that coasting alone makes.
"""

from dataclasses import dataclass
from math import inf, pi

import numpy as np
from jaxtyping import Float

from flight.library import Library
from flight.mission import Mission

from .intervals import TURN, Interval, cos, hypot, interval, sin, sqrt, square

Numbers = Float[np.ndarray, "leaves"]

GOAL_EQUALITY = 1e-6
"""Metres and radians within which a tolerance of 0 is met."""

ANGLE_SLACK = 1e-11
"""Radians, relative too, by which the place of a minimum is blurred: far more than any arctan2 is off."""


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
    """A walk at one level: its places, seconds in maneuvers, and what these turn, in radians."""

    places: tuple[Place, ...]
    fixed: Interval
    turned: Interval


@dataclass(frozen=True, slots=True, eq=False)
class Leaves:
    """Boxes of coasting times in seconds, and the multipliers that are to refute them."""

    low: Float[np.ndarray, "leaves trims"]
    high: Float[np.ndarray, "leaves trims"]
    kappa: Numbers
    north: Numbers
    east: Numbers
    shares: Float[np.ndarray, "leaves trims"]


def walk_numbers(library: Library, sequence: tuple[int, ...], gamma: float) -> WalkNumbers:
    """Returns a walk's numbers, value + gamma * error rounded outward.

    Raises:
        UnknownTrimError: the library lacks a trim.
        NoManeuverError: the library does not join two of the trims.
        ValueError: a yaw rate cannot be told from 0.
    """
    places = []
    fixed = turned = interval(0.0)
    maneuvers = (None, *library.maneuvers_along(sequence))
    for identity, maneuver in zip(sequence, maneuvers, strict=True):
        displacement = _at(0.0, 0.0)
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
        return Place(None, folded, displacement, _at(0.0, 0.0), 0.0 if still else inf)
    if rate.contains(0.0):
        raise ValueError(f"the yaw rate of trim {trim} cannot be told from 0 at gamma {gamma:g}")
    size = rate if rate.low > 0 else -rate
    # v / (i r)
    centre = Complex(folded.imag / rate, -folded.real / rate)
    return Place(rate, folded, displacement, centre, float((TURN / size).high))


def scaled(value: float, error: float, gamma: float) -> Interval:
    """Returns value + gamma * error."""
    if gamma == 0 or error == 0:
        return interval(value)
    # 0 + gamma * error is as exact as gamma * error; a sum that is exactly 0 stays 0.
    exact = interval(gamma) * error
    return exact if value == 0 else exact + value


def _at(north: float, east: float) -> Complex:
    return Complex(interval(north), interval(east))


def bound(walk: WalkNumbers, leaves: Leaves, mission: Mission) -> Numbers:
    """Returns, for each leaf, what kappa times the cost cannot be below if the goal is reached from its box.

    Infinite where no heading in the box is one that is wanted at the goal.
    """
    kappa = interval(leaves.kappa)
    m = Complex(interval(leaves.north), interval(-leaves.east))
    goal = _goal(mission)
    reach = hypot(interval(leaves.north), interval(leaves.east)) * max(mission.tolerance, GOAL_EQUALITY)
    total = kappa * walk.fixed - (m * goal).real - reach
    way, slope = _at(0.0, 0.0), interval(np.zeros(len(leaves.low)))
    spans = _headings(walk, leaves, mission)
    before = interval(np.zeros(len(leaves.low)))
    for index, place in enumerate(walk.places):
        first, last, x = leaves.low[:, index], leaves.high[:, index], leaves.shares[:, index]
        way = way + place.displacement
        after = spans[index]
        if place.rate is not None:
            worth = (kappa - x) / place.rate
            total = total + _least_wave(slope - worth, m * (way - place.centre), before)
            total = total + Interval(first, last) * x
            way, slope = place.centre, worth
        else:
            speed = m * place.velocity
            still = interval(np.zeros(len(first)))
            steady = kappa + _least_wave(still, speed, after)
            fast = kappa - _least_wave(still, speed.times(-1.0 + still), after)
            total = total + kappa * x + _aside(first, last, x, steady.low, fast.high)
            way = way + place.velocity.times(x)
        before = after
    least = (total + _least_wave(slope, m * way, before)).low
    nowhere = np.logical_or.reduce([span.low > span.high for span in spans])
    bounds: Numbers = np.where(nowhere, inf, least)
    return bounds


def _goal(mission: Mission) -> Complex:
    start = mission.start
    away = Complex(interval(mission.goal[0]) - start.x, interval(mission.goal[1]) - start.y)
    return Complex.turned(interval(-start.heading)) * away


def _aside(first: Numbers, last: Numbers, x: Numbers, steady: Numbers, fast: Numbers) -> Interval:
    """Returns the products of a straight time less x with what a second of it is worth, from below."""
    endless = np.isinf(last)
    # Where every second is worth something, the first is the worst.
    known = Interval(first, np.where(endless, first, last)) - x
    product = known * Interval(np.minimum(steady, fast), np.maximum(steady, fast))
    low = np.where(endless & (steady < 0), -inf, product.low)
    return Interval(low, low)


def _headings(walk: WalkNumbers, leaves: Leaves, mission: Mission) -> list[Interval]:
    """Returns between what the headings after each place lie; after the last turn only what is wanted."""
    heading = interval(np.zeros(len(leaves.low)))
    spans = []
    for index, place in enumerate(walk.places):
        if place.rate is not None:
            heading = heading + place.rate * Interval(leaves.low[:, index], leaves.high[:, index])
        spans.append(heading)
    if mission.goal_heading is None or mission.heading_tolerance >= pi:
        return spans
    wanted = interval(mission.goal_heading) - mission.start.heading - walk.turned
    width = max(mission.heading_tolerance, GOAL_EQUALITY)
    turns = [index for index, place in enumerate(walk.places) if place.rate is not None]
    last = turns[-1] if turns else 0
    return [span if index < last else _wanted(span, wanted, width) for index, span in enumerate(spans)]


def _wanted(span: Interval, wanted: Interval, width: float) -> Interval:
    """Returns the part of a span between its first and last headings that are wanted, modulo full turns."""
    middle = float(wanted.middle)
    full = 2 * pi
    first = np.ceil((span.low - width - middle) / full - 1e-9)
    last = np.floor((span.high + width - middle) / full + 1e-9)
    from_below = wanted + TURN * first - width
    from_above = wanted + TURN * last + width
    return Interval(np.maximum(span.low, from_below.low), np.minimum(span.high, from_above.high))


def _least_wave(slope: Interval, wave: Complex, span: Interval) -> Interval:
    """Returns, as an interval of one number, a bound below slope * psi + Re(wave exp(i psi)) over a span.

    The least is at an end, or where the wave's slope is the line's, rising: psi = arg((-d + i slope) / wave)
    with d = sqrt(|wave|^2 - slope^2), and is slope * psi - d there.
    """
    a, x, y = slope.middle, wave.real.middle, wave.imag.middle
    blur = interval(slope.width) * span.magnitude + wave.real.width + wave.imag.width
    least = np.full(np.broadcast(a, span.low).shape, inf)
    for psi in (interval(span.low), interval(span.high)):
        least = np.minimum(least, (psi * a + cos(psi) * x - sin(psi) * y).low)
    size = square(interval(x)) + square(interval(y)) - square(interval(a))
    depth = sqrt(size)
    real, imag = depth * -x + interval(a) * y, depth * y + interval(a) * x
    at = np.arctan2(imag.middle, real.middle)
    length = np.hypot(imag.middle, real.middle)
    doubt = real.width + imag.width
    error = np.where(length > 2 * doubt, 2 * doubt / np.where(length > 0, length, 1.0), pi)
    error = error + ANGLE_SLACK * (1 + span.magnitude)
    full = 2 * pi
    for psi in (
        at + full * np.ceil((span.low - error - at) / full - 1e-12),
        at + full * np.floor((span.high + error - at) / full + 1e-12),
    ):
        around = Interval(psi - error, psi + error)
        inside = (size.high > 0) & (around.high >= span.low) & (around.low <= span.high)
        least = np.where(inside, np.minimum(least, (around * a - depth).low), least)
    low = (interval(least) - blur).low
    # Numbers too large to be squared tell nothing of where the least is.
    low = np.where(np.isfinite(length) & np.isfinite(doubt), low, -inf)
    return Interval(low, low)
