"""Planted stationary times are found, and solutions reach the goal."""

from dataclasses import replace
from math import inf, remainder, tau

import numpy as np
import pytest

from .planted_walks import Planted, planted
from .walk_problem import WalkProblem

pytestmark = pytest.mark.kernel

SLACK = 1e-9
TELLABLE = 1e-6
"""Seconds; where two ways become one, the root of the slack."""

AT_THE_EDGE = 1e-4


def problems_of(one: Planted) -> list[str]:
    cost, times = one.walk.solved()
    known = sum(one.times)
    margin = AT_THE_EDGE if one.worth == inf else TELLABLE + 5 * SLACK * one.worth
    found = [f"{cost} s, {known} s do"] if cost > known + margin else []
    if cost < inf:
        found += unreached(one.walk, times, cost)
    return found


def unreached(walk: WalkProblem, times: tuple[float, ...], cost: float) -> list[str]:
    end, heading = walk.end(times)
    found = []
    if abs(end - walk.goal) > walk.tolerance + SLACK:
        found.append(f"the end is {abs(end - walk.goal)} m from the goal, allowed are {walk.tolerance} m")
    if (
        walk.heading is not None
        and abs(remainder(heading - walk.heading, tau)) > walk.heading_tolerance + SLACK
    ):
        found.append(f"the heading is {heading}")
    if min(times) < 0 or abs(sum(times) - cost) > SLACK:
        found.append(f"times {times}, cost {cost}")
    return found


@pytest.mark.parametrize("part", range(10))
def test_stationary_times_are_found(part: int) -> None:
    tried, wrong = 0, []
    for number in range(400):
        one = planted(np.random.default_rng([part, number]))
        if one is None:
            continue
        tried += 1
        wrong += [f"[{part}, {number}]: {problem}" for problem in problems_of(one)]
    assert tried > 150
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("scale", [1e-4, 1e-2, 1e3, 1e7])
def test_stationary_times_are_found_at_every_size(scale: float) -> None:
    for number in range(40):
        one = planted(np.random.default_rng([99, number]), slow=0.0)
        if one is None or one.worth == inf:
            continue
        walk = one.walk
        large = replace(
            walk,
            velocities=tuple(velocity * scale for velocity in walk.velocities),
            displacements=tuple(moved * scale for moved in walk.displacements),
            goal=walk.goal * scale,
            tolerance=walk.tolerance * scale,
        )
        cost, _ = large.solved()
        margin = 5 * SLACK * max(1.0, 1 / scale) * one.worth
        assert cost <= sum(one.times) + TELLABLE + margin, number
