"""Branch and bound over boxes of coasting times of many walks."""

from dataclasses import dataclass, replace
from functools import cache
from math import inf
from time import perf_counter

import numpy as np
from jaxtyping import Float, Int

from flight.automaton.library import Library
from planner.walks.boxes import joined
from planner.walks.walk import Walk

from .boxes import SLACK, CutDirections, TimeBoxes, contract_boxes
from .committed_task import CommittedTask
from .local_search import LocalOptimum, LocalSearch
from .walk_batch import LinearWalkBatch
from .worst_levels import worst_levels

BATCH = 1024
"""Boxes that are halved at once."""

DESCENTS = 2
"""Descents after each batch, from the middles of its most promising boxes."""

LONGEST_PAUSE = 8
"""Batches without descents after many unsuccessful ones."""

GRID = 17
"""Levels at which each box's middle is evaluated, to choose those of its bounds."""

PEAKS = 3
"""Interior levels at which a box is bounded, besides the known active ones."""

LARGE = 0.5
"""Radians; a box whose times turn by more is bounded at three levels only."""

KNOWN = 3
"""Active levels kept near the best times of a walk, those of largest weight."""

FAR = 1e6
"""Metres from the goal beyond which misses are not resolved."""


@dataclass(frozen=True, slots=True)
class Incumbent:
    """The best known times of a search.

    Attributes:
        walk: trim ids.
        found: its coasting times; None where none were found.
        value: seconds or metres; infinite without times.
        bound: lower bound in seconds or metres.
        complete: True if the bound is proved to the gap.
        nodes: boxes examined.
    """

    walk: Walk
    found: LocalOptimum | None
    value: float
    bound: float
    complete: bool
    nodes: int


class BranchAndBound:
    """Branch and bound over the walks of one mission.

    Args:
        library: the primitives.
        walks: all of them that may be flown.
        fixed: seconds that each takes without coasting, at the level where that is most.
        task: the mission over the levels.
        most_nodes: boxes that may be examined.
        until: when to stop, by `time.perf_counter`.
    """

    def __init__(
        self,
        library: Library,
        walks: tuple[Walk, ...],
        fixed: Float[np.ndarray, "walks"],
        task: CommittedTask,
        *,
        most_nodes: int,
        until: float = inf,
    ) -> None:
        self.walks, self.fixed, self.task = walks, fixed, task
        self._most_nodes, self._until = most_nodes, until
        self._descents = cache(lambda row: LocalSearch(library, walks[row], task))
        self._known: dict[int, list[LocalOptimum]] = {}
        self._sheaf = LinearWalkBatch.of(library, walks)
        self._grid = np.linspace(-task.gamma, task.gamma, GRID)
        every, tile = np.arange(len(walks)), (len(walks), 1)
        self._everywhere = self._sheaf.at(every, np.tile(self._grid, tile))
        self._three = self._sheaf.at(every, np.tile(self._grid[:: GRID // 2], tile))
        self._begun = np.zeros(len(walks), dtype=int)
        self._matter = np.zeros((len(walks), KNOWN))
        self._pulls = np.zeros((len(walks), KNOWN), dtype=complex)
        self._twists = np.zeros((len(walks), 2))

    def minimise_time(
        self, bounds: Float[np.ndarray, "walks"], best: Incumbent, gap: float, *, limit: float
    ) -> Incumbent:
        """Returns the fastest feasible times, optimal to within a gap.

        Args:
            bounds: seconds that each walk takes at least.
            best: the fastest known.
            gap: seconds.
            limit: seconds that a plan may take.
        """
        return self._search(best, gap, minimise_time=True, bounds=bounds, limit=min(best.value, limit))

    def minimise_miss(self, best: Incumbent, gap: float, *, limit: float, enough: float) -> Incumbent:
        """Returns the times of least largest miss, to within a gap.

        Args:
            best: the nearest known.
            gap: metres.
            limit: seconds that a plan may take.
            enough: metres at which the search stops.
        """
        return self._search(best, gap, minimise_time=False, bounds=self.fixed, limit=limit, enough=enough)

    def descend(
        self, row: int, start: Float[np.ndarray, "trims"], limit: float, *, minimise_time: bool
    ) -> Incumbent | None:
        """Returns local optimum times of a walk, or None, also when late."""
        descent, budget = self._descents(row), limit - float(self.fixed[row])
        if budget < 0 or perf_counter() > self._until:
            return None
        found = (descent.minimise_time if minimise_time else descent.minimise_miss)(start, budget)
        if found is None:
            return None
        self._known.setdefault(row, []).append(found)
        value = float(self.fixed[row]) + sum(found.times) if minimise_time else found.worst.bound
        return Incumbent(self.walks[row], found, value, 0.0, False, 0)

    def _search(
        self,
        best: Incumbent,
        gap: float,
        *,
        minimise_time: bool,
        bounds: Float[np.ndarray, "walks"],
        limit: float,
        enough: float = 0.0,
    ) -> Incumbent:
        open_ = self._initial_boxes(bounds, limit)
        nodes, vain, pause = 0, 0, 0
        self._known.clear()
        self._begun[:] = 0
        if best.found is not None:
            self._record_cut_directions(self.walks.index(best.walk), best.found)
        while len(open_) and nodes < self._most_nodes and best.value > enough:
            if perf_counter() > self._until:
                break
            keys = self.fixed[open_.rows] + open_.seconds if minimise_time else open_.miss
            keep = keys <= best.value - gap
            open_, keys = open_.take(keep), keys[keep]
            if not len(keys):
                break
            chosen = np.zeros(len(keys), dtype=bool)
            chosen[np.argpartition(keys, min(BATCH, len(keys)) - 1)[:BATCH]] = True
            radius = self.task.tolerance if minimise_time else min(best.value - gap, FAR)
            time = min(best.value - gap, limit) if minimise_time else limit
            whole = open_.take(chosen)
            nodes += 2 * len(whole)
            children = self._contract(whole, radius, time)
            if pause:
                pause -= 1
            else:
                improved = self._improve(best, children, limit, minimise_time=minimise_time)
                vain = 0 if improved.value < best.value else min(vain + 1, LONGEST_PAUSE)
                best, pause = improved, vain
            open_ = joined(open_.take(~chosen), children)
        keys = self.fixed[open_.rows] + open_.seconds if minimise_time else open_.miss
        left = float(keys.min(initial=inf))
        bound = min(left, best.value - gap)
        complete = left == inf or left > best.value - gap
        return Incumbent(best.walk, best.found, best.value, bound, complete, nodes)

    def _contract(self, boxes: TimeBoxes, radius: float, time: float) -> TimeBoxes:
        """Returns the contracted halves of boxes."""
        swing = np.abs(self._sheaf.rate[0][boxes.rows]) * (boxes.high - boxes.low)
        large = (swing > LARGE).any(axis=1)
        return joined(
            self._contract_coarsely(boxes.take(large), radius, time),
            self._contract_closely(boxes.take(~large), radius, time),
        )

    def _contract_coarsely(self, boxes: TimeBoxes, radius: float, time: float) -> TimeBoxes:
        """Returns halves contracted at the middle and outer levels."""
        halves = boxes.halves(boxes.widest)
        rows, budget = halves.rows, time - self.fixed[halves.rows]
        known = CutDirections(np.zeros((len(rows), 3), dtype=complex), np.zeros((len(rows), 2)))
        walk_batch = self._three.take(rows)
        return contract_boxes(walk_batch, halves, self.task, known, radius=radius, budget=budget)

    def _contract_closely(self, boxes: TimeBoxes, radius: float, time: float) -> TimeBoxes:
        """Returns halves contracted at the worst levels and known directions."""
        off = self._everywhere.take(boxes.rows).ends(boxes.middle)[0] - self.task.goal
        inside = np.tile(worst_levels(self._grid, off, PEAKS), (2, 1))
        halves = boxes.halves(boxes.widest)
        rows, budget = halves.rows, time - self.fixed[halves.rows]
        ends = np.tile(self._grid[[0, -1]], (len(rows), 1))
        levels = np.hstack([ends[:, :1], self._matter[rows], inside, ends[:, 1:]])
        position_weights = np.zeros(levels.shape, dtype=complex)
        position_weights[:, 1 : 1 + KNOWN] = self._pulls[rows]
        walk_batch, known = self._sheaf.at(rows, levels), CutDirections(position_weights, self._twists[rows])
        return contract_boxes(walk_batch, halves, self.task, known, radius=radius, budget=budget)

    def _initial_boxes(self, bounds: Float[np.ndarray, "walks"], limit: float) -> TimeBoxes:
        """Returns the initial boxes for each number of full turns."""
        rows = np.flatnonzero(bounds <= limit)
        trims = self._sheaf.rate.shape[2]
        high = np.tile((limit - self.fixed[rows])[:, None], (1, trims))
        high[np.arange(trims) >= self._sheaf.lengths[rows][:, None]] = 0.0
        if not self.task.wants_heading:
            return self._boxes(rows, np.zeros(len(rows), dtype=int), high, bounds)
        off = self._sheaf.turned[0][rows, -1] - self.task.heading
        swept, allowed = self._sheaf.rate[0][rows] * high, self.task.heading_tolerance + SLACK
        fewest = np.ceil((off + np.minimum(swept, 0).sum(axis=1) - allowed) / (2 * np.pi)).astype(int)
        most = np.floor((off + np.maximum(swept, 0).sum(axis=1) + allowed) / (2 * np.pi)).astype(int)
        each = np.repeat(np.arange(len(rows)), np.maximum(most - fewest + 1, 0))
        turns = fewest[each] + np.arange(len(each)) - np.searchsorted(each, each)
        return self._boxes(rows[each], turns, high[each], bounds)

    def _boxes(
        self,
        rows: Int[np.ndarray, "n"],
        turns: Int[np.ndarray, "n"],
        high: Float[np.ndarray, "n trims"],
        bounds: Float[np.ndarray, "walks"],
    ) -> TimeBoxes:
        boxes = TimeBoxes.of(rows, turns, np.zeros_like(high), high)
        return replace(boxes, seconds=np.maximum(bounds[rows] - self.fixed[rows], 0.0))

    def _improve(
        self, best: Incumbent, children: TimeBoxes, limit: float, *, minimise_time: bool
    ) -> Incumbent:
        if best.found is not None and minimise_time:
            keys = self.fixed[children.rows] + children.seconds
        else:
            keys = children.near * (1 + self._begun[children.rows])
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
            self._begun[row] += 1
            found = self.descend(row, 0.5 * (low + high), limit, minimise_time=minimise_time)
            if found is None:
                continue
            assert found.found is not None
            self._record_cut_directions(row, found.found)
            if found.value < best.value:
                best = found
        return best

    def _record_cut_directions(self, row: int, found: LocalOptimum) -> None:
        """Records the active levels and cut directions of an incumbent."""
        heaviest = np.argsort(-np.abs(found.position_weights))[:KNOWN]
        self._matter[row], self._pulls[row] = 0.0, 0.0
        self._matter[row, : len(heaviest)] = np.array(found.levels)[heaviest]
        self._pulls[row, : len(heaviest)] = np.array(found.position_weights)[heaviest]
        self._twists[row] = found.heading_weights
