"""CasADi functions bound to arrays: evaluated in a microsecond, where the call with values takes fifty."""

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np


class BoundFunction:
    """A function that reads and writes always the same arrays of doubles.

    Args:
        function: with dense arguments and results.
        arguments: arrays in column-major order, one for each argument.
        results: likewise; none of them may be an argument too.
    """

    __slots__ = ("_buffer", "evaluate")

    evaluate: Callable[[], None]
    """Reads the arguments and writes the results."""

    def __init__(
        self,
        function: ca.Function,
        arguments: Sequence[np.ndarray[Any, Any]],
        results: Sequence[np.ndarray[Any, Any]],
    ) -> None:
        buffer: Any
        buffer, self.evaluate = function.buffer()
        for place, argument in enumerate(arguments):
            buffer.set_arg(place, memoryview(argument.data))
        for place, result in enumerate(results):
            buffer.set_res(place, memoryview(result.data))
        # The evaluation reads the buffer; whoever holds the one holds the other.
        self._buffer = buffer
