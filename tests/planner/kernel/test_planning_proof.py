"""Tests of plans of odd missions in odd libraries against the reference."""

import pytest

from tests.support.planning.planning_study import prove, tallied
from tests.support.studies.study import Study


def test_odd_missions_are_planned_as_well_as_the_reference_plans_them() -> None:
    tally = tallied(0, 0, 200)
    assert not tally.faults, tally.text()
    assert not tally.contradictions, tally.text()


@pytest.mark.slow
def test_many_odd_missions_are_planned_as_well_as_the_reference_plans_them(
    study: Study,
) -> None:
    """Runs by `pytest tests/planner/kernel/test_planning_proof.py -m slow --missions 20000 --seed 1`."""
    tally = prove(study.size("seed", 1), study.size("missions", 2000), processes=study.size("workers", 2))
    study.show(tally.text())
    assert not tally.faults
    assert not tally.contradictions
