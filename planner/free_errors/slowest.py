"""The slowest errors: how long a walk takes at most when every error is its own and the times answer it.

Boxes of errors are taken worst first; those whose bound (`answers.py`) is not enough are halved, along the
variable that bends the walk most. Where that gives no bound in the boxes allowed, detours give one. A bound
holds however few boxes were looked at; more make it closer.
"""

from collections.abc import Callable
from dataclasses import replace
from math import inf

import numpy as np
from jaxtyping import Float

from flight.mission import Mission

from .answers import Answers, Boxes, Look, joined
from .bounded import GAP, ROUNDING, Bounded
from .path import ErrorPath

MOST_TIME_BOXES = 4000

BATCH = 128
"""Boxes that are looked at together."""


def worst_time_bound(
    path: ErrorPath, mission: Mission, known: Bounded, *, gap: float = GAP, most: int = MOST_TIME_BOXES
) -> Bounded:
    """Returns the largest least time in seconds: the coasting times are chosen when the errors are known.

    It is infinite where errors are found with which the walk never arrives.

    Args:
        path: the walk.
        mission: from where to where.
        known: the slowest errors known; seconds.
        gap: share of the bound at which the search is content.
        most: boxes that may be looked at.

    Raises:
        NoKernelError: there is no C compiler.
    """
    answers = Answers(path, mission)
    start = Boxes.whole(len(path.names))
    close = _branched(answers, answers.close, start, known, gap=gap, most=most)
    if close.bound < inf or close.found == inf:
        return close
    coarse = _branched(answers, answers.coarse, start, close, gap=gap, most=most)
    return replace(coarse, boxes=close.boxes + coarse.boxes)


def _branched(
    answers: Answers,
    look_at: Callable[[Boxes, float], Look],
    open_: Boxes,
    known: Bounded,
    *,
    gap: float,
    most: int,
) -> Bounded:
    """Returns the bound that one way of looking at boxes gives, worst first."""
    looked, closed = 0, 0.0
    while looked < most and open_.bound.max(initial=0.0) > known.found * (1 + gap):
        worst = np.argsort(-open_.bound, kind="stable")[:BATCH]
        chosen = np.zeros(len(open_.bound), dtype=bool)
        chosen[worst[open_.bound[worst] > known.found * (1 + gap)]] = True
        look = look_at(open_.take(chosen), known.found * (1 + gap))
        looked += int(chosen.sum())
        known = _slower(known, look.boxes.middle, look.cost)
        if known.found < inf:
            known = _slower(known, look.corner, answers.costs(look.corner))
        if known.found == inf:
            break
        bound = np.minimum(look.bound, look.boxes.bound)
        enough = bound <= known.found * (1 + gap)
        closed = max(closed, float(bound[enough].max(initial=0.0)))
        rest = replace(look.boxes, bound=bound).take(~enough)
        open_ = joined(open_.take(~chosen), rest.halves(look.blame[~enough].argmax(axis=1)))
    bound_ = max(float(open_.bound.max(initial=0.0)), closed) + ROUNDING
    return replace(known, bound=max(bound_, known.found), boxes=looked)


def _slower(
    known: Bounded, errors: Float[np.ndarray, "n variables"], costs: Float[np.ndarray, "n"]
) -> Bounded:
    slowest = int(costs.argmax())
    if costs[slowest] <= known.found:
        return known
    return replace(known, found=float(costs[slowest]), errors=tuple(errors[slowest].tolist()))
