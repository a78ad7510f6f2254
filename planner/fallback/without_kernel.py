"""The search on a machine without a compiler: closed forms, a grid and IPOPT, then branch and bound."""

from functools import cache
from math import inf
from time import perf_counter

from flight.automaton.library import Library
from flight.mission.mission import Mission
from planner.walks.search_result import SearchResult

from .branch_and_bound import proved_best
from .search import search
from .walk_table import WalkTable, tabulate


class SearchWithoutKernel:
    """Finds the best walk of one library over some uncertainty levels, in seconds instead of milliseconds.

    Args:
        library: the primitives.
        gammas: the levels.
    """

    def __init__(self, library: Library, gammas: tuple[float, ...]) -> None:
        self._library = library
        self._gammas = gammas
        self._tables = cache(self._tabulate)

    def answer(
        self, mission: Mission, *, max_nodes: int | None = None, deadline: float = inf
    ) -> SearchResult:
        """Returns the walk whose worst level is best.

        Args:
            mission: from where to where.
            max_nodes: if any, the proof that nothing is better is left out.
            deadline: seconds after which that proof is given up.
        """
        began = perf_counter()
        found = search(self._tables(mission.start_trim, mission.max_trims, mission.goal_trim), mission)
        if max_nodes is not None:
            return found
        return proved_best(found, self._library, mission, self._gammas, until=began + deadline)

    def _tabulate(self, start_trim: int, max_trims: int, goal_trim: int | None) -> tuple[WalkTable, ...]:
        return tabulate(self._library, self._gammas, start_trim, max_trims, goal_trim)
