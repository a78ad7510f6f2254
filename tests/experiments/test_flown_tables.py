"""Tests of the closed-loop Tables 12 to 26 against the printed ones."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from experiments.thesis import flown_tables
from experiments.thesis.flown_tables import (
    LoopComparison,
    compare_loops,
    loops_csv,
    loops_markdown,
    printed_loops,
)


def test_the_printed_pattern_is_nominal_3_of_15_and_worst_case_14_of_15() -> None:
    lines = list(printed_loops())
    reached = {
        policy: sum(not line.gave_up for line in lines if line.policy == policy)
        for policy in ("nominal", "worst-case")
    }
    assert reached == {"nominal": 3, "worst-case": 14}
    slower = [
        line for line in lines if line.policy == "worst-case" and line.gamma > 0 and line.flight > line.plan
    ]
    assert len(slower) == 5


@pytest.fixture(scope="module")
def table_18() -> list[LoopComparison]:
    with pytest.MonkeyPatch.context() as patch, ThreadPoolExecutor(1) as executor:
        lines = [line for line in printed_loops() if line.table == 18]
        patch.setattr(flown_tables, "printed_loops", lambda: iter(lines))
        return compare_loops(executor)


def test_the_worst_case_is_faster_in_flight_than_its_plan_at_both_signs(
    table_18: list[LoopComparison],
) -> None:
    nominal, worst = table_18
    assert (nominal.policy, worst.policy) == ("nominal", "worst-case")
    assert worst.plan == pytest.approx(20.6783955, abs=1e-4)
    for time in (worst.our_loop_minus, worst.our_loop_plus):
        assert time is not None
        assert time <= 20.6783955
    # The negative control: the nominal plan does not survive the same errors.
    assert nominal.our_loop_minus is None


def test_the_tables_are_written_as_markdown_and_csv(table_18: list[LoopComparison]) -> None:
    text = loops_markdown(table_18)
    assert "gave up at 68.52" in text
    assert len(text.splitlines()) == 2 + len(table_18)
    rows = loops_csv(table_18).splitlines()
    assert rows[0].startswith("table,mission,gamma,policy,printed_plan")
    assert len(rows) == 1 + len(table_18)
