"""Tests of the scorecard: proportions, quantiles and time bounds."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import libraries
from experiments.validation.scorecard import Proportion, quantile, scorecard_cells, scorecard_totals
from experiments.validation.time_bound_trial import find_time_bounds, time_bound_trials, time_factor
from flight.automaton.library_file import library_hash, read_library
from flight.plan.plan import read_plan
from flight.plan.time_bound import TimeBound, read_time_bounds, time_bounds_path, time_bounds_text
from maneuver.app import run
from tests.support.mission_results import result


def test_a_cell_counts_arrivals_and_flights_within_the_predicted_time() -> None:
    rows = [result("a", 0, flown=9.0), result("a", 1, flown=11.0), result("a", 2, flown=5.0, reached=False)]
    (cell,) = scorecard_cells(rows)
    assert (cell.reached.count, cell.inside.count, cell.flights) == (2, 1, 3)
    assert cell.flown_time == 10.0
    assert cell.flown_time_95 is None  # a third of the flights does not reach the goal
    assert cell.miss == 3.0
    # Wilson's interval of 2 of 3, by its formula.
    z, n, p = 1.959963984540054, 3, 2 / 3
    middle, half = p + z * z / (2 * n), z * (p * (1 - p) / n + z * z / (4 * n * n)) ** 0.5
    assert cell.reached.low == pytest.approx((middle - half) / (1 + z * z / n))
    assert cell.reached.high == pytest.approx((middle + half) / (1 + z * z / n))


def test_all_missions_together_are_a_cell_of_their_own() -> None:
    rows = [result(name, number) for name in "abc" for number in range(4)]
    (whole,) = scorecard_totals(rows)
    assert (whole.mission, whole.flights, len(scorecard_cells(rows))) == ("all", 12, 3)


def test_a_quantile_is_a_value_that_so_many_keep() -> None:
    assert quantile([3.0, 1.0, 2.0, 4.0], 0.5) == 2.0
    assert quantile([3.0, 1.0, 2.0, 4.0], 0.51) == 3.0
    assert quantile([7.0], 0.99) == 7.0


def test_a_bound_found_on_some_missions_holds_on_others() -> None:
    rng = np.random.default_rng(5)
    rows = [result(f"m{n % 400}", n, flown=float(10 * rng.lognormal(0, 0.3))) for n in range(2000)]
    (bound,) = time_bound_trials(rows, share=0.9)
    # Of 200 missions the 188th: the 94 % quantile bounds 90 % with 95 % confidence.
    assert bound.factor == pytest.approx(np.exp(0.3 * 1.555), rel=0.06)
    assert bound.kept.low < 0.94 < bound.kept.high


def test_too_few_flights_give_no_bound() -> None:
    rows = [result(name, number) for name in "ab" for number in range(3)]
    (bound,) = time_bound_trials(rows, share=0.9)
    assert bound.factor is None
    assert bound.kept.count == 0


def test_a_flight_of_a_mission_that_is_flown_often_counts_for_less() -> None:
    """Weights missions, not flights: ninety flights of one mission count once."""
    slow = [result("slow", n, flown=50.0) for n in range(90)]
    quick = [[result(f"quick {n}", 0, flown=10.0 + n)] for n in range(39)]
    # If 90 % are within, at least 39 of 40 missions are with a probability of 8 %, all 40 with 1.5 %.
    assert time_factor([slow, *quick], 0.9) == 5.0
    # If 80 % are within, at least 36 are with a probability of 4.3 %.
    assert time_factor([slow, *quick], 0.8) == pytest.approx(4.6)
    assert time_factor([slow, *quick], 0.95) == np.inf


def test_where_flights_of_a_mission_resemble_one_another_the_bound_still_holds() -> None:
    """Tests a bound from 40 missions with five flights each."""
    rng = np.random.default_rng(8)
    kept = []
    for _ in range(200):
        made = [
            [result(f"m{k}", n, flown=float(10 * slow * rng.lognormal(0, 0.05))) for n in range(5)]
            for k, slow in enumerate(rng.lognormal(0, 0.3, 40))
        ]
        factor = time_factor(made, 0.9)
        others = rng.lognormal(0, 0.3, 500) * rng.lognormal(0, 0.05, 500)
        kept.append(float((others <= factor).mean()))
    # One bound in twenty may fail.
    assert np.mean(np.array(kept) < 0.9) <= 0.1
    assert np.mean(kept) < 0.99


def test_shares_of_groups_have_the_interval_of_so_many_groups() -> None:
    alone = Proportion.of_groups([[True]] * 45 + [[False]] * 5)
    often = Proportion.of_groups([[True] * 7] * 45 + [[False] * 7] * 5)
    rows = [result("a", n, reached=n < 45) for n in range(50)]
    counted = Proportion.counted(rows, lambda row: row.reached)
    assert (alone.low, alone.high) == pytest.approx((counted.low, counted.high))
    assert (often.low, often.high) == pytest.approx((alone.low, alone.high))
    assert (often.count, often.of) == (315, 350)


def stated(seed: int) -> TimeBound:
    return TimeBound("worst-case", 1.0, "gtmax", 0.9, 1.5, missions=100, flights=100, seed=seed)


def test_a_stated_bound_is_tested_on_all_missions_but_those_it_was_found_on() -> None:
    rows = [result(f"m{n}", n, flown=14.0 if n % 2 else 16.0) for n in range(40)]
    (fresh,) = time_bound_trials(rows, share=0.9, stated=[stated(2)], seed=1)
    assert (fresh.stated, fresh.factor, fresh.kept.count, fresh.kept.of) == (True, 1.5, 20, 40)
    (own,) = time_bound_trials(rows, share=0.9, stated=[stated(1)], seed=1)
    assert (own.stated, own.kept.of) == (False, 20)


def test_the_time_bound_is_stored_with_the_plan(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    library = tmp_path / "mine.json"
    library.write_text((libraries.FOLDER / "gtmax-sim.json").read_text())
    own = library_hash(read_library(library))
    (made,), lacking = find_time_bounds(
        [result(f"m{n}", n, flown=10.0 + n / 10) for n in range(40)], share=0.9, seed=3
    )
    assert lacking == ()
    file = time_bounds_path(library)
    file.write_text(time_bounds_text([made], library_hash=own, command="maneuver validate"))
    assert read_time_bounds(library, library_hash=own) == (made,)
    out = tmp_path / "plan.json"
    assert run(("plan", "gtmax-2", "--library", str(library), "--out", str(out))) == 0
    plan = read_plan(out)
    bound = plan.time_promise
    assert bound is not None
    assert bound.time is not None
    assert replace(bound, time=None) == made
    # The loop aims inside the tolerance and has planning latency, so the bound is a little longer.
    assert made.factor * plan.cost < bound.time < made.factor * (plan.cost + 1.0)
    output = capsys.readouterr().out.replace("\n", " ")
    assert f"90 % of flights finish within {bound.time:.1f} s" in output
    # There is no bound for the nominal policy.
    assert run(("plan", "gtmax-2", "--library", str(library), "--policy", "nominal")) == 0
    assert "of flights are there" not in capsys.readouterr().out
    file.write_text(time_bounds_text([made], library_hash="0" * 64, command="maneuver validate"))
    assert run(("plan", "gtmax-2", "--library", str(library))) == 0
    printed = capsys.readouterr()
    assert "of flights are there" not in printed.out
    assert "mine.times.toml is for another library: no time bound is stated" in printed.err


def test_too_few_missions_give_no_time_bound() -> None:
    made, lacking = find_time_bounds([result("a", n) for n in range(30)], share=0.9, seed=3)
    assert (made, lacking) == ((), ("worst-case",))
