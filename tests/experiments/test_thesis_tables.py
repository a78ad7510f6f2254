"""Tests of `maneuver thesis`: printed and computed tables."""

import pytest

from experiments.thesis.closed_loop_tables import PRINTED as FLOWN
from experiments.thesis.closed_loop_tables import compare_closed_loops, count_arrivals
from experiments.thesis.cost_tables import (
    PRINTED,
    PrintedCost,
    compare_cost,
    compare_examples,
    compare_sequence_counts,
)
from experiments.thesis.printed_libraries import thesis_gtmax
from maneuver.app import run


def test_table_11_is_reproduced() -> None:
    assert {row.verdict for row in compare_sequence_counts(thesis_gtmax())} == {"same"}


@pytest.mark.parametrize("printed", [row for row in PRINTED if row.table <= 17], ids=str)
def test_tables_12_to_17_are_reproduced(printed: PrintedCost) -> None:
    assert compare_cost(printed).verdict == "same"


def test_the_worst_case_of_table_18_differs_with_a_stated_reason() -> None:
    row = compare_cost(next(row for row in PRINTED if row.table == 18))
    assert row.computed == pytest.approx(20.678395, abs=1e-4)
    assert row.sequence == "1-3-5-2"
    assert "not reproduced" in row.verdict


def test_tables_19_to_26_are_shown_with_the_reason_why_they_differ() -> None:
    row = compare_cost(next(row for row in PRINTED if row.table == 19))
    assert row.computed == pytest.approx(16.721, abs=1e-3)
    assert "start trim is not printed" in row.verdict


def test_the_closed_loop_of_tables_17_and_22_reaches_the_goal() -> None:
    chosen = tuple(row for row in FLOWN if row.table in {17, 22})
    flights = list(compare_closed_loops(chosen))
    assert [row.printed_reached for row in flights] == [True, True, False, True]
    without_errors = flights[0]
    assert without_errors.minus == without_errors.plus
    assert without_errors.plus == pytest.approx(11.81, abs=0.01)
    assert "worst-case: 2 of 2 printed, 4 of 4 ours" in count_arrivals(flights)


def test_the_page_prints_every_table_as_markdown_too(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["thesis", "--markdown", "--no-closed-loop"]) == 0
    page = capsys.readouterr().out
    assert "| 13 | kinematic-1, worst case, gamma 0.3 | 21.07064123 | 21.070642 | 1-2-5-2 | same |" in page
    assert {len(line.split("|")) for line in page.splitlines() if line.startswith("|")} == {8}


def test_the_small_examples_are_reproduced_but_for_what_is_misprinted() -> None:
    verdicts = {(row.table, row.what): row.verdict for row in compare_examples()}
    assert "differs" not in verdicts.values()
    assert sum(verdict == "same" for (table, _), verdict in verdicts.items() if table == 33) == 24
    assert sum(verdict == "same" for (table, _), verdict in verdicts.items() if table == 4) == 5
    assert {table for table, _ in verdicts} == {4, 27, 29, 30, 31, 32, 33}
