"""The nominal policy: minimum time, believing the library (thesis, Problem 6.1)."""

from math import inf

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan

from .policy import LibraryPlanner


class Nominal:
    """Plans with every primitive exactly as the library has it.

    Args:
        library: the primitives.
        max_nodes: as for `LibraryPlanner`.
        deadline: as for `LibraryPlanner`.
    """

    def __init__(self, library: Library, *, max_nodes: int | None = None, deadline: float = inf) -> None:
        self._planner = LibraryPlanner(
            library, policy="nominal", gamma=0.0, gammas=(0.0,), max_nodes=max_nodes, deadline=deadline
        )

    def plan(self, mission: Mission) -> Plan:
        """Returns the fastest plan found, or an honest no.

        Raises:
            UnknownTrimError: the library lacks the start or goal trim.
        """
        return self._planner.plan(mission)
