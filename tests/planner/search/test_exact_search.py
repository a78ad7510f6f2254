"""Tests of the exact search: completeness, and stopped searches."""

from dataclasses import replace
from itertools import pairwise
from math import cos, inf, pi, sin
from pathlib import Path

import numpy as np
import pytest

import libraries
from experiments.thesis.printed_libraries import thesis_gtmax
from flight.automaton.library import Library
from flight.automaton.library_file import read_library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.se2 import SE2, Twist
from planner.kernel import build
from planner.kernel.exact import ExactSearch, least_costs
from planner.kernel.tables import tables
from planner.policies.nominal import nominal_planner
from planner.policies.worst_case import worst_case_planner
from planner.walks.goal_condition import reaches_goal
from planner.walks.kinematics import walk_motion
from tests.oracles.statements import worst_case
from tests.support.planning.random_missions import synthetic_library


def shipped() -> tuple[Library, ...]:
    return tuple(
        read_library(libraries.FOLDER / f"{name}.json")
        for name in ("thesis-kinematic", "thesis-gtmax", "gtmax-sim")
    )


def random_mission(rng: np.random.Generator, library: Library, max_trims: int) -> Mission:
    angle, distance = rng.uniform(-pi, pi), rng.uniform(1, 80)
    mission = Mission(
        "random",
        SE2(1.0, -2.0, float(rng.uniform(-pi, pi))),
        int(rng.choice([trim.id for trim in library.trims])),
        (1.0 + distance * cos(angle), -2.0 + distance * sin(angle)),
        float(rng.choice([0.0, 0.5, 3.0, 0.1 * distance])),
        max_trims=max_trims,
    )
    if rng.random() > 0.25:
        return mission
    width = float(rng.choice([0.0, 0.1, 0.5]))
    return replace(mission, goal_heading=float(rng.uniform(-pi, pi)), heading_tolerance=width)


@pytest.mark.kernel
@pytest.mark.parametrize("seed", range(40))
def test_bounds_leave_out_no_walk_that_is_best(seed: int) -> None:
    """Compares with `least_costs`, which excludes no walk."""
    rng = np.random.default_rng(seed)
    library = (*shipped(), synthetic_library(12, 60, seed=seed))[seed % 4]
    mission = random_mission(rng, library, 4)
    if seed % 3 == 0:
        width = float(rng.choice([0.0, 0.1, 0.5]))
        mission = replace(mission, goal_heading=float(rng.uniform(-pi, pi)), heading_tolerance=width)
    gammas = (0.0, -0.5, 0.5)
    levels = [tables(library, (gamma,), mission.start_trim, mission.max_trims, None) for gamma in gammas]
    worst = [
        np.max([least_costs(table, mission) for table in same], axis=0).min()
        for same in zip(*levels, strict=True)
    ]
    answer = ExactSearch(library, gammas).answer(mission)
    assert max(answer.costs, default=inf) == pytest.approx(min(worst), abs=1e-9)
    for gamma, times in zip(gammas, answer.times, strict=False):
        assert reaches_goal(walk_motion(library, answer.walk, gamma).end(mission.start, times), mission)


@pytest.mark.kernel
@pytest.mark.parametrize("seed", range(8))
def test_a_search_that_is_stopped_gives_a_bound_that_holds_and_a_plan_no_better(seed: int) -> None:
    rng = np.random.default_rng(seed)
    library = thesis_gtmax()
    mission = random_mission(rng, library, max_trims=4)
    best = worst_case_planner(library, 0.7).plan(mission)
    stopped = worst_case_planner(library, 0.7, max_nodes=40).plan(mission)
    assert stopped.cost >= best.cost - 1e-9
    assert stopped.lower_bound is not None
    assert stopped.lower_bound <= best.cost + 1e-9
    assert worst_case_planner(library, 0.7, max_nodes=40).plan(mission).scenarios == stopped.scenarios


@pytest.mark.kernel
def test_a_longer_walk_is_never_slower() -> None:
    mission = Mission("deep", SE2.identity(), 2, (20.0, -14.0), 0.0)
    costs = [
        worst_case_planner(thesis_gtmax(), 0.5).plan(replace(mission, max_trims=n)).cost for n in range(2, 7)
    ]
    assert costs == sorted(costs, reverse=True)


@pytest.mark.kernel
def test_the_walk_that_cost_its_own_bound_does_not_exclude_itself() -> None:
    library = shipped()[1]
    rng, tried = np.random.default_rng(5), 0
    for _ in range(20):
        mission = random_mission(rng, library, max_trims=4)
        plan = nominal_planner(library).plan(mission)
        if not plan.found or mission.goal_heading is not None:
            continue
        tried += 1
        # The goal moved to where this walk ends without any coasting at all.
        end = walk_motion(library, plan.sequence, 0.0).end(mission.start, (0.0,) * len(plan.sequence))
        there = nominal_planner(library).plan(replace(mission, goal=end.position, tolerance=0.5))
        assert there.cost <= walk_motion(library, plan.sequence, 0.0).fixed_time + 1e-9
    assert tried >= 5


@pytest.mark.kernel
def test_a_turn_that_leads_almost_exactly_into_a_straight_line_is_found() -> None:
    # The root lies 8e-6 rad before the end of its curve, beyond the last sample.
    mission = Mission(
        "long straight", SE2(-9.6283, -16.0214, -0.8197), 1, (49.5143, -34.1173), 6.18, goal_trim=3
    )
    table = tables(shipped()[0], (0.3,), 1, 4, 3)[-1]
    costs = dict(zip(map(tuple, table.walks.tolist()), least_costs(table, mission), strict=True))
    walk = (1, 4, 1, 3)
    by_ipopt = worst_case(shipped()[0], walk, mission, (0.3,), (0.0, 4.6, 50.0, 0.0))
    assert costs[walk] == pytest.approx(by_ipopt, abs=1e-5)


@pytest.mark.kernel
def test_a_deadline_gives_the_best_so_far_with_a_bound() -> None:
    library = shipped()[0]
    mission = Mission("soon", SE2.identity(), 3, (49.0, 8.0), 0.5, max_trims=8)
    planner = worst_case_planner(library, 0.5, deadline=0.002)
    planner.plan(mission)
    stopped = planner.plan(mission)
    assert stopped.status in {"feasible", "unknown"}
    assert "not proved" in stopped.reason or "no coasting times" in stopped.reason
    assert stopped.lower_bound is not None
    assert stopped.lower_bound < stopped.cost
    assert stopped.solve_time < 0.5


def test_machine_code_is_made_where_the_cache_is_and_only_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    build.load_kernel.cache_clear()
    assert build.load_kernel() is not None
    (made,) = (tmp_path / "maneuver-automaton").iterdir()
    written = made.stat().st_mtime_ns
    build.load_kernel.cache_clear()
    assert build.load_kernel() is not None
    assert made.stat().st_mtime_ns == written


@pytest.mark.kernel
@pytest.mark.parametrize("seed", range(6))
def test_a_wider_tolerance_never_costs_time_however_small_both_are(seed: int) -> None:
    rng, library = np.random.default_rng([77, seed]), shipped()[seed % 3]
    planner = nominal_planner(library)
    for _ in range(15):
        mission = random_mission(rng, library, 4)
        costs = [
            planner.plan(replace(mission, tolerance=tolerance)).cost
            for tolerance in (0.0, 1e-6, 3e-6, 1e-5, 1e-4, 1e-2)
        ]
        for narrow, wide in pairwise(costs):
            assert wide <= narrow + 1e-6, mission


@pytest.mark.kernel
@pytest.mark.parametrize("aside", [0.0, 1e-9, -1e-8, 1e-7, 1e-6])
def test_a_turn_that_ends_along_the_straight_before_it_is_found(aside: float) -> None:
    """Newton's equations are singular: both coasts move the end alike."""
    still = Twist(0.0, 0.0, 0.0)
    trims = (Trim(1, "ahead", Twist(10.0, 0.0, 0.0), still), Trim(2, "turn", Twist(10.0, 0.0, 0.005), still))
    step = Maneuver(1, 1, 2, 2.0, SE2(15.0, 1.0, -0.02), ManeuverError(0.0, 0.0, 0.0, 0.0))
    library = Library("along", "", "", trims, (step,))
    end = walk_motion(library, (1, 2), 0.0).end(SE2.identity(), (5.0, 4.0))
    mission = Mission("along", SE2.identity(), 1, (end.x, end.y + aside), tolerance=0.01, max_trims=2)
    plan = nominal_planner(library).plan(mission)
    assert plan.status == "optimal"
    assert plan.cost <= 11.0
