"""The scorecard: shares with their intervals, quantiles, and promises that hold on other missions."""

import numpy as np
import pytest

from maneuver.mission_flights import MissionResult
from maneuver.scorecard import promises, quantile, scorecard, totals


def result(mission: str, number: int, *, flown: float = 10.0, reached: bool = True) -> MissionResult:
    return MissionResult(
        mission=mission,
        policy="worst-case",
        gamma=1.0,
        plant="helicopter",
        wind="gtmax",
        seed=number,
        reached=reached,
        claimed=reached,
        flown_time=flown,
        predicted_time=10.0,
        closest=0.5 if reached else 3.0,
        activations=20,
        failures=0,
        fallbacks=0,
        reason="reached the goal" if reached else "lost",
        log=None,
        planning_times=(0.001, 0.002),
    )


def test_a_cell_counts_what_reached_the_goal_and_what_kept_the_prediction() -> None:
    rows = [result("a", 0, flown=9.0), result("a", 1, flown=11.0), result("a", 2, flown=5.0, reached=False)]
    (cell,) = scorecard(rows)
    assert (cell.reached.count, cell.inside.count, cell.flights) == (2, 1, 3)
    assert cell.flown_time == 10.0
    assert cell.flown_time_95 is None  # a third of the flights never arrives
    assert cell.miss == 3.0
    # Wilson's interval of 2 of 3, by its formula.
    z, n, p = 1.959963984540054, 3, 2 / 3
    middle, half = p + z * z / (2 * n), z * (p * (1 - p) / n + z * z / (4 * n * n)) ** 0.5
    assert cell.reached.low == pytest.approx((middle - half) / (1 + z * z / n))
    assert cell.reached.high == pytest.approx((middle + half) / (1 + z * z / n))


def test_all_missions_together_are_a_cell_of_their_own() -> None:
    rows = [result(name, number) for name in "abc" for number in range(4)]
    (whole,) = totals(rows)
    assert (whole.mission, whole.flights, len(scorecard(rows))) == ("all", 12, 3)


def test_a_quantile_is_a_value_that_so_many_keep() -> None:
    assert quantile([3.0, 1.0, 2.0, 4.0], 0.5) == 2.0
    assert quantile([3.0, 1.0, 2.0, 4.0], 0.51) == 3.0
    assert quantile([7.0], 0.99) == 7.0


def test_a_promise_made_on_some_missions_is_kept_on_others() -> None:
    rng = np.random.default_rng(5)
    rows = [result(f"m{n % 40}", n, flown=float(10 * rng.lognormal(0, 0.3))) for n in range(2000)]
    (promise,) = promises(rows, share=0.9)
    assert promise.factor == pytest.approx(np.exp(0.3 * 1.2816), rel=0.06)
    assert promise.kept.low < 0.9 < promise.kept.high


def test_too_few_flights_promise_nothing() -> None:
    rows = [result(name, number) for name in "ab" for number in range(3)]
    (promise,) = promises(rows, share=0.9)
    assert promise.factor is None
    assert promise.kept.count == 0
