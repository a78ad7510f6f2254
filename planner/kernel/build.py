"""The kernel's machine code; without a compiler there is none, and NumPy and CasADi search."""

import ctypes
from functools import cache
from pathlib import Path

from runtime.compiler import IEEE_FLAGS, NoMachineCodeError, shared_library

SOURCES = (
    "times.c",
    "stretches.c",
    "roots.c",
    "curves.c",
    "closed_forms.c",
    "bounds.c",
    "duality.c",
    "sets.c",
    "known.c",
    "alike.c",
    "solve.c",
    "automaton.c",
    "remaining.c",
    "frontier.c",
    "levels.c",
    "search.c",
    "each.c",
)
"""Each includes the one before it."""

# No fused multiply-adds: the same source gives the same plans on every machine of a kind. A second level of
# optimising would take as long again to compile, and make a tenth.
FLAGS = ("-O1", *IEEE_FLAGS, "-std=gnu11", "-fcx-limited-range", "-fno-math-errno", "-fno-trapping-math")


@cache
def kernel() -> ctypes.CDLL | None:
    """Returns the compiled kernel, or None where it cannot be had."""
    folder = Path(__file__).parent
    try:
        return ctypes.CDLL(str(shared_library([folder / name for name in SOURCES], flags=FLAGS)))
    except (NoMachineCodeError, OSError):
        return None


def search_backend() -> str:
    """Returns how plans are searched for here, `compiled` or `interpreted`; costs differ by 1e-9 s or so."""
    return "interpreted" if kernel() is None else "compiled"
