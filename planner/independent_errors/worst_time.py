"""Upper bound of a walk's time with independent, known errors.

Boxes of errors are taken worst first; those whose bound (`box_evaluator.py`) is insufficient are halved along
the most sensitive variable. Where that gives no bound in the boxes allowed, detours give one. The bound holds
after any number of boxes; more boxes tighten it.
"""

from collections.abc import Callable
from dataclasses import replace
from math import inf

import numpy as np
from jaxtyping import Float

from flight.mission.mission import Mission
from planner.walks.boxes import joined

from .bounded_maximum import GAP, ROUNDING, BoundedBoxes, BoundedMaximum
from .box_evaluator import FOREVER, BoxEvaluator, BoxState
from .error_path import ErrorPath

MOST_TIME_BOXES = 4000

QUICK, COARSE, LAST = 0.1, 0.3, 0.9
"""Shares of the boxes allowed: after the first the second is spent on any bound, where there is none yet;
after the last what is left, on boxes that still have none."""

BATCH = 128
"""Boxes evaluated together."""

LookAt = Callable[[BoundedBoxes, float], BoxState]
"""Gives bounds to boxes, no closer than some seconds."""


def worst_time_bound(
    path: ErrorPath, mission: Mission, known: BoundedMaximum, *, gap: float = GAP, most: int = MOST_TIME_BOXES
) -> BoundedMaximum:
    """Returns the largest least time for errors known before coasting.

    It is infinite where errors are found with which the walk never arrives.

    Args:
        path: the walk.
        mission: from where to where.
        known: the slowest errors known; seconds.
        gap: share of the bound at which the search stops.
        most: boxes that may be evaluated.

    Raises:
        NoMachineCodeError: there is no C compiler that works.
    """
    evaluator = BoxEvaluator(path, mission)
    whole = BoundedBoxes.whole(len(path.names))
    search = _Search(evaluator, whole, known, gap)
    search.branch(evaluator.fine_bounds, int(QUICK * most))
    if search.bounded.bound == inf:
        coarse = _Search(evaluator, whole, search.bounded, gap)
        coarse.branch(evaluator.coarse_bounds, int(COARSE * most))
        search.learn(coarse.bounded)
    search.branch(evaluator.fine_bounds, int(LAST * most))
    search.branch(evaluator.coarse_bounds, most, above=FOREVER)
    search.branch(evaluator.fine_bounds, most)
    return search.bounded


class _Search:
    """Branch and bound over boxes of errors.

    Args:
        evaluator: of boxes.
        whole: all errors.
        known: the slowest errors known.
        gap: share of the bound at which the search stops.
    """

    def __init__(
        self, evaluator: BoxEvaluator, whole: BoundedBoxes, known: BoundedMaximum, gap: float
    ) -> None:
        self._answers, self._open, self._known, self._gap = evaluator, whole, known, gap
        self._looked, self._close = 0, 0.0

    @property
    def bounded(self) -> BoundedMaximum:
        """Returns the best found value and the upper bound."""
        bound = max(float(self._open.bound.max(initial=0.0)), self._close) + ROUNDING
        return replace(self._known, bound=max(bound, self._known.found), boxes=self._looked)

    def branch(self, evaluate: LookAt, most: int, *, above: float = 0.0) -> None:
        """Evaluates boxes, worst first, and halves those with insufficient bounds.

        Args:
            evaluate: gives bounds.
            most: boxes evaluated in all, after which to stop.
            above: seconds; boxes with a smaller bound are left as they are.
        """
        while self._looked < most and self._open.bound.max(initial=0.0) > max(self._enough, above):
            self._evaluate(evaluate, max(self._enough, above))
            if self._known.found == inf:
                break

    def learn(self, bounded: BoundedMaximum) -> None:
        """Adopts the errors of another search over the same box."""
        self._known = replace(bounded, boxes=0) if bounded.found > self._known.found else self._known
        self._open = replace(self._open, bound=np.minimum(self._open.bound, bounded.bound))
        self._looked += bounded.boxes

    @property
    def _enough(self) -> float:
        return self._known.found * (1 + self._gap)

    def _evaluate(self, evaluate: LookAt, above: float) -> None:
        worst = np.argsort(-self._open.bound, kind="stable")[:BATCH]
        chosen = np.zeros(len(self._open.bound), dtype=bool)
        chosen[worst[self._open.bound[worst] > above]] = True
        state = evaluate(self._open.take(chosen), self._enough)
        self._looked += int(chosen.sum())
        self._record_slower(state.boxes.middle, state.cost)
        if self._known.found < inf:
            self._record_slower(state.corner, self._answers.costs(state.corner))
        bound = np.minimum(state.bound, state.boxes.bound)
        enough, fine = bound <= self._enough, bound <= above
        self._close = max(self._close, float(bound[enough].max(initial=0.0)))
        looked = replace(state.boxes, bound=bound)
        halves = looked.take(~enough & ~fine).halves(state.sensitivity[~enough & ~fine].argmax(axis=1))
        self._open = joined(self._open.take(~chosen), looked.take(~enough & fine), halves)

    def _record_slower(self, errors: Float[np.ndarray, "n variables"], costs: Float[np.ndarray, "n"]) -> None:
        """Records slower errors than the known ones."""
        slowest = int(costs.argmax())
        if costs[slowest] > self._known.found:
            found, at = float(costs[slowest]), tuple(errors[slowest].tolist())
            self._known = replace(self._known, found=found, errors=at)
