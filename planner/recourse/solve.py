"""Value iteration, in C, with bounds from both sides."""

import ctypes
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
"""Sweeps after which a table counts as not solvable, those over chosen actions not counted."""

FIRST_SWEEPS = 4
"""Sweeps over all actions before some are left out."""

PERIOD = 4
"""Of so many sweeps at least one is over all actions: values must not rise with the others left out."""

EVALUATIONS = 4
"""Sweeps over the chosen actions alone after each other one."""

MARGIN = 2.0
"""Seconds by which an action may be slower than the best and is still considered in between."""

PESSIMISM = 30.0
"""Seconds above those at the best speed to begin with: from above few sweeps suffice."""

_ALL, _LIKELY, _CHOSEN = 0, 1, 2
# Rows of nodes that one thread takes at a time.
_ROWS = 16


class NotSolvedError(FlightError):
    """Value iteration did not converge."""

    def __init__(self, gap: float) -> None:
        super().__init__(
            f"expected bounds of the least time at most {GAP} s apart after {MOST_SWEEPS} sweeps, "
            f"got {gap:.3g} s"
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
    """Returns pessimistic seconds, -1 inside the tolerance."""
    grid = problem.grid
    values = np.empty((len(problem.trims), grid.levels, grid.side, grid.side), dtype=np.float32)
    for level in range(grid.levels):
        distance = np.hypot(*grid.positions(level))
        values[:, level] = distance / problem.best_speed + PESSIMISM
        inside = distance <= problem.tolerance
        for trim, ends in enumerate(problem.ends):
            if ends:
                values[trim, level][inside] = -1.0
    return values


def solve(problem: ShortestPathProblem, *, threads: int = 2) -> Solution:
    """Returns the least expected times.

    The bytes are the same for any number of threads.
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
        gap, sure = inf, True
        for sweep in range(1, MOST_SWEEPS + 1):
            gap = work.bounds_of_all() if sure else work.improve()
            if sure and gap <= GAP:
                return Solution(values, gap, sweep)
            work.store_and_evaluate()
            sure = sweep < FIRST_SWEEPS or sweep % PERIOD == 0 or (gap <= GAP and not sure)
    raise NotSolvedError(gap)


class _Sweeps:
    """Sweeps of one problem over its values, in place."""

    def __init__(
        self, problem: ShortestPathProblem, data: Structures, values: np.ndarray, pool: ThreadPoolExecutor
    ) -> None:
        self._problem, self._data, self._values, self._pool = problem, data, values, pool
        self._made = values.copy()
        self._choice = np.zeros(values.shape, dtype=np.uint8)
        self._likely = np.zeros(values.shape, dtype=np.uint64)
        self._code = load_recourse().sweep
        grid = problem.grid
        self._blocks = [(trim, level) for level in range(grid.levels) for trim in range(len(problem.trims))]

    def bounds_of_all(self) -> float:
        """Prepares the next values; returns the seconds between their bounds."""
        return self._gap([self._block(block, _ALL) for block in self._blocks])

    def improve(self) -> float:
        """Improves the values by likely actions; returns what `bounds_of_all` may find."""
        changes = []
        for block in self._blocks:
            changes.append(self._block(block, _LIKELY))
            self._values[block] = self._made[block]
        return self._gap(changes)

    def store_and_evaluate(self) -> None:
        """Stores the next values and improves them by the chosen actions."""
        self._values[...] = self._made
        for _ in range(EVALUATIONS):
            for block in self._blocks:
                self._block(block, _CHOSEN)
                self._values[block] = self._made[block]

    def _gap(self, changes: list[tuple[float, float]]) -> float:
        rise, fall = max(one[0] for one in changes), max(one[1] for one in changes)
        largest = max(
            float(self._values[:, level][:, self._problem.grid.used(level)].max())
            for level in range(self._problem.grid.levels)
        )
        return inf if rise >= 1 else largest * (1 / (1 - rise) - 1 / (1 + fall))

    def _block(self, block: tuple[int, int], mode: int) -> tuple[float, float]:
        side, data = self._problem.grid.side, self._data
        pointers = [array[block].ctypes.data for array in (self._made, self._choice, self._likely)]

        def rows(begin: int) -> tuple[float, float]:
            change = (ctypes.c_double * 2)(0.0, 0.0)
            self._code(
                ctypes.byref(data.table),
                ctypes.byref(data.actions),
                *block,
                begin,
                min(begin + _ROWS, side),
                mode,
                ctypes.c_double(MARGIN),
                *map(ctypes.c_void_p, pointers),
                change,
            )
            return change[0], change[1]

        changes = list(self._pool.map(rows, range(0, side, _ROWS)))
        return max(one[0] for one in changes), max(one[1] for one in changes)
