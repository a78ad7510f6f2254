"""A planner whose answers are timed, apart from what else the machine does."""

from dataclasses import replace
from time import thread_time

from flight.automaton.library import Library
from flight.automaton.vehicle import Leg
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from planner.policies.adaptive_gamma import AdaptiveGammaPlanner
from planner.policies.policy import Planner


class TimedPlanner:
    """Answers as another planner does, and notes the processor's seconds of every answer.

    Args:
        planner: the one that answers.
        library: planned with.
    """

    def __init__(self, planner: Planner, library: Library) -> None:
        self._planner, self._library = planner, library
        self.times: list[float] = []

    def warm_up(self, mission: Mission) -> None:
        """Asks once from every trim, as before a departure: what a planner prepares once is prepared then."""
        for trim in self._library.trims:
            self._planner.plan(replace(mission, start_trim=trim.id))

    def learn(self, leg: Leg) -> None:
        """Hands a leg that was flown on to a planner that learns from it."""
        if isinstance(self._planner, AdaptiveGammaPlanner):
            self._planner.learn(leg)

    def plan(self, mission: Mission) -> Plan:
        """Returns the other planner's answer."""
        began = thread_time()
        plan = self._planner.plan(mission)
        self.times.append(round(thread_time() - began, 6))
        return plan
