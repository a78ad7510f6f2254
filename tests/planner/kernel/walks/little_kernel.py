"""The kernel built with little room, so that small missions use all of it."""

import ctypes
from functools import cache

from planner.kernel.build import FLAGS, HEADERS, SOURCES
from runtime.compiler import shared_library


@cache
def little_kernel() -> ctypes.CDLL:
    """Returns a kernel that learns at once and descends when 40 walks wait."""
    return ctypes.CDLL(str(shared_library(SOURCES, headers=HEADERS, flags=(*FLAGS, "-DLITTLE"))))
