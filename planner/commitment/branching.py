"""Branch and bound over boxes of coasting times of many walks: the best, and that none is better."""

from dataclasses import dataclass
from math import inf
from time import perf_counter

import numpy as np
from jaxtyping import Float

from flight.library import Library
from planner.sequences import Walk

from .boxes import Boxes, examine, joined
from .descent import Descended, Descent
from .fan import fan
from .task import Task

BATCH = 1024
"""Boxes that are halved at once."""

DESCENTS = 2
"""Descents after each batch, from the middles of its most promising boxes."""

MOST_LEVELS = 9
"""At which boxes are looked at; more cost more than they cut."""

FAR = 1e6
"""Metres from the goal at which nothing is of interest."""


@dataclass(frozen=True, slots=True)
class Best:
    """The best that a search found.

    Attributes:
        walk: trim ids.
        found: its coasting times; None where none were found.
        value: seconds or metres; infinite without times.
        bound: seconds or metres that nothing undercuts.
        complete: whether nothing better than `bound` is left.
        nodes: boxes examined.
    """

    walk: Walk
    found: Descended | None
    value: float
    bound: float
    complete: bool
    nodes: int


class Branching:
    """Searches the walks of one mission.

    Args:
        library: the primitives.
        walks: all of them that may be flown.
        fixed: seconds that each takes without coasting, at the level where that is most.
        task: what is asked.
        most_nodes: boxes that may be examined.
        until: when to stop, by `time.perf_counter`.
    """

    def __init__(
        self,
        library: Library,
        walks: tuple[Walk, ...],
        fixed: Float[np.ndarray, "walks"],
        task: Task,
        *,
        most_nodes: int,
        until: float = inf,
    ) -> None:
        self.walks, self.fixed, self.task = walks, fixed, task
        self._library, self._most_nodes, self._until = library, most_nodes, until
        self._levels = [-task.gamma, 0.0, task.gamma]
        self._descents = [Descent(library, walk, task) for walk in walks]
        self._known: dict[int, list[Descended]] = {}
        self._fan = fan(library, walks, tuple(self._levels))
        self._pulls = np.zeros((len(walks), len(self._levels)), dtype=complex)

    def soonest(self, bounds: Float[np.ndarray, "walks"], best: Best, gap: float) -> Best:
        """Returns the fastest times within the tolerance; none are faster by more than a gap.

        Args:
            bounds: seconds that each walk takes at least.
            best: the fastest known; something must be.
            gap: seconds.
        """
        return self._search(best, gap, soonest=True, bounds=bounds, limit=best.value)

    def nearest(self, best: Best, gap: float, *, limit: float, enough: float) -> Best:
        """Returns the times whose largest miss is least; for none is it less by more than a gap.

        Args:
            best: the nearest known.
            gap: metres.
            limit: seconds that a plan may take.
            enough: metres with which the search is content.
        """
        return self._search(best, gap, soonest=False, bounds=self.fixed, limit=limit, enough=enough)

    def descend(
        self, row: int, start: Float[np.ndarray, "trims"], limit: float, *, soonest: bool
    ) -> Best | None:
        """Returns the best times near some of a walk, or None if no descent ends well."""
        descent, budget = self._descents[row], limit - float(self.fixed[row])
        if budget < 0:
            return None
        found = (descent.soonest if soonest else descent.nearest)(start, budget)
        if found is None:
            return None
        self._known.setdefault(row, []).append(found)
        value = float(self.fixed[row]) + sum(found.times) if soonest else found.worst.bound
        return Best(self.walks[row], found, value, 0.0, False, 0)

    def _search(
        self,
        best: Best,
        gap: float,
        *,
        soonest: bool,
        bounds: Float[np.ndarray, "walks"],
        limit: float,
        enough: float = 0.0,
    ) -> Best:
        open_ = self._whole(bounds, limit)
        nodes = 0
        row_of = {walk: row for row, walk in enumerate(self.walks)}
        if best.found is not None:
            self._learn(row_of[best.walk], best.found)
        while len(open_.rows) and nodes < self._most_nodes and best.value > enough:
            if perf_counter() > self._until:
                break
            keys = self.fixed[open_.rows] + open_.seconds if soonest else open_.miss
            keep = keys <= best.value - gap
            open_, keys = open_.take(keep), keys[keep]
            if not len(keys):
                break
            chosen = np.zeros(len(keys), dtype=bool)
            chosen[np.argpartition(keys, min(BATCH, len(keys)) - 1)[:BATCH]] = True
            radius = self.task.tolerance if soonest else min(best.value - gap, FAR)
            time = best.value - gap if soonest else limit
            halves = open_.take(chosen).halves()
            nodes += len(halves.rows)
            children = examine(
                self._fan, halves, self.task, self._pulls, radius=radius, budget=time - self.fixed
            )
            best = self._improved(best, children, limit, soonest=soonest)
            open_ = joined([open_.take(~chosen), children])
        keys = self.fixed[open_.rows] + open_.seconds if soonest else open_.miss
        left = float(keys.min(initial=inf))
        bound = min(left, best.value - gap)
        complete = left > best.value - gap
        return Best(best.walk, best.found, best.value, bound, complete, nodes)

    def _whole(self, bounds: Float[np.ndarray, "walks"], limit: float) -> Boxes:
        rows = np.flatnonzero(bounds <= limit)
        trims = self._fan.rate.shape[2]
        high = np.tile((limit - self.fixed[rows])[:, None], (1, trims))
        high[np.arange(trims) >= self._fan.lengths[rows][:, None]] = 0.0
        boxes = Boxes.of(rows, np.zeros_like(high), high)
        return Boxes(
            rows, boxes.low, high, np.maximum(bounds[rows] - self.fixed[rows], 0.0), boxes.miss, boxes.widest
        )

    def _improved(self, best: Best, children: Boxes, limit: float, *, soonest: bool) -> Best:
        keys = self.fixed[children.rows] + children.seconds if soonest else children.miss
        tried = 0
        for place in np.argsort(keys)[: 8 * DESCENTS].tolist():
            if tried == DESCENTS:
                break
            row = int(children.rows[place])
            count = len(self.walks[row])
            low, high = children.low[place, :count], children.high[place, :count]
            if any(
                bool(np.all(low <= known.times) and np.all(known.times <= high))
                for known in self._known.get(row, [])
            ):
                continue
            tried += 1
            found = self.descend(row, 0.5 * (low + high), limit, soonest=soonest)
            if found is None:
                continue
            assert found.found is not None
            self._learn(row, found.found)
            if found.value < best.value:
                best = found
        return best

    def _learn(self, row: int, found: Descended) -> None:
        """Notes which directions cut well near times that were found, and the levels that matter there."""
        apart = 0.02 * self.task.gamma
        new = [
            level
            for level in found.levels
            if min(abs(level - one) for one in self._levels) > apart and len(self._levels) < MOST_LEVELS
        ]
        if new:
            old = self._levels
            self._levels = sorted({*old, *new})
            self._fan = fan(self._library, self.walks, tuple(self._levels))
            pulls = np.zeros((len(self.walks), len(self._levels)), dtype=complex)
            pulls[:, [self._levels.index(one) for one in old]] = self._pulls
            self._pulls = pulls
        self._pulls[row] = 0.0
        for level, pull in zip(found.levels, found.pulls, strict=True):
            nearest = min(range(len(self._levels)), key=lambda place: abs(self._levels[place] - level))
            self._pulls[row, nearest] += pull
