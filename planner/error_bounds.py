"""How far a plan may end from its goal for any errors in the whole box, not only at its corners.

Boxes of errors are enclosed and, where the bound is worst, halved, until bound and worst case found are
within a gap, or the boxes are used up; the bound holds either way.
"""

from dataclasses import dataclass
from math import inf

import numpy as np
from jaxtyping import Float

from flight.mission import Mission
from flight.se2 import rotate

from .answer import Times
from .corners import furthest_corner
from .error_box import ErrorPath, enclose

ROUNDING = 1e-9
"""Metres and seconds that every bound is widened by."""

MOST_MISS_BOXES = 20_000

GAP = 0.01
"""Share of the bound within which what was found is close enough."""

BATCH = 256


@dataclass(frozen=True, slots=True)
class Bounded:
    """The worst over a box of errors.

    Attributes:
        found: the worst that was found, seconds or metres.
        errors: the error variables there, each between -1 and 1.
        bound: what no errors of the box exceed; infinite where none was proved.
        boxes: how many were looked at.
    """

    found: float
    errors: tuple[float, ...]
    bound: float
    boxes: int


def goal_of(mission: Mission) -> complex:
    """Returns the goal seen from the start, north + i east in metres."""
    start = mission.start
    return complex(*rotate(mission.goal[0] - start.x, mission.goal[1] - start.y, -start.heading))


def worst_miss_bound(path: ErrorPath, mission: Mission, times: Times, *, gap: float = GAP) -> Bounded:
    """Returns the largest miss in metres of coasting times that were fixed before the errors are known."""
    goal, count = goal_of(mission), len(path.names)
    middles, widths = np.zeros((1, count)), np.ones((1, count))
    bounds = np.array([inf])
    found, at, boxes, closed = -1.0, np.zeros(count), 0, 0.0
    while len(bounds) and boxes < MOST_MISS_BOXES:
        chosen = np.zeros(len(bounds), dtype=bool)
        chosen[np.argpartition(-bounds, min(BATCH, len(bounds)) - 1)[:BATCH]] = True
        middle, width = middles[chosen], widths[chosen]
        boxes += len(middle)
        fixed = np.tile(np.array(times), (len(middle), 1))
        hull = enclose(path, middle, width, fixed, np.zeros((*fixed.shape, count)))
        signs, size = furthest_corner(hull.middle - goal, hull.slope * width)
        misses = np.abs(path.at(middle + signs * width).end(fixed) - goal)
        best = int(misses.argmax())
        if misses[best] > found:
            found, at = float(misses[best]), (middle + signs * width)[best]
        top = np.minimum(size + hull.radius + ROUNDING, bounds[chosen])
        enough = top <= found * (1 + gap)
        closed = max(closed, float(top[enough].max(initial=0.0)))
        halves = _halved(middle, width, hull.influence, ~enough)
        middles = np.concatenate([middles[~chosen], halves[0]])
        widths = np.concatenate([widths[~chosen], halves[1]])
        bounds = np.concatenate([bounds[~chosen], np.tile(top[~enough], 2)])
    bound = max(closed, float(bounds.max(initial=0.0)), found)
    return Bounded(found, tuple(at.tolist()), bound, boxes)


def _halved(
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
