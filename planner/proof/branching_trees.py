"""Branching over boxes of coasting times until all are refuted."""

from math import inf

import numpy as np
from jaxtyping import Bool, Complex, Float, Int

from flight.mission.destination import SLACK
from flight.plan.certificate import BoxLeaf, BoxSplit, write_tree

from .dual_bound import PerBox, PerTrim, WalkProblems
from .multipliers import MultiplierSearch

MARGIN = 1e-7
"""Margin of a refutation, so that the check with outward rounding agrees."""

ROUNDING = 1e-14
"""Relative margin, of the bound's terms, which cancel for slow turns."""

DIGITS, EXACT = 9, 17
"""Digits of multipliers in general, and with turns slower than `SLOW`."""

SLOW = 1e-2
"""Yaw rate in rad/s below which multipliers need all digits, for the turn's radius."""

LONG = 1e3
"""Seconds that stand for an unbounded interval in the choice of cuts."""

NEWTON_ROUNDS = 4

UNUSED = 0.99
"""Of the slack for rounding: times that would use it up are not faster."""


def root_boxes(problems: WalkProblems, target: float) -> tuple[PerTrim, PerTrim]:
    """Returns bounds of coasting times for walks faster than a target."""
    rest = np.maximum(target - problems.fixed, 0.0)[:, None]
    return np.zeros(problems.rate.shape), np.minimum(problems.longest, rest)


class BranchingTrees:
    """The trees of several walks at one level, branched together."""

    def __init__(self, problems: WalkProblems, target: float) -> None:
        self._flown, self._problems = problems, problems.straightened(target)
        self._target = target
        self.ways: dict[int, tuple[float, ...]] = {}
        count = len(problems.rate)
        self.left: Bool[np.ndarray, "walks"] = np.zeros(count, dtype=bool)
        self.reached: Bool[np.ndarray, "walks"] = np.zeros(count, dtype=bool)
        self._first: Int[np.ndarray, "walks"] = np.zeros(count, dtype=int)
        self._nodes: list[BoxSplit | BoxLeaf | None] = []
        self._parts: list[tuple[int, int]] = []

    def branch(self, rows: Int[np.ndarray, "some"], effort: int) -> None:
        """Branches boxes until all are refuted or the effort is spent.

        Afterwards `left` marks the walks that are not refuted, `reached` those that reach the goal in time,
        and `ways` holds their coasting times.
        """
        self._first[rows] = np.arange(len(rows))
        self._nodes = [None] * len(rows)
        self._parts = [(-1, -1)] * len(rows)
        node = np.arange(len(rows))
        low, high = (part[rows] for part in root_boxes(self._problems, self._target))
        hint = np.zeros(len(rows), dtype=complex)
        spent = np.zeros(len(self.left), dtype=int)
        while len(rows):
            problems = self._problems.take(rows)
            rest = self._target - problems.fixed - low.sum(axis=1)
            narrowed = np.minimum(high, low + np.maximum(rest, 0.0)[:, None])
            search = MultiplierSearch(problems, low, narrowed, self._target)
            search.run(hint)
            empty = rest < -MARGIN
            done = empty | (search.excess > MARGIN + ROUNDING * _magnitude(problems, search))
            self._record(problems, node[done], search, np.flatnonzero(done), empty[done])
            some = ~done
            found, times = _find_reaching_times(
                self._flown.take(rows[some]), search.middle[some], self._target
            )
            self.reached[rows[some][found]] = True
            self.ways |= dict(zip(rows[some][found].tolist(), map(tuple, times[found].tolist()), strict=True))
            spent += np.bincount(rows, minlength=len(spent))
            late = spent > effort
            self.left |= self.reached | (late & np.isin(np.arange(len(spent)), rows[some]))
            some &= ~self.left[rows]
            place, time = _choose_cuts(
                problems.take(np.flatnonzero(some)), low[some], narrowed[some], search, some
            )
            node, low, high = self._divide(node[some], low[some], high[some], place, time)
            rows = np.tile(rows[some], 2)
            hint = np.tile(np.where(search.by.kappa == 1, search.by.vector, 0.0)[some], 2)

    def _divide(
        self,
        node: Int[np.ndarray, "boxes"],
        low: PerTrim,
        high: PerTrim,
        place: Int[np.ndarray, "boxes"],
        time: Float[np.ndarray, "boxes"],
    ) -> tuple[Int[np.ndarray, "twice"], Float[np.ndarray, "twice trims"], Float[np.ndarray, "twice trims"]]:
        count, base = len(node), len(self._nodes)
        for index, (one, axis, cut) in enumerate(
            zip(node.tolist(), place.tolist(), time.tolist(), strict=True)
        ):
            self._nodes[one] = BoxSplit(axis, cut)
            self._parts[one] = base + index, base + count + index
        self._nodes += [None] * (2 * count)
        self._parts += [(-1, -1)] * (2 * count)
        every = np.arange(count)
        before, after = high.copy(), low.copy()
        before[every, place] = time
        after[every, place] = time
        children = np.arange(base, base + 2 * count)
        return children, np.concatenate([low, after]), np.concatenate([before, high])

    def _record(
        self,
        problems: WalkProblems,
        node: Int[np.ndarray, "done"],
        search: MultiplierSearch,
        which: Int[np.ndarray, "done"],
        empty: Bool[np.ndarray, "done"],
    ) -> None:
        by = search.by
        slow = ((problems.rate != 0) & (np.abs(problems.rate) < SLOW)).any(axis=1)
        for one, index, nothing in zip(node.tolist(), which.tolist(), empty.tolist(), strict=True):
            if nothing or search.excess[index] == inf:
                self._nodes[one] = BoxLeaf()
                continue
            vector, digits = complex(by.vector[index]), EXACT if slow[index] else DIGITS
            self._nodes[one] = BoxLeaf(
                int(by.kappa[index]),
                (_round(vector.real, digits), _round(vector.imag, digits)),
                tuple(_round(share, digits) for share in by.shares[index].tolist()),
            )

    def text(self, row: int, trims: int) -> str:
        """Returns the certificate tree of a refuted walk."""
        ordered: list[BoxSplit | BoxLeaf] = []
        waiting = [int(self._first[row])]
        while waiting:
            at = waiting.pop()
            node = self._nodes[at]
            assert node is not None
            if isinstance(node, BoxSplit):
                waiting += reversed(self._parts[at])
            elif node.kappa is not None:
                node = BoxLeaf(node.kappa, node.vector, node.shares[:trims])
            ordered.append(node)
        return write_tree(ordered)


def _magnitude(problems: WalkProblems, search: MultiplierSearch) -> PerBox:
    """Returns the magnitude of the bound's terms."""
    turns = problems.rate != 0
    radian = np.where(turns, np.abs(search.by.kappa[:, None] - search.by.shares), 0.0)
    radian = radian / np.where(turns, np.abs(problems.rate), 1.0)
    along = np.abs(search.by.vector) * (np.abs(problems.goal) + np.abs(problems.centre).sum(axis=1))
    sizes: PerBox = along + 2 * np.pi * radian.sum(axis=1)
    return sizes


def _round(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


def _choose_cuts(
    problems: WalkProblems,
    low: PerTrim,
    high: PerTrim,
    search: MultiplierSearch,
    some: Bool[np.ndarray, "all"],
) -> tuple[Int[np.ndarray, "boxes"], Float[np.ndarray, "boxes"]]:
    """Returns each box's cut: the time that most loosens the bound.

    The bound's error is, for every heading, its interval squared times the turn radius.
    """
    width = np.minimum(np.where(np.isfinite(high), high - low, LONG), LONG)
    turning = np.abs(problems.rate) * width
    total = np.cumsum(turning, axis=1)
    onward = np.roll(problems.centre, -1, axis=1)
    onward[:, -1:] = 0
    ahead = np.roll(problems.displacement, -1, axis=1)
    ahead[:, -1:] = 0
    radius = np.abs(problems.centre - onward + ahead)
    straight = problems.rate == 0
    moved = np.where(straight, np.abs(problems.velocity) * width, 0.0)
    bent = np.minimum(total, np.pi)
    blur = np.cumsum((radius * bent)[:, ::-1], axis=1)[:, ::-1]
    score = np.where(
        straight, moved * (bent + 1e-3), np.minimum(turning, np.pi) * (blur + moved.sum(axis=1)[:, None])
    )
    score = np.where(width > 0, score, -1.0)
    place = score.argmax(axis=1)
    every = np.arange(len(place))
    first, last = low[every, place], high[every, place]
    ended = np.isfinite(last)
    return place, np.where(ended, 0.5 * (first + np.where(ended, last, 0.0)), 2 * first + 10.0)


def _find_reaching_times(
    problems: WalkProblems, times: PerTrim, target: float
) -> tuple[Bool[np.ndarray, "boxes"], PerTrim]:
    """Returns where goal-reaching times near given ones exist, and these times."""
    for _ in range(NEWTON_ROUNDS):
        velocity, end, turned = problems.propagate(times)
        miss, off = _goal_misses(problems, end, turned)
        rows = [velocity.real, velocity.imag] + ([] if problems.heading is None else [problems.rate])
        matrix = np.stack(rows, axis=1)
        wrong = np.stack([miss.real, miss.imag] + ([] if problems.heading is None else [off]), axis=1)
        square = matrix @ matrix.transpose(0, 2, 1)
        size = np.trace(square, axis1=1, axis2=2)[:, None, None]
        square = square + 1e-12 * (1.0 + size) * np.eye(matrix.shape[1])
        step = matrix.transpose(0, 2, 1) @ np.linalg.solve(square, wrong[..., None])
        times = np.maximum(times - step[..., 0], 0.0)
    _, end, turned = problems.propagate(times)
    there = np.abs(end - problems.goal) <= problems.tolerance - UNUSED * problems.slack
    if problems.heading is not None:
        there &= np.abs(_heading_off(problems, turned)) <= problems.heading_tolerance - UNUSED * SLACK
    cost = problems.fixed + times.sum(axis=1)
    return np.asarray(there & (cost < target)), times


def _goal_misses(
    problems: WalkProblems, end: Complex[np.ndarray, "boxes"], turned: Float[np.ndarray, "boxes"]
) -> tuple[Complex[np.ndarray, "boxes"], Float[np.ndarray, "boxes"]]:
    """Returns excess distances and heading errors beyond the goal's tolerances."""
    away = end - problems.goal
    size = np.abs(away)
    inner = 0.999 * (problems.tolerance - problems.slack)
    miss = np.where(size > inner, away * (1 - inner / np.maximum(size, 1e-300)), 0.0)
    if problems.heading is None:
        return miss, np.zeros(len(end))
    off = _heading_off(problems, turned)
    inside = 0.999 * (problems.heading_tolerance - SLACK)
    return miss, np.sign(off) * np.maximum(np.abs(off) - inside, 0.0)


def _heading_off(problems: WalkProblems, turned: Float[np.ndarray, "boxes"]) -> Float[np.ndarray, "boxes"]:
    """Returns absolute heading errors."""
    assert problems.heading is not None
    off = turned + problems.turned - problems.heading
    nearest: Float[np.ndarray, "boxes"] = off - 2 * np.pi * np.round(off / (2 * np.pi))
    return nearest
