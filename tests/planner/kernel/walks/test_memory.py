"""Tests of the kernel where memory is short: it plans without what it would learn."""

import ctypes
import subprocess
import sys

import pytest

from tests.planner.kernel.native import native

pytestmark = pytest.mark.kernel

WITH_LITTLE_MEMORY = """
import ctypes
import resource
from tests.planner.kernel.native import native
make = native().make_similar_sets
make.restype = ctypes.c_void_p
assert make(ctypes.c_double(1.0), ctypes.c_double(1.0))
pages = int(open("/proc/self/statm").read().split()[0])
most = pages * resource.getpagesize() + 4_000_000
resource.setrlimit(resource.RLIMIT_AS, (most, most))
print(make(ctypes.c_double(1.0), ctypes.c_double(1.0)))
"""


def test_sets_are_not_kept_where_there_is_no_memory() -> None:
    make = native().make_set_cache
    make.restype = ctypes.c_void_p
    share = ctypes.c_double(1e-3), ctypes.c_double(1.0), ctypes.c_double(1.0), ctypes.c_int(0)
    assert make(ctypes.c_long(2**60), *share) is None
    assert make(ctypes.c_long(2**10), *share) is not None


def test_similar_sets_are_not_kept_where_there_is_no_memory() -> None:
    done = subprocess.run(
        [sys.executable, "-c", WITH_LITTLE_MEMORY], check=True, capture_output=True, text=True
    )
    assert done.stdout == "None\n"
