"""Delay line of arrays by a number of periods."""

from collections.abc import Sequence
from itertools import accumulate

import numpy as np

from .bound_function import Array, memory_view


class DelayLine:
    """Buffer of the last rows of some arrays.

    Args:
        sources: arrays of doubles, side by side in a row.
        periods: delay in pushes.
    """

    def __init__(self, sources: Sequence[Array], *, periods: int) -> None:
        sizes = [len(source) for source in sources]
        self.rows = np.zeros((periods + 1, sum(sizes)))
        """Stored rows, in no order."""
        edges = [*accumulate(sizes)][:-1]
        self._copies = [
            [
                (memory_view(part), memory_view(source))
                for part, source in zip(np.split(row, edges), sources, strict=True)
            ]
            for row in self.rows
        ]
        self._newest = 0

    def push(self) -> None:
        """Stores the current values of the sources."""
        self._newest = newest = (self._newest + 1) % len(self._copies)
        for part, source in self._copies[newest]:
            part[:] = source

    @property
    def oldest(self) -> Array:
        """Values of the sources `periods` pushes before the last one."""
        oldest: Array = self.rows[(self._newest + 1) % len(self.rows)]
        return oldest
