"""Random numbers drawn in blocks, used row by row."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from .bound_function import Array, memory_view

_ROWS = 512


class Noise:
    """Array filled with new random numbers every period.

    Args:
        row: array to fill.
        draw: returns random numbers for a number of periods, one row each.
    """

    def __init__(self, row: Array, draw: Callable[[int], Float[np.ndarray, "n width"]]) -> None:
        self._row, self._draw, self._width = memory_view(row), draw, len(row)
        self._full = self._place = _ROWS * len(row)
        self._block = memory_view(row)

    def next(self) -> None:
        """Fills the array with the next row."""
        if self._place == self._full:
            self._block, self._place = memory_view(self._draw(_ROWS).ravel()), 0
        end = self._place + self._width
        self._row[:] = self._block[self._place : end]
        self._place = end
