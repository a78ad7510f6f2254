"""Tests of plans of odd missions in odd libraries against the reference."""

import pytest

from planner.policies.nominal import nominal_planner
from tests.support.planning.odd_missions import odd_case
from tests.support.planning.planning_study import prove, tallied
from tests.support.studies.study import Study


def test_odd_missions_are_planned_as_well_as_the_reference_plans_them() -> None:
    tally = tallied(0, 0, 200)
    assert not tally.faults, tally.text()
    assert not tally.contradictions, tally.text()


@pytest.mark.parametrize(("seed", "number", "seconds"), [(14, 214, 3.1959873666), (12, 772, 2.5786415)])
def test_a_path_that_touches_the_goal_is_found(seed: int, number: int, seconds: float) -> None:
    """Newton's method left the touching solution for one a circle later; a bound ignored the slack."""
    case = odd_case(seed, number)
    plan = nominal_planner(case.library).plan(case.mission)
    assert plan.status == "optimal"
    # The slow turn of the second case may use the slack for its heading.
    assert plan.cost == pytest.approx(seconds, abs=5e-4)
    assert plan.cost <= seconds + 1e-6


@pytest.mark.slow
def test_many_odd_missions_are_planned_as_well_as_the_reference_plans_them(
    study: Study,
) -> None:
    """Runs by `pytest tests/planner/kernel/test_planning_proof.py -m slow --missions 20000 --seed 1`."""
    tally = prove(study.size("seed", 1), study.size("missions", 2000), processes=study.size("workers", 2))
    study.show(tally.text())
    assert not tally.faults
    assert not tally.contradictions
