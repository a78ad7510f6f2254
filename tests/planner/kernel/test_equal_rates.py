"""Tests of equal yaw rates with a wanted heading."""

from dataclasses import replace

import numpy as np
import pytest

from .walk_problem import WalkProblem

pytestmark = pytest.mark.kernel


def random_walk(rng: np.random.Generator, coasts: int, rate: float) -> WalkProblem:
    return WalkProblem(
        velocities=tuple(complex(*rng.uniform(-1, 3, 2)) for _ in range(coasts)),
        rates=(rate,) * coasts,
        displacements=tuple(complex(*rng.uniform(-1, 1, 2)) for _ in range(coasts - 1)),
        turns=tuple(rng.uniform(-1, 1, coasts - 1).tolist()),
    )


@pytest.mark.parametrize("coasts", [2, 3, 4, 5])
@pytest.mark.parametrize("tolerance", [0.0, 0.3])
@pytest.mark.parametrize("seed", range(8))
def test_a_share_of_the_turn_that_ends_at_the_goal_is_found(coasts: int, tolerance: float, seed: int) -> None:
    """All shares of one turn take the same time."""
    rng = np.random.default_rng([coasts, seed])
    walk = random_walk(rng, coasts, float(rng.choice([-0.3, 0.3])))
    times = tuple(rng.dirichlet(np.ones(coasts)) * rng.uniform(3, 18))
    end, heading = walk.end(times)
    off = 0.9 * tolerance * np.exp(1j * rng.uniform(-3, 3))
    width = float(rng.choice([0.0, 0.05]))
    asked = replace(
        walk, goal=complex(end + off), tolerance=tolerance, heading=heading, heading_tolerance=width
    )
    cost, found = asked.solved()
    assert cost <= sum(times) + 1e-9
    reached, faced = walk.end(found)
    assert abs(reached - asked.goal) <= tolerance + 1e-9
    assert abs(np.remainder(faced - heading + 1, 2 * np.pi) - 1) <= width + 1e-9


@pytest.mark.parametrize("apart", [1e-15, 1e-13, 1e-9, 1e-5])
def test_rates_that_are_all_but_equal_are_solved_likewise(apart: float) -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        walk = random_walk(rng, 4, 0.3)
        walk = replace(walk, rates=tuple(rate * (1 + apart * rng.normal()) for rate in walk.rates))
        times = tuple(rng.dirichlet(np.ones(4)) * 12)
        end, heading = walk.end(times)
        cost, _ = replace(walk, goal=end, heading=heading, heading_tolerance=0.0).solved()
        assert cost <= sum(times) * (1 + 10 * apart) + 1e-9


def test_three_coasts_at_one_rate_were_a_freedom_that_no_candidate_showed() -> None:
    """Optimum of 14.064 s with three coasts at one rate."""
    walk = WalkProblem(
        velocities=(1.5888076732541556 + 1j, 2.602675641346975, -1),
        rates=(0.3, 0.3, 0.3),
        displacements=(-1.8373000695343864j, 0.02496306699768791j),
        turns=(1.119718890440231, 0.0),
    )
    start = np.exp(1j * 0.9147405836481046)
    goal = complex(6.017825671404803 + 10.536178517942208j) * start
    asked = replace(
        walk,
        goal=complex(goal),
        tolerance=0.5,
        heading=4.124208854854541 + 0.9147405836481046,
        heading_tolerance=0.0,
    )
    assert asked.solved()[0] == pytest.approx(14.064101826874719 - 1.0, abs=1e-9)
