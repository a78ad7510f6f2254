"""Tests of active sets that walks share: equal ones are one, others are not."""

import ctypes
from dataclasses import replace

import pytest

from tests.planner.kernel.native import native, problem_of
from tests.planner.kernel.walk_problem import WalkProblem

pytestmark = pytest.mark.kernel

WALK = WalkProblem((1 + 0.5j, 2 - 1j, 1.5 + 0j), (0.3, 0.0, -0.2), (3 + 1j, 2 - 4j), goal=9.0, heading=1.0)

FIRST_AND_LAST = 0b101


def entry(cache: ctypes.c_void_p, walk: WalkProblem, mask: int) -> int | None:
    """Returns the address of a walk's active set."""
    problem, walk_hash = problem_of(walk), ctypes.create_string_buffer(1024)
    native().hash_walk(walk_hash, ctypes.byref(problem), cache)
    found = native().cached_set
    found.restype = ctypes.c_void_p
    address: int | None = found(cache, walk_hash, ctypes.c_uint(mask))
    return address


def cache_of(capacity: int) -> ctypes.c_void_p:
    make = native().make_set_cache
    make.restype = ctypes.c_void_p
    step, one = ctypes.c_double(1e-6), ctypes.c_double(1.0)
    return ctypes.c_void_p(make(ctypes.c_long(capacity), step, one, one, ctypes.c_int(0)))


@pytest.mark.parametrize(
    "other",
    [
        replace(WALK, velocities=(1.001 + 0.5j, 2 - 1j, 1.5 + 0j)),
        replace(WALK, velocities=(1 + 0.501j, 2 - 1j, 1.5 + 0j)),
        replace(WALK, velocities=(1 + 0.5j, 2 - 1j, 1.501 + 0j)),
        replace(WALK, rates=(0.3000001, 0.0, -0.2)),
        replace(WALK, rates=(0.3, 0.0, 0.2)),
        replace(WALK, displacements=(3 + 1j, 2.001 - 4j)),
        replace(WALK, displacements=(3 + 1j, 2 - 4.001j)),
        replace(WALK, heading=1.001),
    ],
)
def test_sets_with_other_coefficients_are_others(other: WalkProblem) -> None:
    cache = cache_of(64)
    known = entry(cache, WALK, FIRST_AND_LAST)
    assert known is not None
    assert entry(cache, other, FIRST_AND_LAST) != known
    assert entry(cache, WALK, FIRST_AND_LAST) == known


def test_a_set_is_one_whatever_the_other_coasts_are() -> None:
    """The coast between, and where its maneuvers join, makes no difference."""
    cache = cache_of(64)
    between = replace(
        WALK, velocities=(1 + 0.5j, 7 + 3j, 1.5 + 0j), rates=(0.3, 0.9, -0.2), displacements=(1 + 1j, 4 - 4j)
    )
    known = entry(cache, WALK, FIRST_AND_LAST)
    assert entry(cache, between, FIRST_AND_LAST) == known
    assert entry(cache, replace(WALK, velocities=(1 + 1e-8, 0, 0)), 0b1) != known
    assert len({entry(cache, WALK, mask) for mask in range(1, 8)}) == 7


def test_a_table_that_is_half_full_keeps_what_it_has() -> None:
    cache = cache_of(8)
    walks = [replace(WALK, heading=0.1 * number) for number in range(8)]
    found = [entry(cache, walk, 0b1) for walk in walks]
    assert found[0] is not None
    assert found[-1] is None
    assert [entry(cache, walk, 0b1) for walk in walks[:4]] == found[:4]
