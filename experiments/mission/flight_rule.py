"""Rules by which missions are flown: plans, or the policy with feedback."""

from typing import Protocol

from flight.automaton.vehicle import Vehicle
from flight.plan.plan import Plan
from flightlog.attachment_names import MISSION_PLAN_ATTACHMENT, PLANS_ATTACHMENT, POLICY_ATTACHMENT
from planner.closed_loop.flight_record import FlightRecord
from planner.closed_loop.receding_horizon import fly_closed_loop
from planner.policies.policy import Planner

from .feedback import stated_policy
from .mission_log import mission_plan_json, plans_json
from .mission_task import MissionTask
from .policies import planner_of
from .timed_planner import TimedPlanner


def plan_as_stated(task: MissionTask) -> Plan:
    """Returns the plan for the mission as stated, without latency.

    Raises:
        ValueError: the policy makes no plans.
    """
    return _planner(task).plan(task.stated_mission)


def _planner(task: MissionTask) -> Planner:
    if task.policy == "feedback":
        raise ValueError("the policy with feedback makes no plans")
    return planner_of(task.policy, task.library, gamma=task.gamma, max_nodes=task.max_nodes)


class FlightRule(Protocol):
    """Prepared rule by which a mission is flown."""

    @property
    def planned_time(self) -> float | None:
        """Seconds stated for the mission; None without."""

    @property
    def planning_times(self) -> tuple[float, ...]:
        """CPU seconds of each replan."""

    def attachments(self, flown: FlightRecord) -> dict[str, bytes]:
        """Returns what a log keeps beside the mission."""

    def fly(self, vehicle: Vehicle) -> FlightRecord:
        """Flies the mission."""


class PlanRule:
    """Flight rule of a task by plans."""

    def __init__(self, task: MissionTask) -> None:
        self._task = task
        self._stated = plan_as_stated(task)
        self._planner = TimedPlanner(_planner(task), task.library)
        self._planner.warm_up(task.mission)

    @property
    def planned_time(self) -> float | None:
        """Seconds of the plan for the mission as stated; None without one."""
        return self._stated.cost if self._stated.found else None

    @property
    def planning_times(self) -> tuple[float, ...]:
        """CPU seconds of each replan."""
        return tuple(self._planner.times)

    def attachments(self, flown: FlightRecord) -> dict[str, bytes]:
        """Returns what a log keeps beside the mission."""
        return {
            MISSION_PLAN_ATTACHMENT: mission_plan_json(self._task, self._stated),
            PLANS_ATTACHMENT: plans_json(flown),
        }

    def fly(self, vehicle: Vehicle) -> FlightRecord:
        """Flies the mission."""
        task = self._task
        return fly_closed_loop(
            vehicle,
            task.mission,
            planner=self._planner,
            library=task.library,
            settings=task.settings,
            on_leg=self._planner.learn,
        )


class FeedbackRule:
    """Flight rule of a task by the policy with feedback."""

    planning_times: tuple[float, ...] = ()

    def __init__(self, task: MissionTask) -> None:
        self._task = task
        self._stated = stated_policy(
            task.library, task.stated_mission, latency=task.settings.latency.configured
        )

    @property
    def planned_time(self) -> float | None:
        """Mean seconds stated; None where no flight arrives."""
        return self._stated.statement.mean

    def attachments(self, flown: FlightRecord) -> dict[str, bytes]:
        """Returns what a log keeps beside the mission."""
        plans = {PLANS_ATTACHMENT: plans_json(flown)} if flown.plans else {}
        return {POLICY_ATTACHMENT: self._stated.attachment, **plans}

    def fly(self, vehicle: Vehicle) -> FlightRecord:
        """Flies the mission."""
        return self._stated.fly(vehicle, self._task.stated_mission, self._task.settings)


def flight_rule(task: MissionTask) -> FlightRule:
    """Returns the rule of a task, prepared."""
    return FeedbackRule(task) if task.policy == "feedback" else PlanRule(task)
