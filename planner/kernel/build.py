"""The kernel's machine code: compiled when first needed, then cached."""

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
    "set_cache",
    "similar_sets",
    "active_sets",
    "enumeration",
    "units",
)
"""Units that solve one walk at one level."""

WALKS = ("automaton", "remaining", "frontier", "branching", "levels", "each", "list", "search")
"""Units that search over walks."""

SOURCES = (
    *(FOLDER / "coasting" / f"{unit}.c" for unit in COASTING),
    *(FOLDER / "walks" / f"{unit}.c" for unit in WALKS),
)
HEADERS = (FOLDER / "kernel.h", FOLDER / "coasting" / "coasting.h", FOLDER / "walks" / "walks.h")

# No fused multiply-adds: the same source gives the same plans on every machine of a kind. A second level of
# optimising would take as long again to compile, and make a tenth.
FLAGS = (
    *("-O1", *IEEE_FLAGS, "-std=gnu11", "-fvisibility=hidden"),
    *("-fcx-limited-range", "-fno-math-errno", "-fno-trapping-math"),
)


SEARCH_BACKEND = "compiled"
"""Back-end of the search, as logs name it; logs of earlier programs may say `interpreted`."""


@cache
def load_kernel() -> ctypes.CDLL:
    """Returns the compiled kernel.

    Raises:
        NoMachineCodeError: there is no C compiler that works.
    """
    path = shared_library(SOURCES, headers=HEADERS, flags=FLAGS)
    try:
        return ctypes.CDLL(str(path))
    except OSError as error:
        raise NoMachineCodeError(str(error)) from None
