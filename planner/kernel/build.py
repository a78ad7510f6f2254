"""The kernel's machine code: compiled when first needed, then kept."""

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
    "automaton.c",
    "remaining.c",
    "frontier.c",
    "search.c",
    "each.c",
)
"""Each includes the one before it."""

# No fused multiply-adds: the same source gives the same plans on every machine of a kind. A second level of
# optimising would take as long again to compile, and make a tenth.
FLAGS = ("-O1", *IEEE_FLAGS, "-std=gnu11", "-fcx-limited-range", "-fno-math-errno", "-fno-trapping-math")


SEARCH_BACKEND = "compiled"
"""How plans are searched for, as logs name it; logs of earlier programs may say `interpreted`."""


@cache
def load_kernel() -> ctypes.CDLL:
    """Returns the compiled kernel.

    Raises:
        NoMachineCodeError: there is no C compiler that works.
    """
    folder = Path(__file__).parent
    path = shared_library([folder / name for name in SOURCES], flags=FLAGS)
    try:
        return ctypes.CDLL(str(path))
    except OSError as error:
        raise NoMachineCodeError(str(error)) from None
