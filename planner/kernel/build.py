"""The kernel's machine code; without a compiler there is none, and NumPy and CasADi search."""

import ctypes
from functools import cache
from pathlib import Path

from runtime.compiler import IEEE_FLAGS, NoMachineCodeError, shared_library

FOLDER = Path(__file__).parent

COASTING = (
    "motion",
    "newton",
    "stretches",
    "roots",
    "curves",
    "closed_forms",
    "bounds",
    "dual_bound",
    "active_sets",
    "units",
)
"""Units that solve one walk at one level."""

SOURCES = (*(FOLDER / "coasting" / f"{unit}.c" for unit in COASTING), FOLDER / "search.c")
HEADERS = (FOLDER / "kernel.h", FOLDER / "coasting" / "coasting.h")

# No fused multiply-adds: the same source gives the same plans on every machine of a kind. A second level of
# optimising would take as long again to compile, and make a tenth.
FLAGS = (
    *("-O1", *IEEE_FLAGS, "-std=gnu11", "-fvisibility=hidden"),
    *("-fcx-limited-range", "-fno-math-errno", "-fno-trapping-math"),
)


@cache
def kernel() -> ctypes.CDLL | None:
    """Returns the compiled kernel, or None where it cannot be had."""
    try:
        return ctypes.CDLL(str(shared_library(SOURCES, headers=HEADERS, flags=FLAGS)))
    except (NoMachineCodeError, OSError):
        return None


def search_backend() -> str:
    """Returns how plans are searched for here, `compiled` or `interpreted`; costs differ by 1e-9 s or so."""
    return "interpreted" if kernel() is None else "compiled"
