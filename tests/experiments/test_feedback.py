"""Tests of helicopter flights by the policy with feedback, their logs and their repetition."""

from dataclasses import replace

import numpy as np
import pytest

from experiments.mission.feedback import FEEDBACK, MeasuredLatencyError, stated_policy
from experiments.mission.fly import fly_and_log
from experiments.mission.mission_task import MissionTask
from experiments.mission.repeat import repeat_flight
from experiments.mission.result import MissionResult
from experiments.validation.policy_picture import policy_picture
from flight.plan.policy_statement import PolicyStatement
from flight.schema import parse_json
from flightlog.attachment_names import POLICY_ATTACHMENT
from flightlog.decision import DECISION, DecisionKind
from flightlog.file.writer import log_bytes
from flightlog.log import FlightLog
from maneuver.plan.feedback import statement_faults
from planner.closed_loop.latency import Latency
from planner.closed_loop.settings import Settings
from scenarios.find import find_library, find_mission
from sim.replay import VehicleMismatchError

LIBRARY, MISSION = find_library("gtmax-sim"), find_mission("gtmax-1")
TASK = MissionTask(MISSION, LIBRARY, "feedback", 0.0, "gtmax", seed=5)


@pytest.fixture(scope="module")
def flown() -> tuple[MissionResult, FlightLog]:
    result, log = fly_and_log(TASK)
    assert log is not None
    return result, log


def test_a_flight_predicts_the_stated_mean_and_arrives(flown: tuple[MissionResult, FlightLog]) -> None:
    result, log = flown
    statement = parse_json(log.attachments[POLICY_ATTACHMENT], POLICY_ATTACHMENT, PolicyStatement)
    assert result.policy == FEEDBACK
    assert result.reached
    assert result.predicted_time == result.planned_time == statement.mean


def test_every_decision_of_a_log_has_its_value_and_a_slower_runner_up(
    flown: tuple[MissionResult, FlightLog],
) -> None:
    decisions = flown[1][DECISION]
    chosen = decisions["kind"] == DecisionKind.ADOPTED
    assert chosen.any()
    assert (decisions["choice"][chosen] > 0).all()
    judged = (decisions["runner_up_cost"] > 0) & (decisions["kind"] <= DecisionKind.KEPT)
    # A coast may be up to the table's error slower than the maneuver that it is preferred to.
    assert (decisions["cost"][judged] <= decisions["runner_up_cost"][judged] + 0.05).all()
    assert np.all(np.diff(decisions["activation"][judged]) >= 1)


def test_a_flight_is_repeated_to_the_byte(flown: tuple[MissionResult, FlightLog]) -> None:
    log = flown[1]
    assert log_bytes(repeat_flight(log)) == log_bytes(log)


def test_a_log_of_another_table_is_not_repeated(flown: tuple[MissionResult, FlightLog]) -> None:
    log = flown[1]
    text = log.attachments[POLICY_ATTACHMENT].replace(b'"table": "', b'"table": "0')
    other = replace(log, attachments={**log.attachments, POLICY_ATTACHMENT: text})
    with pytest.raises(VehicleMismatchError, match="expected the table of costs of the log, 0"):
        repeat_flight(other)


def test_a_statement_passes_its_check_and_another_library_or_table_does_not() -> None:
    statement = stated_policy(LIBRARY, MISSION).statement
    assert statement_faults(statement, LIBRARY) == ()
    (fault,) = statement_faults(statement, find_library("thesis-gtmax"))
    assert fault.startswith("library_hash: expected that of thesis-gtmax")
    (fault,) = statement_faults(replace(statement, table="0"), LIBRARY)
    assert fault.endswith(", got 0")


def test_the_picture_has_a_track_for_every_flight_that_is_kept() -> None:
    answer = stated_policy(LIBRARY, MISSION, tracks=20)
    axes = policy_picture(answer, MISSION).axes[0]
    assert len(answer.rollouts.tracks) == 20
    assert len(axes.lines) >= 20
    ends = np.array([np.hypot(*(track[-1] - answer_goal())) for track in answer.rollouts.tracks])
    # The last decision lies within one chord of the goal.
    assert ends.max() < 10.0


def answer_goal() -> np.ndarray:
    seen = MISSION.start.inverse() @ replace(MISSION.start, x=MISSION.goal[0], y=MISSION.goal[1])
    return np.array([seen.x, seen.y])


def test_a_measured_latency_is_refused() -> None:
    with pytest.raises(MeasuredLatencyError, match="got measured"):
        fly_and_log(replace(TASK, settings=Settings(latency=Latency(measured=True))))
