"""How bad it can get for any errors in the whole box, not only at its corners: bounds, and what was found.

Boxes of errors are enclosed and, where the bound is worst, halved, until bound and worst case found are
within a gap, or the boxes are used up; the bound holds either way. For the miss the coasting times are fixed.
For the time they may answer the errors: in each box those best at its middle, changed in proportion to the
errors so that the end stays at the goal; what the proportion leaves is kept inside the tolerance.
"""

from dataclasses import dataclass, replace
from heapq import heappop, heappush
from math import inf, isnan, nan

import numpy as np
from jaxtyping import Float

from flight.library import Library
from flight.maneuver import Maneuver, ManeuverError
from flight.mission import Mission
from flight.plan import Plan
from flight.se2 import SE2, Twist, rotate
from flight.trim import Trim

from .answer import Times
from .answering_times import ErrorCell
from .corners import furthest_corner
from .error_box import ErrorPath, enclose
from .nominal import Nominal

ROUNDING = 1e-9
"""Metres and seconds that every bound is widened by."""

MOST_MISS_BOXES = 20_000
MOST_TIME_BOXES = 1500

GAP = 0.01
"""Share of the bound within which what was found is close enough."""

BATCH = 256

INSIDE = (1.0, 1.3, 1.7, 2.5)
"""How far inside the tolerance the times aim, in what the first ones lack."""

NO_ERROR = Twist(0.0, 0.0, 0.0)


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


@dataclass(frozen=True, slots=True, eq=False)
class _Box:
    middle: Float[np.ndarray, "variables"]
    width: Float[np.ndarray, "variables"]
    cost: float


def worst_time_bound(
    path: ErrorPath, mission: Mission, known: Bounded, *, gap: float = GAP, most: int = MOST_TIME_BOXES
) -> Bounded:
    """Returns the largest least time in seconds: the coasting times are chosen when the errors are known.

    It is infinite where errors are found with which the walk never arrives.

    Args:
        path: the walk.
        mission: from where to where, with a tolerance above 0 and no heading.
        known: the slowest errors known; seconds.
        gap: share of the bound at which the search is content.
        most: boxes that may be looked at.
    """
    count = len(path.names)
    open_: list[tuple[float, int, _Box]] = [(-inf, 0, _Box(np.zeros(count), np.ones(count), inf))]
    boxes = 0
    while open_ and boxes < most and -open_[0][0] > known.found * (1 + gap):
        _, _, box = heappop(open_)
        boxes += 1
        cost, exact, cut = _answered(path, mission, box)
        if exact > known.found:
            known = Bounded(exact, tuple(box.middle.tolist()), inf, boxes)
        if exact == inf:
            return known
        if isnan(exact):
            return replace(known, bound=inf, boxes=boxes)
        cost = min(cost, box.cost)
        width = box.width.copy()
        if cost <= known.found * (1 + gap):
            heappush(open_, (-cost, boxes * 2, _Box(box.middle, width, cost)))
            continue
        width[cut] *= 0.5
        shift = np.zeros(count)
        shift[cut] = width[cut]
        for half, middle in enumerate((box.middle - shift, box.middle + shift)):
            heappush(open_, (-cost, boxes * 2 + half, _Box(middle, width, cost)))
    return replace(known, bound=max(-open_[0][0] + ROUNDING, known.found), boxes=boxes)


def _answered(path: ErrorPath, mission: Mission, box: _Box) -> tuple[float, float, int]:
    """Returns seconds that suffice for a box, those its middle needs (nan if unknown), where to cut it."""
    plan = _nominal(path, mission, box.middle)
    if not plan.found:
        return inf, inf if plan.status == "infeasible" else nan, 0
    exact = plan.coasting_times
    needed = path.fixed[0] + float(box.middle @ path.fixed[1]) + sum(exact)
    cell = ErrorCell(path, goal_of(mission), mission.tolerance, box.middle, box.width)
    best, lacking = cell.served(exact)
    for share in INSIDE:
        aim = mission.tolerance - share * lacking
        nearer = _nominal(path, replace(mission, tolerance=aim), box.middle) if aim > 0 else None
        if nearer is not None and nearer.found:
            best = min(best, cell.served(nearer.coasting_times)[0])
        if best < inf:
            break
    return best, needed, int(cell.stray(exact).influence[0].argmax())


def _nominal(path: ErrorPath, mission: Mission, errors: Float[np.ndarray, "variables"]) -> Plan:
    """Returns the plan with the least coasting times for some errors, if the walk can arrive."""
    numbers = path.at(errors[None])
    last = len(path.walk)
    trims = tuple(
        Trim(place + 1, "", Twist(v.real, v.imag, r), NO_ERROR)
        for place, (v, r) in enumerate(
            zip(numbers.velocity[0].tolist(), numbers.rate[0].tolist(), strict=True)
        )
    )
    steps = zip(numbers.displacement[0].tolist(), numbers.turn[0].tolist(), strict=True)
    joints = tuple(
        Maneuver(place, place, place + 1, 0.0, SE2(d.real, d.imag, turn), ManeuverError(0, 0, 0, 0))
        for place, (d, turn) in enumerate(steps, start=1)
    )
    library = Library("one walk", "", "", trims, joints)
    return Nominal(library).plan(replace(mission, start_trim=1, goal_trim=last, max_trims=last))
