"""CasADi functions bound to arrays: evaluated in a microsecond, where the call with values takes fifty."""

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from .backend import Backend, prepare_function

Array = np.ndarray[Any, np.dtype[np.float64]]


def memory_view(array: Array) -> memoryview:
    """Returns the memory of an array; it copies from one to another faster than arrays do."""
    return memoryview(array.data)


class BoundFunction:
    """A function that reads and writes always the same arrays of doubles.

    Args:
        function: with dense arguments and results.
        arguments: contiguous arrays in column-major order, one for each argument.
        results: likewise; none of them may be an argument too.
        backend: what evaluates the function.
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
        # The evaluation reads the buffer; whoever holds the one holds the other.
        self._buffer = buffer


class Recursion:
    """A bound function that moves a state on: its last argument, and its last result.

    Args:
        function: with dense arguments and results.
        arguments: arrays, one for each argument; the last is the state.
        results: arrays, one for each result but the last.
        backend: what evaluates the function.
    """

    __slots__ = ("step",)

    step: Callable[[], None]
    """Reads the arguments, writes the results and moves the state on."""

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
