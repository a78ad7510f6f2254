"""Planner with measured CPU times."""

from dataclasses import replace
from time import thread_time

from flight.automaton.library import Library
from flight.automaton.vehicle import Leg
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from planner.policies.adaptive_gamma import AdaptiveGammaPlanner
from planner.policies.policy import Planner


class TimedPlanner:
    """Wrapper of a planner that records CPU times.

    Args:
        planner: the planner.
        library: library of the planner.
    """

    def __init__(self, planner: Planner, library: Library) -> None:
        self._planner, self._library = planner, library
        self.times: list[float] = []

    def warm_up(self, mission: Mission) -> None:
        """Plans once from every trim, to fill caches before the flight."""
        for trim in self._library.trims:
            self._planner.plan(replace(mission, start_trim=trim.id))

    def learn(self, leg: Leg) -> None:
        """Passes a flown leg to a planner that learns from it."""
        if isinstance(self._planner, AdaptiveGammaPlanner):
            self._planner.learn(leg)

    def plan(self, mission: Mission) -> Plan:
        """Returns the planner's plan and records its CPU time."""
        began = thread_time()
        plan = self._planner.plan(mission)
        self.times.append(round(thread_time() - began, 6))
        return plan
