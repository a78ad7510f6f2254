"""The slowest errors: how long a walk takes at most when every error is its own and the times answer it.

Boxes of errors are taken worst first. In each, times that close the walk for all its errors
(`closing.py`) bound its seconds; where they do not suffice the box is halved, along the variable that bends
the walk most. Times that become negative for some errors are held longer from the start, and where a walk is
too short to answer large errors, some trim is held for longer than the middle of the box asks for: a detour,
but one that arrives. So there is a bound early, and more boxes make it better.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from math import inf

import numpy as np
from jaxtyping import Bool, Float, Int

from flight.mission import Mission
from flight.se2 import wrap_angle

from .arrival import EQUALITY_TOLERANCE, wants_heading
from .closing import Closed, Way, close, ways
from .error_bounds import GAP, ROUNDING, Bounded, goal_of
from .error_box import ErrorPath, enclose
from .kernel.exact import best_of_each

MOST_TIME_BOXES = 4000

BATCH = 128

HELD = 1e-3
"""Seconds above which a coasting time can answer."""

SPREADS = (1.1, 1.3)
"""How much longer than errors ask for a time is held from the start, one after the other."""

DETOURS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.5)
"""Seconds that a trim is held at least."""

ESCAPES = (0.0, 1.5, 3.0, 5.0, 8.0, 13.0, 20.0, 30.0)
"""Likewise, where anything that arrives is welcome."""

FOREVER = 1e9
"""Seconds; any time that is not infinite."""

COSTS = 0.3
"""Share of a detour's seconds that it costs, at least, as a rule."""


@dataclass(frozen=True, slots=True, eq=False)
class _Boxes:
    middle: Float[np.ndarray, "n variables"]
    width: Float[np.ndarray, "n variables"]
    bound: Float[np.ndarray, "n"]

    def take(self, which: Bool[np.ndarray, "n"] | Int[np.ndarray, "m"]) -> "_Boxes":
        return _Boxes(self.middle[which], self.width[which], self.bound[which])

    def halves(self, place: Int[np.ndarray, "n"]) -> "_Boxes":
        rows = np.arange(len(place))
        width, shift = self.width.copy(), np.zeros_like(self.width)
        width[rows, place] *= 0.5
        shift[rows, place] = width[rows, place]
        middle = np.concatenate([self.middle - shift, self.middle + shift])
        return _Boxes(middle, np.tile(width, (2, 1)), np.tile(self.bound, 2))


def _joined(one: _Boxes, two: _Boxes) -> _Boxes:
    return _Boxes(
        np.concatenate([one.middle, two.middle]),
        np.concatenate([one.width, two.width]),
        np.concatenate([one.bound, two.bound]),
    )


@dataclass(eq=False)
class _Look:
    """What is known of a batch of boxes.

    Attributes:
        boxes: the batch; their bounds are those of the boxes that they come from.
        cost: seconds that their middles need.
        times: with which.
        bound: seconds that suffice for each box.
        corner: errors in each box that seem slowest.
        blame: how far each variable bends the walk.
        rank: how near the attempt came that gave the blame.
    """

    boxes: _Boxes
    cost: Float[np.ndarray, "n"]
    times: Float[np.ndarray, "n trims"]
    bound: Float[np.ndarray, "n"] = field(init=False)
    corner: Float[np.ndarray, "n variables"] = field(init=False)
    blame: Float[np.ndarray, "n variables"] = field(init=False)
    rank: Float[np.ndarray, "n"] = field(init=False)

    def __post_init__(self) -> None:
        self.bound, self.rank = np.full(len(self.cost), inf), np.full(len(self.cost), inf)
        self.corner = self.boxes.middle.copy()
        self.blame = np.zeros_like(self.corner)


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
    return _Search(path, mission, gap).bounded(known, most)


class _Search:
    def __init__(self, path: ErrorPath, mission: Mission, gap: float) -> None:
        self._path, self._mission, self._gap = path, mission, gap
        self._goal = goal_of(mission)
        self._ways = ways(path, heading=wants_heading(mission), tolerance=mission.tolerance)

    def bounded(self, known: Bounded, most: int) -> Bounded:
        """Returns the bound; see `worst_time_bound`."""
        close_ = self._branched(known, most, self._looked)
        if close_.bound < inf or close_.found == inf:
            return close_
        coarse = self._branched(close_, most, self._escaped)
        return replace(coarse, boxes=close_.boxes + coarse.boxes)

    def _branched(self, known: Bounded, most: int, look_at: Callable[[_Boxes, Bounded], _Look]) -> Bounded:
        """Returns the bound that some way of looking at boxes gives, worst first."""
        count = len(self._path.names)
        open_ = _Boxes(np.zeros((1, count)), np.ones((1, count)), np.array([inf]))
        looked, closed = 0, 0.0
        while len(open_.bound) and looked < most and open_.bound.max() > self._enough(known):
            worst = np.argsort(-open_.bound, kind="stable")[:BATCH]
            worst = worst[open_.bound[worst] > self._enough(known)]
            chosen = np.zeros(len(open_.bound), dtype=bool)
            chosen[worst] = True
            look = look_at(open_.take(chosen), known)
            looked += len(worst)
            known = self._slower(known, look.boxes.middle, look.cost)
            if known.found < inf:
                corner = best_of_each(self._path.table(look.corner), self._mission)[0]
                known = self._slower(known, look.corner, corner)
            if known.found == inf:
                break
            bound = np.minimum(look.bound, look.boxes.bound)
            enough = bound <= self._enough(known)
            closed = max(closed, float(bound[enough].max(initial=0.0)))
            rest = replace(look.boxes, bound=bound).take(~enough)
            open_ = _joined(open_.take(~chosen), rest.halves(look.blame[~enough].argmax(axis=1)))
        bound_ = max(float(open_.bound.max(initial=0.0)), closed) + ROUNDING
        return replace(known, bound=max(bound_, known.found), boxes=looked)

    def _enough(self, known: Bounded) -> float:
        return known.found * (1 + self._gap)

    @staticmethod
    def _slower(
        known: Bounded, errors: Float[np.ndarray, "n variables"], costs: Float[np.ndarray, "n"]
    ) -> Bounded:
        slowest = int(costs.argmax())
        if costs[slowest] <= known.found:
            return known
        return replace(known, found=float(costs[slowest]), errors=tuple(errors[slowest].tolist()))

    def _looked(self, boxes: _Boxes, known: Bounded) -> _Look:
        """Returns bounds for a batch of boxes, as close as they are to be had."""
        look, enough = self._begun(boxes), self._enough(known)
        if np.isfinite(look.cost).all():
            self._attempts(look, np.arange(len(look.cost)), look.times, enough, longer=SPREADS)
            self._detours(look, DETOURS, enough)
            self._blame(look)
        return look

    def _escaped(self, boxes: _Boxes, known: Bounded) -> _Look:
        """Returns some bounds for a batch of boxes, by the shortest detour that gives one."""
        look = self._begun(boxes)
        if np.isfinite(look.cost).all():
            for seconds in ESCAPES:
                self._detours(look, (seconds,), FOREVER, longer=SPREADS)
            self._blame(look)
        return look

    def _begun(self, boxes: _Boxes) -> _Look:
        return _Look(boxes, *best_of_each(self._path.table(boxes.middle), self._mission))

    def _blame(self, look: _Look) -> None:
        """Says where to cut boxes that no attempt has looked at: where the end moves most."""
        lost = look.blame.sum(axis=1) == 0
        middle, times = look.boxes.middle[lost], look.times[lost]
        still = np.zeros((*times.shape, middle.shape[1]))
        look.blame[lost] = enclose(self._path, middle, look.boxes.width[lost], times, still).influence

    def _detours(
        self, look: _Look, seconds: tuple[float, ...], enough: float, *, longer: tuple[float, ...] = ()
    ) -> None:
        """Lets each trim in turn be held for longer than it has to be, in boxes whose bound is not enough."""
        rows, places = np.flatnonzero(look.bound > enough), len(self._path.walk)
        if places == 1:
            return
        row = np.repeat(rows, places * len(seconds))
        place = np.tile(np.repeat(np.arange(places), len(seconds)), len(rows))
        held = np.tile(seconds, len(rows) * places)
        hopeful = look.cost[row] + COSTS * held < enough
        row, place, held = row[hopeful], place[hopeful], held[hopeful]
        least = np.zeros((len(row), places))
        least[np.arange(len(row)), place] = held
        cost, times = self._held(look, row, least)
        useful = cost < np.minimum(look.bound[row], enough)
        self._attempts(look, row[useful], times[useful], enough, longer=longer)

    def _held(
        self, look: _Look, row: Int[np.ndarray, "m"], least: Float[np.ndarray, "m trims"]
    ) -> tuple[Float[np.ndarray, "m"], Float[np.ndarray, "m trims"]]:
        """Returns the best times, each at least so long, for the middles of boxes, and their cost."""
        cost, times = best_of_each(self._path.table(look.boxes.middle[row], least), self._mission)
        return cost, times + least

    def _attempts(
        self,
        look: _Look,
        row: Int[np.ndarray, "m"],
        times: Float[np.ndarray, "m trims"],
        enough: float,
        *,
        longer: tuple[float, ...] = (),
    ) -> None:
        """Lets times answer in every way; where they become too short, tries longer ones."""
        for way in self._ways:
            use = self._can_answer(times, way) & (look.bound[row] > enough)
            trying, base = row[use], times[use]
            for share in (*longer, None):
                if not len(trying):
                    break
                closed = self._closed(look, trying, base, way)
                short = self._noted(look, trying, closed, way, base) & (look.bound[trying] > enough)
                if share is None or not way.answering or len(self._path.walk) == 1:
                    break
                least = np.zeros((int(short.sum()), base.shape[1]))
                for place in way.answering:
                    least[:, place] = np.minimum(share * closed.times[place].reach[short], ESCAPES[-1])
                cost, base = self._held(look, trying[short], least)
                trying, base = trying[short][np.isfinite(cost)], base[np.isfinite(cost)]

    @staticmethod
    def _can_answer(times: Float[np.ndarray, "m trims"], way: Way) -> Bool[np.ndarray, "m"]:
        if not way.answering:
            return np.asarray(~times.any(axis=1))
        return np.asarray(times[:, way.answering].min(axis=1) > HELD)

    def _closed(
        self, look: _Look, row: Int[np.ndarray, "m"], times: Float[np.ndarray, "m trims"], way: Way
    ) -> Closed:
        middle = look.boxes.middle[row]
        alone = way.turn is None and len(way.others) < 2
        goal = np.full(len(row), self._goal) if alone else self._path.at(middle).end(times)
        return close(
            self._path,
            middle,
            look.boxes.width[row],
            times,
            goal=goal,
            tolerance=self._mission.tolerance,
            way=way,
        )

    def _noted(
        self,
        look: _Look,
        row: Int[np.ndarray, "m"],
        closed: Closed,
        way: Way,
        times: Float[np.ndarray, "m trims"],
    ) -> Bool[np.ndarray, "m"]:
        """Keeps what is better; returns where only the sign of a time is amiss."""
        shortest = np.full(len(row), inf)
        for time in closed.times.values():
            shortest = np.minimum(shortest, time.low)
        holds = closed.holds & self._faces(closed)
        bound = np.where(holds & (shortest >= 0), closed.seconds.high, inf)
        held = times[:, way.answering].min(axis=1) if way.answering else np.zeros(len(row))
        rank = np.where(np.isfinite(bound), bound, np.where(holds, 1e6 - shortest, 1e9 - held))
        variables = look.boxes.middle.shape[1]
        # Rows may come more than once: the best comes last.
        for at in np.argsort(-rank, kind="stable"):
            if rank[at] < look.rank[row[at]]:
                look.rank[row[at]], look.blame[row[at]] = rank[at], closed.blame[at]
            if bound[at] < look.bound[row[at]]:
                look.bound[row[at]] = bound[at]
                toward = np.sign(closed.seconds.slope[at, :variables])
                look.corner[row[at]] = look.boxes.middle[row[at]] + toward * look.boxes.width[row[at]]
        return np.asarray(holds & (shortest < 0))

    def _faces(self, closed: Closed) -> Bool[np.ndarray, "m"]:
        """Returns where the heading at the end is as wanted."""
        mission = self._mission
        if mission.goal_heading is None or not wants_heading(mission):
            return np.ones(len(closed.holds), dtype=bool)
        wanted = mission.goal_heading - mission.start.heading
        off = np.array([abs(wrap_angle(one - wanted)) for one in closed.heading.middle.tolist()])
        allowed = max(mission.heading_tolerance, EQUALITY_TOLERANCE) + ROUNDING
        faces: Bool[np.ndarray, "m"] = off + closed.heading.reach <= allowed
        return faces
