"""How far a plan may end from its goal for any errors in the whole box, not only at its corners.

Boxes of errors are enclosed and, where the bound is worst, halved, until bound and worst case found are
within a gap, or the boxes are used up; the bound holds either way.
"""

from math import inf

import numpy as np
from jaxtyping import Float

from flight.mission.mission import Mission
from planner.walks.goal_condition import goal_from_start
from planner.walks.search_result import Times

from .bounded_maximum import GAP, ROUNDING, BoundedMaximum
from .corners import furthest_corner
from .enclosure import enclose_end
from .error_path import ErrorPath

MOST_MISS_BOXES = 20_000

BATCH = 256


def worst_miss_bound(path: ErrorPath, mission: Mission, times: Times, *, gap: float = GAP) -> BoundedMaximum:
    """Returns the largest miss in metres of coasting times that were fixed before the errors are known."""
    goal, count = goal_from_start(mission), len(path.names)
    middles, widths = np.zeros((1, count)), np.ones((1, count))
    bounds = np.array([inf])
    found, at, boxes, closed = -1.0, np.zeros(count), 0, 0.0
    while len(bounds) and boxes < MOST_MISS_BOXES:
        chosen = np.zeros(len(bounds), dtype=bool)
        chosen[np.argpartition(-bounds, min(BATCH, len(bounds)) - 1)[:BATCH]] = True
        middle, width = middles[chosen], widths[chosen]
        boxes += len(middle)
        fixed = np.tile(np.array(times), (len(middle), 1))
        hull = enclose_end(path, middle, width, fixed, np.zeros((*fixed.shape, count)))
        signs, size = furthest_corner(hull.middle - goal, hull.slope * width)
        misses = np.abs(path.at(middle + signs * width).end(fixed) - goal)
        best = int(misses.argmax())
        if misses[best] > found:
            found, at = float(misses[best]), (middle + signs * width)[best]
        top = np.minimum(size + hull.radius + ROUNDING, bounds[chosen])
        enough = top <= found * (1 + gap)
        closed = max(closed, float(top[enough].max(initial=0.0)))
        halves = _halve(middle, width, hull.influence, ~enough)
        middles = np.concatenate([middles[~chosen], halves[0]])
        widths = np.concatenate([widths[~chosen], halves[1]])
        bounds = np.concatenate([bounds[~chosen], np.tile(top[~enough], 2)])
    bound = max(closed, float(bounds.max(initial=0.0)), found)
    return BoundedMaximum(found, tuple(at.tolist()), bound, boxes)


def _halve(
    middle: Float[np.ndarray, "n variables"],
    width: Float[np.ndarray, "n variables"],
    influence: Float[np.ndarray, "n variables"],
    which: np.ndarray,
) -> tuple[Float[np.ndarray, "m variables"], Float[np.ndarray, "m variables"]]:
    middle, width, place = middle[which], width[which].copy(), influence[which].argmax(axis=1)
    rows = np.arange(len(middle))
    width[rows, place] *= 0.5
    shift = np.zeros_like(middle)
    shift[rows, place] = width[rows, place]
    return np.concatenate([middle - shift, middle + shift]), np.concatenate([width, width])
