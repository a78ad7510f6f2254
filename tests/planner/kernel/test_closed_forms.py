"""Tests of closed-form candidates."""

import pytest

from .walk_problem import WalkProblem

pytestmark = pytest.mark.kernel


def test_two_straight_coasts_after_a_turn_take_the_direction_of_both() -> None:
    """Checks the multiplier's conjugation: 28.489 s was wrong."""
    walk = WalkProblem(
        velocities=(3, 3, -2),
        rates=(-0.4, 0.0, 0.0),
        displacements=(1.3003303548017833 + 0.11372624087499039j, 2.290282280338653 + 1.003321233580687j),
        turns=(-0.6749093461705712, 0.35848091391652726),
        goal=-3.800585569445308 - 11.406050611805465j,
        tolerance=1.0,
    )
    cost, times = walk.solved()
    assert cost == pytest.approx(11.570738, abs=1e-6)
    assert times == pytest.approx((7.95997, 1.71727, 1.89349), abs=1e-5)
    # Both straight coasts are worth their seconds with the multiplier that points from the goal to the end.
    end, _ = walk.end(times)
    outward = (end - walk.goal) / abs(end - walk.goal)
    along = [(outward.conjugate() * velocity).real for velocity in walk.end_velocities(times)]
    assert along[1:] == pytest.approx([along[0]] * 2, abs=1e-6)
