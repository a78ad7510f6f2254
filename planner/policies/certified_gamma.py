"""Largest gamma such that every smaller one provably meets the limit.

An interval of levels is proved if one walk meets the limit at all of them, at those of the other sign, and at
0. The proof encloses coasting times that are adjusted to the level (`independent_errors.closure.close_chain`)
over the whole interval. Intervals without a proof are halved.
"""

from functools import cache

import numpy as np

from flight.automaton.library import Library
from flight.mission.mission import Mission
from planner.independent_errors.bounded_maximum import BoundedBoxes
from planner.independent_errors.box_evaluator import BoxEvaluator
from planner.independent_errors.error_path import error_path
from planner.walks.kinematics import NegativeDurationError
from planner.walks.walk import Walk

from .worst_case import worst_case_planner

FIRST_WIDTH = 1 / 40
"""Of the intervals of levels that are tried first."""

NARROWEST = 1e-5
"""Of an interval that is tried."""


def certified_gamma(library: Library, mission: Mission, *, limit: float, gamma: float) -> float:
    """Returns a gamma below which every level provably meets the limit.

    Args:
        library: the primitives.
        mission: from where to where.
        limit: seconds that the worst case may take.
        gamma: the level to prove it for; the level returned is at most that.
    """
    answers_of = cache(
        lambda walk: BoxEvaluator(error_path(library, walk, 1.0, "primitive").with_single_gamma(), mission)
    )
    proved, width = 0.0, FIRST_WIDTH
    while proved < gamma:
        up_to = min(proved + width, gamma)
        walks = {_best_walk(library, mission, level) for level in (proved, 0.5 * (proved + up_to), up_to)}
        if any(walk and _is_certified(answers_of(walk), proved, up_to, limit) for walk in walks):
            proved, width = up_to, min(2 * width, FIRST_WIDTH)
        elif width > NARROWEST:
            width *= 0.5
        else:
            break
    return proved


def _is_certified(evaluator: BoxEvaluator, low: float, high: float, limit: float) -> bool:
    if evaluator.costs(np.zeros((1, 1)))[0] > limit:
        return False
    both = BoundedBoxes(np.array([[low], [-high]]), np.array([[high], [-low]]), np.full(2, np.inf))
    return bool((evaluator.fine_bounds(both, limit).bound <= limit).all())


def _best_walk(library: Library, mission: Mission, gamma: float) -> Walk:
    """Returns the best walk for a level; empty if infeasible."""
    try:
        return worst_case_planner(library, gamma).plan(mission).sequence
    except NegativeDurationError:
        return ()
