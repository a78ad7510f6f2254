"""Tests of the CasADi statements: gradients, and IPOPT's optima."""

from math import cos, pi, sin

import casadi
import numpy as np
import pytest

from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.mission.mission import Mission
from flight.se2 import SE2
from planner.policies.nominal import nominal_planner
from planner.policies.price_of_robustness import PriceOfRobustness
from planner.policies.worst_case import worst_case_planner
from planner.walks.walk import walks
from tests.oracles.price_statement import largest_level, state_price
from tests.oracles.statements import state_committed, state_smallest_tolerance, state_worst_case, worst_case

AGREEMENT = 1e-4
"""Seconds by which IPOPT may be faster."""

LEVEL = 1e-4
"""By how much the largest level of IPOPT and of the planner may differ."""

STATEMENTS = {
    "worst case": state_worst_case(3, 3),
    "committed": state_committed(3, 3, heading=True),
    "price of robustness": state_price(3),
    "smallest tolerance": state_smallest_tolerance(3, 2, heading=False),
}


@pytest.mark.parametrize("name", STATEMENTS)
def test_gradients_are_those_of_finite_differences(name: str) -> None:
    problem = STATEMENTS[name].problem
    x, p, g = problem["x"], problem["p"], problem["g"]
    assert g.numel() == len(STATEMENTS[name].rows)
    value = casadi.Function("g", [x, p], [g])
    slope = casadi.Function("slope", [x, p], [casadi.jacobian(g, x)])
    rng = np.random.default_rng(0)
    here, numbers = rng.uniform(1, 3, x.numel()), rng.uniform(0.2, 1, p.numel())
    step, found = 1e-6, np.array(slope(here, numbers).full())
    for place in range(len(here)):
        off = step * np.eye(len(here))[place]
        change = (value(here + off, numbers) - value(here - off, numbers)).full().ravel() / (2 * step)
        assert found[:, place] == pytest.approx(change, rel=1e-5, abs=1e-5)


@pytest.mark.parametrize("seed", [0, 3, 4, 6])  # there is no plan with seed 0
def test_ipopt_on_the_joint_problem_finds_no_faster_worst_case(seed: int) -> None:
    rng = np.random.default_rng(seed)
    library, gamma = (thesis_gtmax(), thesis_kinematic())[seed % 2], float(rng.choice([0.3, 1.0]))
    angle, distance = rng.uniform(-pi, pi), rng.uniform(5, 40)
    goal = float(distance * cos(angle)), float(distance * sin(angle))
    mission = Mission("random", SE2.identity(), 1 + seed, goal, tolerance=1.0, max_trims=2)
    plan = worst_case_planner(library, gamma).plan(mission)
    reached = 0
    for walk in walks(library, mission.start_trim, max_trims=2):
        starts = [rng.exponential(6.0, len(walk)).tolist() for _ in range(3)]
        # Random starts do not always lead to the goal; those of the plan do.
        starts += [scenario.coasting_times for scenario in plan.scenarios if walk == plan.sequence]
        for start in starts:
            cost = worst_case(library, walk, mission, (0.0, -gamma, gamma), start)
            assert cost >= plan.cost - AGREEMENT
            reached += cost < np.inf
    assert plan.found == (seed > 0)
    assert bool(reached) == plan.found


@pytest.mark.parametrize("seed", range(6))
def test_ipopt_finds_no_larger_level_at_the_price_and_confirms_that_of_the_plan(seed: int) -> None:
    rng = np.random.default_rng(seed)
    library, alpha = (thesis_gtmax(), thesis_kinematic())[seed % 2], float(rng.uniform(1.05, 1.5))
    nominal = None
    while nominal is None or not nominal.found:
        angle, distance = rng.uniform(-pi, pi), rng.uniform(10, 40)
        goal = float(distance * cos(angle)), float(distance * sin(angle))
        mission = Mission("random", SE2.identity(), 1 + seed, goal, tolerance=1.0, max_trims=2)
        nominal = nominal_planner(library).plan(mission)
    plan = PriceOfRobustness(library, alpha).plan(mission)
    limit, levels = alpha * nominal.cost, []
    for walk in walks(library, mission.start_trim, max_trims=2):
        starts = [([rng.exponential(6.0, len(walk)).tolist()] * 3, 0.1) for _ in range(3)]
        if walk == plan.sequence and len(plan.scenarios) == 3:
            starts.append(([one.coasting_times for one in plan.scenarios], plan.gamma))
        levels += [largest_level(library, walk, mission, limit, start) for start in starts]
    assert max(levels) == pytest.approx(plan.gamma, abs=LEVEL)
