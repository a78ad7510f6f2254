"""Upper bound of a plan's miss over the whole error box.

Boxes of errors are enclosed and, where the bound is worst, halved, until bound and worst case found are
within a gap, or the boxes are used up; the bound holds either way.
"""

from dataclasses import replace

import numpy as np

from flight.mission.mission import Mission
from planner.walks.boxes import joined
from planner.walks.goal_condition import goal_from_start
from planner.walks.search_result import Times

from .bounded_maximum import GAP, ROUNDING, BoundedBoxes, BoundedMaximum
from .corners import furthest_corner
from .enclosure import enclose_end
from .error_path import ErrorPath

MOST_MISS_BOXES = 20_000

BATCH = 256


def worst_miss_bound(path: ErrorPath, mission: Mission, times: Times, *, gap: float = GAP) -> BoundedMaximum:
    """Returns the largest miss in metres for fixed coasting times."""
    goal, count = goal_from_start(mission), len(path.names)
    open_ = BoundedBoxes.whole(count)
    found, at, looked, closed = -1.0, np.zeros(count), 0, 0.0
    while len(open_) and looked < MOST_MISS_BOXES:
        chosen = np.zeros(len(open_), dtype=bool)
        chosen[np.argpartition(-open_.bound, min(BATCH, len(open_)) - 1)[:BATCH]] = True
        boxes = open_.take(chosen)
        looked += len(boxes)
        fixed = np.tile(np.array(times), (len(boxes), 1))
        hull = enclose_end(path, boxes.middle, boxes.width, fixed, np.zeros((*fixed.shape, count)))
        signs, size = furthest_corner(hull.middle - goal, hull.slope * boxes.width)
        corners = boxes.middle + signs * boxes.width
        misses = np.abs(path.at(corners).end(fixed) - goal)
        best = int(misses.argmax())
        if misses[best] > found:
            found, at = float(misses[best]), corners[best]
        bound = np.minimum(size + hull.radius + ROUNDING, boxes.bound)
        enough = bound <= found * (1 + gap)
        closed = max(closed, float(bound[enough].max(initial=0.0)))
        halves = replace(boxes, bound=bound).take(~enough).halves(hull.influence[~enough].argmax(axis=1))
        open_ = joined(open_.take(~chosen), halves)
    bound_of_all = max(closed, float(open_.bound.max(initial=0.0)), found)
    return BoundedMaximum(found, tuple(at.tolist()), bound_of_all, looked)
