"""The nominal policy: minimum time with the library's values (thesis, Problem 6.1)."""

from math import inf

from flight.automaton.library import Library

from .policy import LibraryPlanner


def nominal_planner(
    library: Library, *, max_nodes: int | None = None, deadline: float = inf
) -> LibraryPlanner:
    """Returns a planner for the library's values without errors.

    Args:
        library: the primitives.
        max_nodes: as for `LibraryPlanner`.
        deadline: as for `LibraryPlanner`.
    """
    return LibraryPlanner(
        library, policy="nominal", gamma=0.0, gammas=(0.0,), max_nodes=max_nodes, deadline=deadline
    )
