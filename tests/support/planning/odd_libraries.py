"""Libraries drawn by chance, with everything that a measured one seldom has."""

import itertools
from math import pi

import numpy as np

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.se2 import SE2, Twist

RATES = (0.1, 0.3, 0.4, 0.5, 1.0)
"""Radians per second, before they are scaled."""


def odd_library(rng: np.random.Generator) -> Library:
    """Returns one to five trims with speeds, rates and errors of every kind, and maneuvers between some.

    Side velocities, backward flight, hover, equal, opposite, nearly equal and tiny rates, errors that turn
    signs over, self loops, maneuvers without duration or displacement, turns of more than a full circle,
    and lengths and times of any scale.
    """
    count = int(rng.choice([1, 2, 3, 4, 5], p=[0.12, 0.28, 0.33, 0.17, 0.1]))
    metres = 10.0 ** float(rng.uniform(-4, 5)) if rng.random() < 0.25 else 1.0
    seconds = 10.0 ** float(rng.uniform(-2, 2)) if rng.random() < 0.15 else 1.0
    size = _error_size(rng)
    rates = _rates(rng, count)
    trims = tuple(
        _scaled_trim(number, _velocity(rng, rate), rng, size, (metres, seconds))
        for number, rate in enumerate(rates, start=1)
    )
    maneuvers = tuple(
        _maneuver(place, pair, trims, rng, size, (metres, seconds))
        for place, pair in enumerate(_edges(rng, count), start=1)
    )
    return Library("odd", "drawn by chance", "", trims, maneuvers)


def _error_size(rng: np.random.Generator) -> float:
    """Returns the size of errors in shares of the values."""
    kind = rng.random()
    if kind < 0.25:
        return 0.0
    return 10.0 ** float(rng.uniform(-4, -1)) if kind < 0.75 else float(rng.uniform(0.1, 1.5))


def _rates(rng: np.random.Generator, count: int) -> list[float]:
    """Returns yaw rates: some 0, some like one before; in every third library of one size."""
    if rng.random() < 0.35:
        one = float(rng.choice(RATES))
        return [float(rng.choice([0.0, one, -one], p=[0.45, 0.35, 0.2])) for _ in range(count)]
    rates: list[float] = []
    for _ in range(count):
        kind = rng.random()
        if kind < 0.3:
            rate = 0.0
        elif kind < 0.55 or not rates:
            rate = float(rng.choice([-1, 1])) * (
                float(rng.choice(RATES)) if rng.random() < 0.7 else float(rng.uniform(0.02, 1.5))
            )
        elif kind < 0.62:
            rate = float(rng.choice([-1, 1])) * 10.0 ** float(rng.uniform(-9, -3))
        elif kind < 0.78:
            rate = float(rng.choice(rates))
        elif kind < 0.9:
            rate = -float(rng.choice(rates))
        else:
            rate = float(rng.choice(rates)) * (1 + 10.0 ** float(rng.uniform(-12, -2)))
        rates.append(rate)
    return rates


def _velocity(rng: np.random.Generator, rate: float) -> Twist:
    kind = rng.random()
    if kind < 0.08:
        return Twist(0.0, 0.0, rate)
    forward = float(rng.choice([1, 2, 3, 5])) if rng.random() < 0.6 else float(rng.uniform(0.1, 10))
    forward *= -1 if rng.random() < 0.2 else 1
    if kind < 0.7:
        return Twist(forward, 0.0, rate)
    side = float(rng.choice([-1, 1])) if rng.random() < 0.5 else float(rng.uniform(-3, 3))
    return Twist(forward if kind < 0.93 else 0.0, side, rate)


def _scaled_trim(
    number: int, held: Twist, rng: np.random.Generator, size: float, units: tuple[float, float]
) -> Trim:
    speed = units[0] / units[1]
    velocity = Twist(held.forward * speed, held.side * speed, held.yaw_rate / units[1])
    spread = _errors(rng, size, 3)
    base = max(abs(held.forward), abs(held.side), 0.3) * speed
    turning = abs(held.yaw_rate) if rng.random() < 0.7 else float(rng.choice([0.0, 0.01, 0.1]))
    rate_error = spread[2] * turning / units[1]
    if size and rng.random() < 0.07:
        # At one end of the levels the turn is exactly a straight line.
        rate_error = float(rng.choice([-1, 1, 2])) * velocity.yaw_rate
    return Trim(number, f"trim {number}", velocity, Twist(spread[0] * base, spread[1] * base, rate_error))


def _errors(rng: np.random.Generator, size: float, count: int) -> list[float]:
    values = size * rng.uniform(-1, 1, count)
    return [float(value) for value in np.where(rng.random(count) < 0.2, 0.0, values)]


def _edges(rng: np.random.Generator, count: int) -> list[tuple[int, int]]:
    """Returns the pairs of trims that maneuvers join: a path at least, and others by chance."""
    order = [int(one) + 1 for one in rng.permutation(count)]
    pairs = set(itertools.pairwise(order))
    density = float(rng.choice([0.0, 0.2, 0.5, 0.9], p=[0.4, 0.2, 0.2, 0.2]))
    for one in range(1, count + 1):
        for two in range(1, count + 1):
            if rng.random() < (density if one != two else 0.3 * density + 0.04):
                pairs.add((one, two))
    return sorted(pairs)


def _maneuver(
    number: int,
    pair: tuple[int, int],
    trims: tuple[Trim, ...],
    rng: np.random.Generator,
    size: float,
    units: tuple[float, float],
) -> Maneuver:
    metres, seconds = units
    duration = float(rng.choice([0.0, 1.0, 2.0])) if rng.random() < 0.5 else float(rng.uniform(0.1, 6))
    forward, side, turn = 0.0, 0.0, 0.0
    kind = rng.random()
    if kind < 0.3:
        forward, side = duration * float(rng.uniform(0, 3)), float(rng.normal())
    elif kind < 0.6:
        forward, side = (float(one) for one in rng.normal(0, 4, 2))
    elif kind < 0.75:
        one, two = (trims[trim - 1].velocity for trim in pair)
        mean = 0.5 * (one.forward + two.forward) * seconds / metres
        forward = duration * mean
    kind = rng.random()
    if kind < 0.5:
        turn = float(rng.uniform(-1.5, 1.5))
    elif kind < 0.6:
        turn = float(rng.choice([-1, 1])) * float(rng.choice([pi / 2, pi, 2 * pi]))
    elif kind < 0.67:
        turn = float(rng.choice([-1, 1])) * float(rng.uniform(2 * pi, 6 * pi))
    errors = _errors(rng, size, 4)
    base = abs(forward) + abs(side) + 0.3
    late = float(np.clip(errors[0], -1, 1)) * duration
    return Maneuver(
        number,
        *pair,
        duration * seconds,
        SE2(forward * metres, side * metres, turn),
        ManeuverError(
            late * seconds,
            errors[1] * base * metres,
            errors[2] * base * metres,
            errors[3] * (abs(turn) + 0.2),
        ),
    )
