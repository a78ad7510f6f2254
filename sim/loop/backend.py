"""Numeric back-ends: CasADi interpreter or bit-identical machine code.

Machine code is the C that CasADi writes of an expression, compiled once (`runtime.compiler`),
without anything that would reorder arithmetic. Before it is used it is held to the interpreter, bit by bit,
on random numbers, so that a flight does not depend on whether there is a compiler.
"""

import os
import tempfile
from enum import StrEnum
from functools import cache
from importlib.metadata import version
from pathlib import Path

import casadi as ca
import numpy as np

from flight.errors import FlightError
from runtime.compiler import IEEE_FLAGS, NoMachineCodeError, shared_library

# Random arguments of several magnitudes in the comparison.
_PROBES = 8
# Thousands of lines without a branch: -O2 compiles half as long again and runs no faster.
_FLAGS = ("-O1", *IEEE_FLAGS)


class Backend(StrEnum):
    """Numeric back-end."""

    INTERPRETED = "interpreted"
    COMPILED = "compiled"


class BitMismatchError(FlightError):
    """Machine code with other bits than its expression."""

    def __init__(self, name: str) -> None:
        super().__init__(f"expected machine code of {name!r} with the interpreter's bits, got other bits")


def name_backend(backend: Backend) -> str:
    """Returns the back-end's name in logs, such as `casadi-3.8.2 compiled`."""
    return f"casadi-{version('casadi')} {backend}"


@cache
def best_backend() -> Backend:
    """Returns `COMPILED` if a compiler works, else `INTERPRETED`."""
    x = ca.SX.sym("x")
    try:
        prepare_function(ca.Function("probe", [x], [ca.sin(x)]), Backend.COMPILED)
    except (NoMachineCodeError, BitMismatchError):
        return Backend.INTERPRETED
    return Backend.COMPILED


@cache
def prepare_function(function: ca.Function, backend: Backend) -> ca.Function:
    """Returns a function for evaluation by the back-end.

    Raises:
        NoMachineCodeError: no compiler works.
        BitMismatchError: the machine code has other bits than the interpreter.
    """
    if backend is Backend.INTERPRETED:
        return function
    name = function.name()
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / f"{name}.c"
        writer = ca.CodeGenerator(source.name)
        writer.add(function)
        # Ends with a separator, or it would be part of the name.
        writer.generate(folder + os.sep)
        path = shared_library([source], flags=_FLAGS)
    try:
        machine_code = ca.external(name, str(path))
    except RuntimeError as error:
        raise NoMachineCodeError(str(error).splitlines()[-1]) from None
    if not same_bits(function, machine_code):
        raise BitMismatchError(name)
    return machine_code


def same_bits(function: ca.Function, other: ca.Function) -> bool:
    """Returns True if two functions agree bitwise on random arguments."""
    rng = np.random.default_rng(1)
    for scale in np.geomspace(1e-3, 1e3, _PROBES):
        arguments = [scale * rng.standard_normal(function.size_in(place)) for place in range(function.n_in())]
        expected, got = (each.call([ca.DM(argument) for argument in arguments]) for each in (function, other))
        for one, two in zip(expected, got, strict=True):
            if not np.array_equal(np.array(one), np.array(two), equal_nan=True):
                return False
    return True
