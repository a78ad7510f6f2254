"""Odd missions in odd libraries: no plan is slower than the reference, none is missed, none ends elsewhere."""

import pytest

from tests.support.planning_study import study, tallied


def test_odd_missions_are_planned_as_well_as_the_reference_plans_them() -> None:
    tally = tallied(0, 0, 200)
    assert not tally.faults, tally.text()
    assert not tally.contradictions, tally.text()


@pytest.mark.slow
def test_many_odd_missions_are_planned_as_well_as_the_reference_plans_them(
    request: pytest.FixtureRequest, capsys: pytest.CaptureFixture[str]
) -> None:
    """`pytest tests/planner/kernel/test_planning_proof.py -m slow --missions 20000 --seed 1`."""
    missions, seed = request.config.getoption("--missions", 2000), request.config.getoption("--seed", 1)
    tally = study(seed, missions)
    with capsys.disabled():
        print("\n" + tally.text())
    assert not tally.faults
    assert not tally.contradictions
