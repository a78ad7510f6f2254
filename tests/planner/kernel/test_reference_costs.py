"""Tests of kernel costs against 1,500 stored reference costs."""

from math import isfinite

import pytest

from planner.policies.nominal import nominal_planner
from planner.policies.worst_case import worst_case_planner
from tests.oracles.least_time import natural_units
from tests.oracles.plan_judgement import BLURRED, SLOWER
from tests.oracles.reference_costs import SEED, ReferenceCosts, digest, read_costs
from tests.support.planning.odd_missions import odd_case

pytestmark = pytest.mark.kernel

PARTS = 10


@pytest.mark.parametrize("part", range(PARTS))
def test_odd_missions_cost_what_the_reference_found(part: int) -> None:
    costs = read_costs()[part::PARTS]
    assert costs
    wrong = [problem for one in costs for problem in problems(one)]
    assert not wrong, "\n".join(wrong)


def problems(one: ReferenceCosts) -> list[str]:
    case = odd_case(SEED, one.number)
    assert digest(case) == one.digest, "missions are drawn otherwise: write the file anew"
    _, seconds = natural_units(case.library, case.mission)
    wrong = []
    planners = (
        (nominal_planner(case.library), one.nominal),
        (worst_case_planner(case.library, case.gamma), one.worst_case),
    )
    for planner, cost in planners:
        plan = planner.plan(case.mission)
        near = (
            abs(plan.cost - cost) <= 2 * SLOWER * cost + BLURRED * seconds
            if isfinite(cost)
            else not plan.found
        )
        if not near or plan.status not in ("optimal", "infeasible"):
            wrong.append(
                f"odd_case({SEED}, {one.number}) {plan.policy}: {plan.status} {plan.cost!r} s, {cost} s"
            )
    return wrong
