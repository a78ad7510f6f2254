"""CasADi functions bound to arrays, for evaluation within a microsecond."""

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from .backend import Backend, prepare_function

Array = np.ndarray[Any, np.dtype[np.float64]]


def memory_view(array: Array) -> memoryview:
    """Returns an array's memory, which copies faster than arrays."""
    return memoryview(array.data)


class BoundFunction:
    """Function bound to fixed arrays of doubles.

    Args:
        function: function with dense arguments and results.
        arguments: contiguous arrays in column-major order, one for each argument.
        results: arrays of the same layout, none of them an argument.
        backend: numeric back-end.
    """

    __slots__ = ("_buffer", "evaluate")

    evaluate: Callable[[], None]
    """Reads the arguments and writes the results."""

    def __init__(
        self,
        function: ca.Function,
        arguments: Sequence[Array],
        results: Sequence[Array],
        *,
        backend: Backend = Backend.INTERPRETED,
    ) -> None:
        buffer: Any
        buffer, self.evaluate = prepare_function(function, backend).buffer()
        for place, argument in enumerate(arguments):
            buffer.set_arg(place, memory_view(argument))
        for place, result in enumerate(results):
            buffer.set_res(place, memory_view(result))
        # The evaluation needs the buffer alive.
        self._buffer = buffer


class Recursion:
    """Bound function that advances its last argument, the state.

    Args:
        function: function with dense arguments and results; the last result is the new state.
        arguments: arrays, one for each argument; the last is the state.
        results: arrays, one for each result but the last.
        backend: numeric back-end.
    """

    __slots__ = ("step",)

    step: Callable[[], None]
    """Reads the arguments, writes the results and advances the state."""

    def __init__(
        self,
        function: ca.Function,
        arguments: Sequence[Array],
        results: Sequence[Array],
        *,
        backend: Backend = Backend.INTERPRETED,
    ) -> None:
        state, moved = arguments[-1], np.zeros_like(arguments[-1])
        bound = BoundFunction(function, arguments, (*results, moved), backend=backend)
        evaluate, before, after = bound.evaluate, memory_view(state), memory_view(moved)

        def step(_kept: BoundFunction = bound) -> None:
            evaluate()
            before[:] = after

        self.step = step
