"""Lagrangian bound of given multipliers, in interval arithmetic; formula in `docs/planner.md`."""

from dataclasses import dataclass
from math import inf, pi

import numpy as np
from jaxtyping import Float

from flight.mission.mission import Mission

from .interval_walk import Complex, IntervalWalk, LeafValues, exact_point
from .intervals import TURN, Interval, as_interval, cos, hypot, sin, sqrt, square

ANGLE_SLACK = 1e-11
"""Radians, also relative, of slack for a minimum's place; far above arctan2's error."""


@dataclass(frozen=True, slots=True, eq=False)
class Leaves:
    """Boxes of coasting times in seconds, with their refuting multipliers."""

    low: Float[np.ndarray, "leaves trims"]
    high: Float[np.ndarray, "leaves trims"]
    kappa: LeafValues
    north: LeafValues
    east: LeafValues
    shares: Float[np.ndarray, "leaves trims"]


def dual_bound(walk: IntervalWalk, leaves: Leaves, mission: Mission) -> LeafValues:
    """Returns a lower bound of kappa times the cost for each leaf.

    Infinite where no heading in the box is one that is wanted at the goal.
    """
    kappa = as_interval(leaves.kappa)
    m = Complex(as_interval(leaves.north), as_interval(-leaves.east))
    goal = _goal(mission)
    tolerance = as_interval(mission.destination.reach) + walk.position_slack
    reach = hypot(as_interval(leaves.north), as_interval(leaves.east)) * tolerance
    total = kappa * walk.fixed - (m * goal).real - reach
    way, slope = exact_point(0.0, 0.0), as_interval(np.zeros(len(leaves.low)))
    spans = _headings(walk, leaves, mission)
    before = as_interval(np.zeros(len(leaves.low)))
    for index, place in enumerate(walk.places):
        first, last, x = leaves.low[:, index], leaves.high[:, index], leaves.shares[:, index]
        way = way + place.displacement
        after = spans[index]
        if place.rate is not None:
            multiplier = (kappa - x) / place.rate
            total = total + _least_wave(slope - multiplier, m * (way - place.centre), before)
            total = total + Interval(first, last) * x
            way, slope = place.centre, multiplier
        else:
            speed = m * place.velocity
            still = as_interval(np.zeros(len(first)))
            steady = kappa + _least_wave(still, speed, after)
            fast = kappa - _least_wave(still, speed.times(-1.0 + still), after)
            total = total + kappa * x + _straight_term(first, last, x, steady.low, fast.high)
            way = way + place.velocity.times(x)
        before = after
    least = (total + _least_wave(slope, m * way, before)).low
    nowhere = np.logical_or.reduce([span.low > span.high for span in spans])
    bounds: LeafValues = np.where(nowhere, inf, least)
    return bounds


def _goal(mission: Mission) -> Complex:
    start = mission.start
    away = Complex(as_interval(mission.goal[0]) - start.x, as_interval(mission.goal[1]) - start.y)
    return Complex.turned(as_interval(-start.heading)) * away


def _straight_term(
    first: LeafValues, last: LeafValues, x: LeafValues, steady: LeafValues, fast: LeafValues
) -> Interval:
    """Returns a lower bound of straight time less x, weighted by multipliers."""
    endless = np.isinf(last)
    # With a positive weight of time the first second gives the bound.
    known = Interval(first, np.where(endless, first, last)) - x
    product = known * Interval(np.minimum(steady, fast), np.maximum(steady, fast))
    low = np.where(endless & (steady < 0), -inf, product.low)
    return Interval(low, low)


def _headings(walk: IntervalWalk, leaves: Leaves, mission: Mission) -> list[Interval]:
    """Returns the interval of headings after each place."""
    heading = as_interval(np.zeros(len(leaves.low)))
    spans = []
    for index, place in enumerate(walk.places):
        if place.rate is not None:
            heading = heading + place.rate * Interval(leaves.low[:, index], leaves.high[:, index])
        spans.append(heading)
    if mission.goal_heading is None or not mission.destination.wants_heading:
        return spans
    wanted = as_interval(mission.goal_heading) - mission.start.heading - walk.turned
    width = float((as_interval(mission.destination.heading_reach) + walk.heading_slack).high)
    turns = [index for index, place in enumerate(walk.places) if place.rate is not None]
    last = turns[-1] if turns else 0
    return [
        span if index < last else _wanted_headings(span, wanted, width) for index, span in enumerate(spans)
    ]


def _wanted_headings(span: Interval, wanted: Interval, width: float) -> Interval:
    """Returns the wanted headings within a span, modulo full turns."""
    middle = float(wanted.middle)
    full = 2 * pi
    first = np.ceil((span.low - width - middle) / full - 1e-9)
    last = np.floor((span.high + width - middle) / full + 1e-9)
    from_below = wanted + TURN * first - width
    from_above = wanted + TURN * last + width
    return Interval(np.maximum(span.low, from_below.low), np.minimum(span.high, from_above.high))


def _least_wave(slope: Interval, wave: Complex, span: Interval) -> Interval:
    """Returns an interval below slope * psi + Re(wave exp(i psi)).

    The least is at an end, or where the wave's slope is the line's, rising: psi = arg((-d + i slope) / wave)
    with d = sqrt(|wave|^2 - slope^2), and is slope * psi - d there. Of slow turns d is the root of what
    cancels; a value nearby then bounds better: it exceeds the least by |wave| / 2 times the distance
    squared at most.
    """
    a, x, y = slope.middle, wave.real.middle, wave.imag.middle
    blur = as_interval(slope.width) * span.magnitude + wave.real.width + wave.imag.width
    least = np.full(np.broadcast(a, span.low).shape, inf)
    for psi in (as_interval(span.low), as_interval(span.high)):
        least = np.minimum(least, (psi * a + cos(psi) * x - sin(psi) * y).low)
    size = square(as_interval(x)) + square(as_interval(y)) - square(as_interval(a))
    depth = sqrt(size)
    real, imag = depth * -x + as_interval(a) * y, depth * y + as_interval(a) * x
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
        near = as_interval(psi) * a + cos(as_interval(psi)) * x - sin(as_interval(psi)) * y
        near = near - hypot(as_interval(x), as_interval(y)) * square(as_interval(error)) * 0.5
        least = np.where(inside, np.minimum(least, np.maximum((around * a - depth).low, near.low)), least)
    low = (as_interval(least) - blur).low
    # Numbers too large to be squared do not locate the minimum.
    low = np.where(np.isfinite(length) & np.isfinite(doubt), low, -inf)
    return Interval(low, low)
