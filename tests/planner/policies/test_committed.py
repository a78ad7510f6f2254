"""Tests of committed plans: valid at every level, and optimal."""

import json
from dataclasses import replace
from functools import cache
from math import pi
from pathlib import Path
from time import perf_counter

import numpy as np
import pytest

from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission, read_mission
from flight.plan.plan import Plan, plan_text, read_plan
from flight.se2 import SE2, Twist
from maneuver.app import run
from planner.check.plan_check import plan_problems
from planner.commitment.committed import CommittedPlanner
from planner.policies.nominal import nominal_planner
from planner.policies.worst_case import worst_case_planner
from planner.walks.kinematics import walk_motion
from planner.walks.walk import walks
from scenarios.find import MISSIONS
from tests.oracles.statements import Question

AGREEMENT = 1e-3
"""Seconds or metres by which no other solver may be better."""


@cache
def case() -> tuple[Plan, Library, Mission]:
    """Returns a committed plan with its largest miss at an inner level."""
    mission = read_mission(MISSIONS / "gtmax-2.toml")
    return CommittedPlanner(thesis_gtmax(), 0.4).plan(mission), thesis_gtmax(), mission


def misses(plan: Plan, library: Library, mission: Mission, levels: int = 2001) -> np.ndarray:
    """Returns metres from end to goal at many levels."""
    every = np.linspace(-plan.gamma, plan.gamma, levels).tolist()
    ends = (walk_motion(library, plan.sequence, one).end(mission.start, plan.coasting_times) for one in every)
    return np.array([end.distance_to(mission.goal) for end in ends])


def straight(error: float) -> Library:
    """Returns a library of one trim of 2 m/s with uncertain speed."""
    return Library("straight", "", "", (Trim(1, "north", Twist(2.0, 0, 0), Twist(error, 0, 0)),), ())


def test_a_straight_coast_is_as_long_as_its_slowest_level_needs() -> None:
    mission = Mission("north", SE2.identity(), 1, (20.0, 0.0), tolerance=3.0, max_trims=1)
    plan = CommittedPlanner(straight(0.1), 1.0).plan(mission)
    assert plan.status == "optimal"
    assert plan.coasting_times == pytest.approx((17.0 / 1.9,), abs=1e-5)


def test_the_smallest_tolerance_is_half_the_distance_between_the_ends() -> None:
    # At t seconds the levels are at 1.9 t and 2.1 t: both are equally far from 20 m where t is 10 s.
    mission = Mission("north", SE2.identity(), 1, (20.0, 0.0), tolerance=0.9, max_trims=1)
    plan = CommittedPlanner(straight(0.1), 1.0).plan(mission)
    assert plan.status == "unknown"
    assert plan.at_smallest_tolerance is not None
    assert plan.at_smallest_tolerance.tolerance == pytest.approx(1.0, abs=1e-6)
    assert plan.at_smallest_tolerance.coasting_times == pytest.approx((10.0,), abs=1e-4)
    assert plan_problems(plan, straight(0.1), mission) == ()


def test_every_level_is_within_the_tolerance_not_only_the_ends() -> None:
    plan, library, mission = case()
    assert plan.status == "optimal"
    assert plan.verified
    found = misses(plan, library, mission)
    assert found.max() <= mission.tolerance
    assert plan.miss is not None
    assert found.max() <= plan.miss
    # The negative control: this plan misses most inside the interval, which the ends alone do not show.
    assert max(found[0], found[-1]) < found.max() - 0.01
    assert {scenario.coasting_times for scenario in plan.scenarios} == {plan.coasting_times}


def test_a_plan_that_holds_at_the_three_levels_of_the_worst_case_alone_is_refuted() -> None:
    plan, library, mission = case()
    shown = max(misses(plan, library, mission, levels=3))
    narrow = replace(mission, tolerance=float(shown) + 1e-6)
    shown = tuple(one for one in plan.scenarios if abs(one.gamma) in {0.0, plan.gamma})
    lie = replace(plan, tolerance=narrow.tolerance, miss=narrow.tolerance, scenarios=shown)
    assert any("near gamma" in problem for problem in plan_problems(lie, library, narrow))


def test_broken_committed_plans_are_rejected() -> None:
    plan, library, mission = case()
    assert plan.miss is not None
    learning = worst_case_planner(library, plan.gamma).plan(mission)
    lies = {
        "miss": replace(plan, miss=None),
        "near gamma": replace(plan, miss=plan.miss - 1e-3),
        "the same at every gamma": replace(learning, policy="committed", miss=0.9),
        "lower_bound": replace(plan, lower_bound=plan.cost - 0.01),
        "scenarios": replace(plan, scenarios=plan.scenarios[:2]),
    }
    for word, lie in lies.items():
        assert any(word in problem for problem in plan_problems(lie, library, mission)), word


def test_without_uncertainty_commitment_costs_nothing() -> None:
    mission = read_mission(MISSIONS / "gtmax-1.toml")
    committed = CommittedPlanner(thesis_gtmax(), 0.0).plan(mission)
    assert committed.policy == "committed"
    assert committed.cost == nominal_planner(thesis_gtmax()).plan(mission).cost
    assert plan_problems(committed, thesis_gtmax(), mission) == ()


def test_a_committed_plan_is_never_faster_than_one_that_learns_gamma_first() -> None:
    plan, library, mission = case()
    assert plan.cost >= worst_case_planner(library, plan.gamma).plan(mission).cost - 1e-6


def test_a_goal_out_of_reach_at_one_level_is_proved_so() -> None:
    mission = Mission("behind", SE2.identity(), 1, (-20.0, 0.0), tolerance=0.5, max_trims=1)
    plan = CommittedPlanner(straight(0.1), 1.0).plan(mission)
    assert plan.status == "infeasible"
    assert plan.at_smallest_tolerance is not None
    assert plan.at_smallest_tolerance.tolerance == pytest.approx(20.0, abs=1e-6)


def test_a_horizon_shorter_than_every_walk_leaves_nothing_to_look_at() -> None:
    plan = CommittedPlanner(thesis_gtmax(), 0.5, horizon=1.0).plan(replace(case()[2], goal_trim=1))
    assert plan.status == "unknown"
    assert "at most 1.0 s" in plan.reason
    assert "heading" not in plan.reason
    assert plan.at_smallest_tolerance is None


@pytest.mark.parametrize("heading", [None, 1.0])
def test_a_last_trim_that_no_walk_ends_with_is_proved_out_of_reach(heading: float | None) -> None:
    mission = replace(case()[2], max_trims=1, goal_trim=6, goal_heading=heading, heading_tolerance=0.1)
    plan = CommittedPlanner(thesis_gtmax(), 0.5).plan(mission)
    assert plan.status == "infeasible"
    assert plan.at_smallest_tolerance is None


def test_a_wanted_heading_is_had_at_every_level() -> None:
    library = thesis_gtmax()
    mission = replace(
        read_mission(MISSIONS / "gtmax-2.toml"),
        tolerance=4.0,
        max_trims=3,
        goal_heading=pi / 2,
        heading_tolerance=0.6,
    )
    plan = CommittedPlanner(library, 0.2).plan(mission)
    assert plan.found
    assert plan_problems(plan, library, mission) == ()
    ends = [
        walk_motion(library, plan.sequence, one).end(mission.start, plan.coasting_times)
        for one in np.linspace(-0.2, 0.2, 101).tolist()
    ]
    off = [abs(np.remainder(end.heading - pi / 2 + pi, 2 * pi) - pi) for end in ends]
    assert max(off) <= 0.6
    assert plan.cost >= CommittedPlanner(library, 0.2).plan(replace(mission, goal_heading=None)).cost - 1e-6


@pytest.mark.parametrize("seed", range(6))
def test_ipopt_finds_nothing_better(seed: int) -> None:
    rng = np.random.default_rng(seed)
    library = (thesis_gtmax(), thesis_kinematic())[seed % 2]
    angle, distance = rng.uniform(-pi, pi), rng.uniform(5, 40)
    goal = float(distance * np.cos(angle)), float(distance * np.sin(angle))
    mission = Mission("random", SE2.identity(), 1 + seed, goal, tolerance=(1.0, 4.0)[seed % 2], max_trims=2)
    planner = CommittedPlanner(library, 0.5)
    plan = planner.plan(mission)
    known = plan if plan.found else plan.at_smallest_tolerance
    assert known is not None
    assert plan_problems(plan, library, mission) == ()
    for walk in walks(library, mission.start_trim, max_trims=2):
        steps = library.maneuvers_along(walk)
        fixed = sum(step.duration for step in steps) + 0.5 * abs(sum(step.error.duration for step in steps))
        question = Question(library, walk, mission, 0.5, planner.horizon(mission) - fixed)
        for _ in range(3):
            near = question.smallest_tolerance(tuple(rng.exponential(6.0, len(walk)).tolist()))
            if near is None:
                continue
            if not plan.found:
                assert near[1] >= known.tolerance - AGREEMENT
            elif near[1] <= mission.tolerance:
                times = question.committed(near[0]) or near[0]
                assert fixed + sum(times) >= plan.cost - AGREEMENT


def test_a_deadline_is_kept_however_many_walks_there_are() -> None:
    mission = replace(read_mission(MISSIONS / "gtmax-2.toml"), max_trims=7)
    planner = CommittedPlanner(thesis_gtmax(), 0.5, deadline=0.5)
    began = perf_counter()
    plan = planner.plan(mission)
    # Half a second beyond, and as much again for a busy machine; without a deadline check it is far more.
    assert perf_counter() - began < 1.5
    assert plan.status in {"feasible", "unknown"}


def test_a_full_turn_may_undo_what_errors_do() -> None:
    # The turn's rate error undoes the maneuver's heading error after nearly two full turns, not before.
    trims = (
        Trim(1, "north", Twist(2.0, 0, 0), Twist(0, 0, 0)),
        Trim(2, "turn", Twist(2.0, 0, 1.0), Twist(0, 0, 0.03)),
    )
    maneuvers = (
        Maneuver(1, 1, 2, 1.0, SE2(2, 0, 0), ManeuverError(0, 0, 0, -0.3)),
        Maneuver(2, 2, 1, 1.0, SE2(2, 0, 0), ManeuverError(0, 0, 0, 0)),
    )
    library = Library("circling", "", "", trims, maneuvers)
    start = Mission("circling", SE2.identity(), 1, (0.0, 0.0), tolerance=0.7, max_trims=3)
    end = walk_motion(library, (1, 2, 1), 0.0).end(start.start, (0.0, 10.0, 20.0))
    plan = CommittedPlanner(library, 1.0).plan(replace(start, goal=end.position))
    assert plan.found
    assert plan.coasting_times[1] > 2 * pi


def test_the_verb_plans_and_checks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, mission = tmp_path / "plan.json", tmp_path / "north.toml"
    mission.write_text(
        'name = "north"\n[start]\nposition = [0, 0]\nheading = 0.0\ntrim = 1\n'
        "[goal]\nposition = [0, 30]\ntolerance = 0.5\n[planner]\nmax_trims = 2\n"
    )
    asked = ["plan", str(mission), "--library", "thesis-gtmax", "--policy", "committed", "--gamma", "0.5"]
    assert run([*asked, "--out", str(path)]) == 1
    assert "smallest feasible tolerance" in capsys.readouterr().out
    plan = read_plan(path)
    assert plan_text(plan) == path.read_text()
    assert plan.at_smallest_tolerance is not None
    assert run(["plan", "check", str(path), "--mission", str(mission)]) == 1
    content = json.loads(path.read_text())
    content["at_smallest_tolerance"]["coasting_times"][0] += 1.0
    path.write_text(json.dumps(content))
    assert run(["plan", "check", str(path), "--mission", str(mission)]) in {1, 2}
    assert "at_smallest_tolerance" in capsys.readouterr().out
    assert run([*asked, "--certify"]) == 2


def test_the_smallest_tolerance_falls_with_the_horizon_until_there_is_a_plan() -> None:
    mission = read_mission(MISSIONS / "gtmax-1.toml")
    plans = [
        CommittedPlanner(thesis_gtmax(), 0.5, horizon=seconds).plan(mission) for seconds in (5.0, 60.0, 100.0)
    ]
    still, short, long = plans
    assert short.at_smallest_tolerance is not None
    assert still.at_smallest_tolerance is not None
    assert "at most 60.0 s" in short.reason
    assert short.at_smallest_tolerance.cost <= 60.0
    assert mission.tolerance < short.at_smallest_tolerance.tolerance < still.at_smallest_tolerance.tolerance
    assert long.status == "optimal"
    assert 60.0 < long.cost <= 100.0


@pytest.mark.parametrize(
    ("asked", "got"),
    [
        (("--policy", "worst-case"), "got worst-case"),
        (("--policy", "committed", "--gamma", "0"), "expected --gamma above 0, got 0"),
        (("--policy", "committed", "--pareto"), "--pareto"),
    ],
)
def test_a_horizon_that_no_search_has_is_refused(
    asked: tuple[str, ...], got: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["plan", "gtmax-1", *asked, "--horizon", "60"]) == 2
    said = capsys.readouterr().err
    assert got in said
    assert said.count("\n") == 1


def test_a_search_stopped_early_is_feasible_and_its_bound_is_valid() -> None:
    _, library, mission = case()
    wide = replace(mission, tolerance=2.0)
    plan, early = (CommittedPlanner(library, 0.4, max_nodes=nodes).plan(wide) for nodes in (None, 1))
    assert (plan.status, early.status) == ("optimal", "feasible")
    assert early.lower_bound is not None
    assert early.lower_bound <= plan.cost < early.cost
    assert early.lower_bound < plan.cost - 0.01
    assert CommittedPlanner(library, 0.4, max_nodes=300).plan(mission).status == "unknown"
    late = CommittedPlanner(library, 0.4, deadline=0.0).plan(mission)
    assert late.status in {"feasible", "unknown"}
    assert plan_problems(late, library, mission) == ()
