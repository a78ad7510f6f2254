"""Walks to commit to: all, or the most promising of too many."""

from math import inf
from time import perf_counter

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from planner.kernel.exact import ExactSearch
from planner.walks.walk import Walk, count_walks, walks

MOST_WALKS = 8000
"""Walks that a search takes on; it keeps some 20 kB of each."""

WALKS_A_SECOND = 3000
"""Walks that are prepared in a second."""

SHARE = 0.25
"""Of the time that is left: what listing walks may take."""


def choose_walks(
    library: Library,
    gammas: tuple[float, ...],
    mission: Mission,
    *,
    horizon: float,
    known: Plan,
    until: float,
) -> tuple[tuple[Walk, ...], float]:
    """Returns walks, and seconds that all others take at least.

    That is infinite where there are no others.

    Args:
        library: the automaton.
        gammas: uncertainty levels of the lower bounds.
        mission: from where to where.
        horizon: seconds that a plan may take.
        known: a plan whose walk is not left out.
        until: reading of `time.perf_counter` at which the search ends.

    Raises:
        UnknownTrimError: the library lacks the start or goal trim.
    """
    start, depth, goal_trim = mission.start_trim, mission.max_trims, mission.goal_trim
    if count_walks(library, start, max_trims=depth, goal_trim=goal_trim) <= MOST_WALKS:
        return walks(library, start, max_trims=depth, goal_trim=goal_trim), inf
    left = max(until - perf_counter(), 0.0)
    most = int(min(MOST_WALKS, 1 + WALKS_A_SECOND * left))
    chosen, left_out = ExactSearch(library, gammas).promising_walks(
        mission, limit=horizon, most=most, deadline=SHARE * left
    )
    if known.found and known.sequence not in chosen:
        chosen = (*chosen, known.sequence)
    return chosen, left_out
