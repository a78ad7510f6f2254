"""Two coasts that lead to a point: intersections of lines and circles."""

from math import pi

import numpy as np
from jaxtyping import Complex, Float

from .coasting_flow import fly
from .coasting_problem import CoastingProblem

ALL_BUT_STRAIGHT = 1e-7
"""Radians turned within the horizon below which a coast is first taken as straight."""

TOUCHING = 1e-9
"""Excess of a cosine over 1 that may be rounding at a touching solution."""


def last_two_times(
    problem: CoastingProblem,
    before: Float[np.ndarray, "rows samples others"],
    target: Complex[np.ndarray, "rows samples"],
    start: tuple[complex, float],
    horizon: float,
) -> Float[np.ndarray, "2 rows samples 2"]:
    """Returns both pairs of last times to a point, or NaN.

    Args:
        problem: rows with two free coasts or more.
        before: seconds in the coasts before these two.
        target: where to end, north + i east.
        start: position and heading at time 0.
        horizon: seconds within which a turn differs from a straight line.
    """
    pose = fly(problem, before, start, until=problem.free - 2)
    one, two = problem.free - 2, problem.free - 1
    facing = np.exp(1j * pose.heading)
    entry = pose.position + facing * problem.gap[:, one, None]
    facing = facing * np.exp(1j * problem.gap_turn[:, one, None])
    seen = np.conj(facing) * (target - entry)
    between = problem.gap[:, two, None]
    bent = np.exp(1j * problem.gap_turn[:, two, None])
    after = problem.gap[:, two + 1, None]
    turns = np.abs(problem.rate[:, [one, two]]) * horizon > ALL_BUT_STRAIGHT
    found = np.full((2, *seen.shape, 2), np.nan)
    for first in (False, True):
        for second in (False, True):
            rows = np.flatnonzero((turns[:, 0] == first) & (turns[:, 1] == second))
            if not len(rows):
                continue
            solve = _PAIRS[first, second]
            with np.errstate(all="ignore"):
                found[:, rows] = solve(
                    (problem.velocity[rows, one, None], problem.rate[rows, one, None]),
                    (problem.velocity[rows, two, None], problem.rate[rows, two, None]),
                    (between[rows], bent[rows], after[rows]),
                    seen[rows],
                )
    return found


Coast = tuple[Complex[np.ndarray, "rows 1"], Float[np.ndarray, "rows 1"]]
Gaps = tuple[Complex[np.ndarray, "rows 1"], Complex[np.ndarray, "rows 1"], Complex[np.ndarray, "rows 1"]]
Pairs = Float[np.ndarray, "2 rows samples 2"]


def _turn_turn(one: Coast, two: Coast, gaps: Gaps, seen: Complex[np.ndarray, "rows n"]) -> Pairs:
    arm, far = one[0] / (1j * one[1]), two[0] / (1j * two[1])
    between, bent, after = gaps
    goal = seen + arm
    near, tip = arm + between - bent * far, bent * (far + after)
    cosine = (np.abs(goal) ** 2 - np.abs(near) ** 2 - np.abs(tip) ** 2) / (2 * np.abs(near) * np.abs(tip))
    opening, aside = _arccos(cosine), np.angle(tip * np.conj(near))
    pairs = []
    for side in (-1.0, 1.0):
        second = side * opening - aside
        first = np.angle(goal * np.conj(near + np.exp(1j * second) * tip))
        pairs.append(np.stack([_turned(first, one[1]), _turned(second, two[1])], axis=-1))
    return np.stack(pairs)


def _turn_straight(one: Coast, two: Coast, gaps: Gaps, seen: Complex[np.ndarray, "rows n"]) -> Pairs:
    arm = one[0] / (1j * one[1])
    between, bent, after = gaps
    goal, base, way = seen + arm, arm + between + bent * after, bent * two[0]
    pairs = []
    for time in _meets(base, way, np.abs(goal)):
        first = np.angle(goal * np.conj(base + way * time))
        pairs.append(np.stack([_turned(first, one[1]), time], axis=-1))
    return np.stack(pairs)


def _straight_turn(one: Coast, two: Coast, gaps: Gaps, seen: Complex[np.ndarray, "rows n"]) -> Pairs:
    far = two[0] / (1j * two[1])
    between, bent, after = gaps
    middle, tip = seen - between + bent * far, bent * (far + after)
    pairs = []
    for time in _meets(middle, -one[0], np.abs(tip)):
        second = np.angle((middle - one[0] * time) * np.conj(tip))
        pairs.append(np.stack([time, _turned(second, two[1])], axis=-1))
    return np.stack(pairs)


def _straight_straight(one: Coast, two: Coast, gaps: Gaps, seen: Complex[np.ndarray, "rows n"]) -> Pairs:
    between, bent, after = gaps
    way, other = one[0] + 0 * seen, bent * two[0]
    rest = seen - between - bent * after
    area = (np.conj(way) * other).imag
    pair = np.stack([(np.conj(rest) * other).imag / area, (np.conj(way) * rest).imag / area], axis=-1)
    return np.stack([pair, np.full(pair.shape, np.nan)])


_PAIRS = {
    (True, True): _turn_turn,
    (True, False): _turn_straight,
    (False, True): _straight_turn,
    (False, False): _straight_straight,
}


def _meets(
    base: Complex[np.ndarray, "*n"], way: Complex[np.ndarray, "*n"], radius: Float[np.ndarray, "*n"]
) -> tuple[Float[np.ndarray, "*n"], Float[np.ndarray, "*n"]]:
    """Returns times at which a line has a distance from origin."""
    speed = np.abs(way)
    seen = np.conj(way / speed) * base
    inside = (radius - np.abs(seen.imag)) * (radius + np.abs(seen.imag))
    half = np.sqrt(np.where(inside > -TOUCHING * radius**2, np.maximum(inside, 0.0), np.nan))
    return (-seen.real - half) / speed, (-seen.real + half) / speed


def _arccos(cosine: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    return np.arccos(np.where(np.abs(cosine) <= 1 + TOUCHING, np.clip(cosine, -1.0, 1.0), np.nan))


def _turned(angle: Float[np.ndarray, "*n"], rate: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Returns seconds for a turn to an angle, modulo full turns."""
    return np.asarray(np.mod(angle * np.sign(rate), 2 * pi) / np.abs(rate))
