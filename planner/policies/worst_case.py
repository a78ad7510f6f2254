"""The worst-case policy: the walk whose worst uncertainty level is fastest (thesis, Problem 6.2)."""

from math import inf

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from planner.walks.kinematics import check_gamma

from .policy import LibraryPlanner


class WorstCase:
    """Plans for the levels 0, -gamma and +gamma at once, the coasting times chosen anew at each.

    That promises a time for whoever learns the level before flying. It is not a promise for one set of
    coasting times flown at an unknown level: that is Problem 8.1.

    Args:
        library: the primitives.
        gamma: uncertainty level, from 0 (nominal) to 1 (the errors of the library).
        max_nodes: as for `LibraryPlanner`.
        deadline: as for `LibraryPlanner`.

    Raises:
        GammaError: the level is outside [0, 1].
        NegativeDurationError: the level turns a maneuver's duration negative.
    """

    def __init__(
        self, library: Library, gamma: float, *, max_nodes: int | None = None, deadline: float = inf
    ) -> None:
        check_gamma(gamma)
        gammas = (0.0, -gamma, gamma) if gamma else (0.0,)
        self._planner = LibraryPlanner(
            library, policy="worst-case", gamma=gamma, gammas=gammas, max_nodes=max_nodes, deadline=deadline
        )

    def plan(self, mission: Mission) -> Plan:
        """Returns the plan with the least worst time found, or an honest no.

        Raises:
            UnknownTrimError: the library lacks the start or goal trim.
        """
        return self._planner.plan(mission)
