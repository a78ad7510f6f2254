"""A worst-case planner whose gamma follows the measured turbulence."""

from flight.automaton.library import Library
from flight.automaton.vehicle import Leg
from flight.mission.mission import Mission
from flight.plan.plan import Plan

from .policy import Planner
from .worst_case import worst_case_planner

GAMMAS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Levels that are planned for."""


class AdaptiveGammaPlanner:
    """Planner with gamma scaled by present over identification turbulence.

    Errors grow with the gusts that make them, so the level is the wind at 20 ft that the vehicle shows over
    that of the library; where it blows harder, and before anything is known, it is that of the library.

    Args:
        library: the primitives.
        wind_at_20_ft: in which they were identified, m/s.
        max_nodes: deadline of each planning, as for the worst case.

    Attributes:
        gamma: level that is planned for now.
    """

    def __init__(self, library: Library, wind_at_20_ft: float, *, max_nodes: int | None = None) -> None:
        self._planners: dict[float, Planner] = {
            gamma: worst_case_planner(library, gamma, max_nodes=max_nodes) for gamma in GAMMAS
        }
        self._wind = wind_at_20_ft
        self.gamma = GAMMAS[-1]

    def learn(self, leg: Leg) -> None:
        """Updates the turbulence from a leg."""
        if leg.turbulence is not None:
            share = leg.turbulence / self._wind if self._wind else 1.0
            self.gamma = min(GAMMAS, key=lambda gamma: abs(gamma - share))

    def plan(self, mission: Mission) -> Plan:
        """Returns the plan at the level of the present turbulence.

        Raises:
            UnknownTrimError: the library lacks the start or goal trim.
        """
        return self._planners[self.gamma].plan(mission)
