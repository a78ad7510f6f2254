"""Value iteration, in C, with bounds from both sides."""

import ctypes
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from math import inf

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError

from .build import load_recourse
from .problem import ShortestPathProblem
from .structures import Structures, structures

GAP = 0.05
"""Seconds between the bounds of the largest value at which a table is done."""

MOST_SWEEPS = 200
"""Sweeps over all actions after which a table counts as not solvable."""

EVALUATIONS = 4
"""Sweeps over the chosen actions alone between two over all of them."""

_IMPROVE, _EVALUATE = 0, 1
# Rows of nodes that one thread takes at a time.
_ROWS = 16


class NotSolvedError(FlightError):
    """Value iteration did not converge."""

    def __init__(self, gap: float) -> None:
        super().__init__(
            f"expected bounds of the least time at most {GAP} s apart after {MOST_SWEEPS} sweeps, got {gap:.3g} s"
        )


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """Least expected times of a problem.

    Attributes:
        values: seconds at every node, below 0 inside the tolerance.
        gap: seconds between the bounds of the largest value.
        sweeps: over all actions.
    """

    values: Float[np.ndarray, "trims levels side side"]
    gap: float
    sweeps: int


def first_values(problem: ShortestPathProblem) -> Float[np.ndarray, "trims levels side side"]:
    """Returns the seconds at the best speed, -1 inside the tolerance."""
    grid = problem.grid
    values = np.empty((len(problem.trims), grid.levels, grid.side, grid.side), dtype=np.float32)
    for level in range(grid.levels):
        distance = np.hypot(*grid.positions(level))
        values[:, level] = distance / problem.best_speed + 30.0
        inside = distance <= problem.tolerance
        for trim, ends in enumerate(problem.ends):
            if ends:
                values[trim, level][inside] = -1.0
    return values


def solve(problem: ShortestPathProblem, *, threads: int = 2) -> Solution:
    """Returns the least expected times, the same bytes for any number of threads.

    All nodes of one trim on one grid are computed from the values before and then stored together. With
    values V of which no node changes by more than a share r of the seconds of its best action, nor falls by
    more than a share s of those of any action, the greedy policy takes at most V / (1 - r) and no policy less
    than V / (1 + s).

    Args:
        problem: the statement.
        threads: of this machine.

    Raises:
        NotSolvedError: the bounds do not meet.
        NoMachineCodeError: there is no C compiler that works.
    """
    values = first_values(problem)
    with ThreadPoolExecutor(threads) as pool:
        work = _Sweeps(problem, structures(problem, values), values, pool)
        gap = inf
        for sweep in range(1, MOST_SWEEPS + 1):
            work.sweep(_IMPROVE)
            for _ in range(EVALUATIONS):
                work.sweep(_EVALUATE)
            if work.settled:
                gap = work.gap()
            if gap <= GAP:
                return Solution(values, gap, sweep)
    raise NotSolvedError(gap)


class _Sweeps:
    """Sweeps of one problem over its values, in place."""

    def __init__(
        self, problem: ShortestPathProblem, data: Structures, values: np.ndarray, pool: ThreadPoolExecutor
    ) -> None:
        self._problem, self._data, self._values, self._pool = problem, data, values, pool
        self._made = np.empty_like(values)
        self._choice = np.zeros(values.shape, dtype=np.uint8)
        self._changed = inf
        self._code = load_recourse().sweep

    @property
    def settled(self) -> bool:
        """Whether the last sweep over all actions changed hardly anything."""
        return self._changed <= GAP

    def sweep(self, mode: int) -> None:
        """Sweeps over trims and grids, each from the values that it finds."""
        before = self._values.copy() if mode == _IMPROVE else None
        for trim, level in self._blocks():
            self._block(trim, level, mode)
            self._values[trim, level] = self._made[trim, level]
        if before is not None:
            self._changed = float(np.abs(self._values - before).max())

    def gap(self) -> float:
        """Returns the seconds between the bounds of the largest value."""
        rise, fall = 0.0, 0.0
        for trim, level in self._blocks():
            changes = self._block(trim, level, _IMPROVE)
            rise, fall = max(rise, changes[0]), max(fall, changes[1])
        largest = max(float(self._values[:, level][:, used].max()) for level, used in self._used())
        return inf if rise >= 1 else largest * (1 / (1 - rise) - 1 / (1 + fall))

    def _used(self) -> Iterator[tuple[int, np.ndarray]]:
        grid = self._problem.grid
        return ((level, grid.used(level)) for level in range(grid.levels))

    def _blocks(self) -> Iterator[tuple[int, int]]:
        levels, trims = self._problem.grid.levels, len(self._problem.trims)
        return ((trim, level) for level in range(levels) for trim in range(trims))

    def _block(self, trim: int, level: int, mode: int) -> tuple[float, float]:
        side, data = self._problem.grid.side, self._data
        made, choice = self._made[trim, level].ctypes.data, self._choice[trim, level].ctypes.data

        def rows(begin: int) -> tuple[float, float]:
            change = (ctypes.c_double * 2)(0.0, 0.0)
            self._code(
                ctypes.byref(data.table),
                ctypes.byref(data.actions),
                trim,
                level,
                begin,
                min(begin + _ROWS, side),
                mode,
                ctypes.c_void_p(made),
                ctypes.c_void_p(choice),
                change,
            )
            return change[0], change[1]

        changes = list(self._pool.map(rows, range(0, side, _ROWS)))
        return max(one[0] for one in changes), max(one[1] for one in changes)
