"""Tests of the arrival verdict: position, heading, trim, on a plan, declared."""

import numpy as np
import pytest

from flight.mission.arrival import TrackSegment, judge_arrival
from flight.mission.destination import Destination

DISC = Destination((10.0, 0.0), 1.0)
EASTWARD = Destination((10.0, 0.0), 1.0, heading=1.5, heading_tolerance=0.1)
OTHER_HEADING = "the goal was passed with another heading than wanted"
SAFE_STOP = "the goal was passed on a safe stop, not on a plan"


def straight(
    begin: float, end: float, *, trim: int | None = 2, on_plan: bool = True, heading: float = 0.0
) -> TrackSegment:
    """Returns a flight north at 1 m/s from one north to another."""
    return TrackSegment(np.array([[begin, begin, 0.0, 0.0], [end, end, 0.0, 0.0]]), trim, on_plan)


def test_a_goal_that_is_met_declared_and_on_a_plan_is_reached() -> None:
    verdict = judge_arrival([straight(0, 8), straight(8, 12)], DISC, trim=2, declared=True)
    assert (verdict.reached, verdict.reason) == (True, "")
    assert verdict.time == pytest.approx(9.0, abs=1e-6)


@pytest.mark.parametrize(
    ("segment", "goal", "trim", "declared", "reason"),
    [
        (straight(0, 7), DISC, None, False, "3.00 m at the closest"),
        (straight(0, 7), DISC, None, True, "vehicle declared arrival, but the true miss was 3.00 m"),
        (straight(0, 12), DISC, 1, False, "the goal was passed in another trim than 1"),
        (straight(0, 12, trim=None), DISC, 1, False, "the goal was passed in another trim than 1"),
        (straight(0, 12, on_plan=False), DISC, None, False, SAFE_STOP),
        (straight(0, 12), EASTWARD, None, False, OTHER_HEADING),
        (straight(0, 12), DISC, None, False, "arrival was not declared"),
    ],
)
def test_what_is_missing_is_the_reason(
    segment: TrackSegment, goal: Destination, trim: int | None, declared: bool, reason: str
) -> None:
    verdict = judge_arrival([segment], goal, trim=trim, declared=declared)
    assert (verdict.reached, verdict.time, verdict.reason) == (False, None, reason)


def test_nothing_flown_reaches_nothing() -> None:
    verdict = judge_arrival([], DISC, trim=None, declared=False)
    assert (verdict.reached, verdict.closest, verdict.reason) == (False, None, "nothing was flown")
