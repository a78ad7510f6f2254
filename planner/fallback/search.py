"""The best walk for a mission, over several uncertainty levels at once.

For every walk the coasting times are chosen anew at every level; a walk is as good as its worst level, and
out where one level does not reach the goal (thesis, Problem 6.2; Problem 6.1 is the case of level 0 alone).

First all walks at all levels together, in closed form; then, best first, the walks that may still win are
solved by CasADi from the best starts that are no optima yet. A walk whose lower bound exceeds the best plan
so far is left out. The winner is solved once more from its own coasting times.
"""

from math import inf

import numpy as np

from flight.mission.mission import Mission
from planner.walks.search_result import SearchResult, Times

from .bounds import least_costs
from .candidates import Candidate, candidates, polished, solved
from .walk_table import WalkTable


def search(tables: tuple[WalkTable, ...], mission: Mission) -> SearchResult:
    """Returns the walk whose worst level is best.

    Args:
        tables: every walk to choose from, by length.
        mission: from where to where.
    """
    bounded = [(table, table.worst(least_costs(table.batch, mission))) for table in tables]
    lower_bound = min((float(bound.min()) for _, bound in bounded), default=inf)
    possible = [
        (table.take(np.isfinite(bound)), bound[np.isfinite(bound)])
        for table, bound in bounded
        if np.isfinite(bound).any()
    ]
    winner: Candidate | None = None
    times: tuple[Times, ...] = ()
    cost = inf
    for candidate in sorted(candidates(possible, mission), key=lambda one: one.hope):
        if candidate.hope >= cost:
            break
        found = solved(candidate, mission, cost)
        if found is not None:
            winner, times, cost = candidate, found[0], max(found[1])
    if winner is None:
        return SearchResult((), (), (), lower_bound)
    times = polished(winner, mission, times)
    costs = tuple(numbers.cost(known) for numbers, known in zip(winner.motions, times, strict=True))
    return SearchResult(winner.walk, times, costs, lower_bound)
