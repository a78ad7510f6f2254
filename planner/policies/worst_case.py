"""The worst-case policy: minimum worst-case time over gamma (thesis, Problem 6.2)."""

from math import inf

from flight.automaton.library import Library
from planner.walks.kinematics import check_gamma

from .policy import LibraryPlanner


def worst_case_planner(
    library: Library, gamma: float, *, max_nodes: int | None = None, deadline: float = inf
) -> LibraryPlanner:
    """Returns a planner for the levels 0, -gamma and +gamma.

    The plan's time holds if the level is known before the flight. For one set of coasting times at an unknown
    level see the committed policy (Problem 8.1).

    Args:
        library: the primitives.
        gamma: uncertainty level, from 0 (nominal) to 1 (the errors of the library).
        max_nodes: as for `LibraryPlanner`.
        deadline: as for `LibraryPlanner`.

    Raises:
        GammaError: the level is outside [0, 1].
        NegativeDurationError: the level turns a maneuver's duration negative.
    """
    check_gamma(gamma)
    gammas = (0.0, -gamma, gamma) if gamma else (0.0,)
    return LibraryPlanner(
        library, policy="worst-case", gamma=gamma, gammas=gammas, max_nodes=max_nodes, deadline=deadline
    )
