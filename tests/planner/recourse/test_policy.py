"""Tests of the policy with feedback, its rollouts, its statement and its cache."""

from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest

from flight.automaton.maneuver import Maneuver
from flight.mission.mission import Mission
from flight.plan.policy_statement import PolicyStatement, is_statement, read_statement, statement_text
from flight.se2 import SE2
from planner.check.policy_rollouts import Situation, arrival_times, statement_problems
from planner.closed_loop.automaton_vehicle import AutomatonVehicle
from planner.closed_loop.feedback_loop import fly_with_feedback
from planner.policies.nominal import nominal_planner
from planner.recourse import cache
from planner.recourse.policy import FeedbackPolicy
from planner.recourse.problem import ShortestPathProblem
from planner.recourse.rollouts import roll_out
from planner.recourse.solve import Solution
from planner.recourse.statement import GoalHeadingError, feedback_policy, mission_rollouts, state_policy

from .small_problem import LEFT, STRAIGHT, TOLERANCE, small_library, small_table

MISSION = Mission(
    "beside", start=SE2(5.0, -3.0, 0.7), start_trim=STRAIGHT, goal=(2.0, 12.0), tolerance=TOLERANCE
)


@pytest.fixture(scope="module")
def policy() -> FeedbackPolicy:
    return FeedbackPolicy(small_library(), small_table())


@pytest.fixture(scope="module")
def statement(policy: FeedbackPolicy) -> PolicyStatement:
    return state_policy(
        policy,
        MISSION,
        mission_rollouts(policy, MISSION, seed=3, latency=0.05),
        seed=3,
        latency=0.05,
        error_free_time=10.0,
        by=15.0,
    )


def test_a_goal_straight_ahead_is_flown_to_by_coasting(policy: FeedbackPolicy) -> None:
    choice = policy.decide(SE2(0.0, 0.0, pi / 2), STRAIGHT, (0.0, 9.0))
    assert choice.maneuver is None
    assert choice.runner_up is not None
    assert choice.value < choice.runner_up_value


def test_a_decision_does_not_depend_on_where_in_the_world_it_is_taken(policy: FeedbackPolicy) -> None:
    here = policy.decide(SE2(0.0, 0.0, 0.0), STRAIGHT, (5.0, 5.0))
    goal = SE2(30.0, -7.0, 2.0) @ SE2(5.0, 5.0, 0.0)
    there = policy.decide(SE2(30.0, -7.0, 2.0), STRAIGHT, goal.position)
    assert there.maneuver == here.maneuver
    assert there.value == pytest.approx(here.value, abs=1e-9)


def test_a_turn_ends_after_a_full_circle(policy: FeedbackPolicy) -> None:
    # Left of the vehicle, in reach of its circle: coasting on is best until the circle is full.
    goal = (0.0, -2 * 2.0 / 0.8)
    assert policy.decide(SE2(0.0, 0.0, 0.0), LEFT, goal).maneuver is None
    assert policy.decide(SE2(0.0, 0.0, 0.0), LEFT, goal, coasted=2 * pi / 0.8).maneuver is not None


def test_rollouts_take_the_time_of_the_table(policy: FeedbackPolicy) -> None:
    rng = np.random.default_rng(8)
    errors = []
    for goal in rng.uniform(-15.0, 15.0, (30, 2)).tolist():
        rolled = roll_out(policy, trim=STRAIGHT, goal=(goal[0], goal[1]), count=300, rng=rng)
        errors.append(rolled.times.mean() - policy.table.times(np.array([0]), np.array([goal]))[0])
    # The standard error of the mean is about 0.02 s.
    assert abs(np.mean(errors)) <= 0.15


def decide(policy: FeedbackPolicy, mission: Mission, now: Situation) -> Maneuver | None:
    return policy.decide(
        now.pose, now.trim, mission.goal, coasted=now.coasted, previous=now.previous, offset=now.offset
    ).maneuver


def test_stated_times_pass_rollouts_of_other_code_and_changed_ones_do_not(
    policy: FeedbackPolicy, statement: PolicyStatement
) -> None:
    times = arrival_times(
        lambda now: decide(policy, MISSION, now),
        policy.library,
        MISSION,
        count=300,
        rng=np.random.default_rng(5),
        latency=0.05,
    )
    assert statement_problems(statement, times) == ()
    assert statement.mean is not None
    assert statement.within_90 is not None
    (problem,) = statement_problems(replace(statement, mean=statement.mean - 1.0), times)
    assert problem.startswith("mean: expected ")
    (problem,) = statement_problems(replace(statement, within_90=0.9 * statement.mean), times)
    assert problem.startswith("within_90: expected 90 %")


def test_a_statement_survives_its_file(statement: PolicyStatement, tmp_path: Path) -> None:
    path = tmp_path / "statement.json"
    path.write_text(statement_text(statement))
    assert is_statement(path)
    assert read_statement(path) == statement
    assert statement.deadline is not None
    assert statement.median is not None
    assert (statement.deadline.probability >= 0.5) == (statement.median <= 15.0)


def test_a_wanted_heading_is_refused() -> None:
    wanted = replace(MISSION, goal_heading=1.0, heading_tolerance=0.1)
    with pytest.raises(GoalHeadingError, match="expected a goal without a heading"):
        feedback_policy(small_library(), wanted)


def test_the_automaton_arrives_and_every_decision_is_recorded(
    policy: FeedbackPolicy, statement: PolicyStatement
) -> None:
    vehicle = AutomatonVehicle(policy.library, start=MISSION.start, trim=STRAIGHT, gamma=0.3)
    flown = fly_with_feedback(
        vehicle, MISSION, policy=policy, statement=statement, otherwise=nominal_planner(policy.library)
    )
    assert flown.reached
    assert flown.predicted_time == statement.mean
    chosen = [one for one in flown.decisions if one.choice]
    assert [one.choice for one in chosen] == [
        policy.library.maneuver(step.trim, step.to_trim).id for step in flown.steps if step.to_trim
    ]
    assert all(one.runner_up_cost > one.cost - 0.1 for one in chosen)


def test_an_overdue_flight_goes_on_by_nominal_plans_and_says_so(
    policy: FeedbackPolicy, statement: PolicyStatement
) -> None:
    vehicle = AutomatonVehicle(policy.library, start=MISSION.start, trim=STRAIGHT, gamma=0.0)
    flown = fly_with_feedback(
        vehicle,
        MISSION,
        policy=policy,
        statement=replace(statement, within_999=2.0),
        otherwise=nominal_planner(policy.library),
    )
    kinds = [one.kind.name for one in flown.decisions]
    assert "OVERDUE" in kinds
    assert len(flown.plans) > 0
    assert flown.reached


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(cache, "solve", lambda problem, *, threads: _coarse(problem, threads))
    return tmp_path / "costs"


def _coarse(problem: ShortestPathProblem, threads: int) -> Solution:
    values = np.zeros((3, problem.grid.levels, problem.grid.side, problem.grid.side), dtype=np.float32)
    return Solution(values, 0.01 * threads, 1)


def test_a_table_is_kept_and_a_torn_one_made_anew(own_cache: Path) -> None:
    made = cache.find_table(small_library(), tolerance=3.0)
    (path,) = own_cache.glob("*.costs")
    before = path.stat().st_ino
    assert cache.find_table(small_library(), tolerance=3.0).digest == made.digest
    assert path.stat().st_ino == before
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)
    assert cache.find_table(small_library(), tolerance=3.0).digest == made.digest
    assert path.read_bytes() != bytes(content)
    path.write_bytes(content[:5000])
    assert cache.find_table(small_library(), tolerance=3.0).digest == made.digest


def test_another_goal_or_library_has_a_table_of_its_own(own_cache: Path) -> None:
    cache.find_table(small_library(), tolerance=3.0)
    cache.find_table(small_library(), tolerance=3.0, goal_trim=LEFT)
    cache.find_table(small_library(duration=1.5), tolerance=3.0)
    assert len(list(own_cache.glob("*.costs"))) == 3


def test_the_oldest_tables_go_where_there_is_no_room(
    own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cache.find_table(small_library(), tolerance=3.0)
    (first,) = own_cache.glob("*.costs")
    monkeypatch.setattr(cache, "MOST_BYTES", int(1.5 * first.stat().st_size))
    cache.find_table(small_library(), tolerance=3.1)
    assert not first.exists()
    assert len(list(own_cache.glob("*.costs"))) == 1
