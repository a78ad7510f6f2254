"""The kernel's units for one walk, private functions callable."""

import ctypes
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from planner.kernel.build import FLAGS, HEADERS, SOURCES
from planner.kernel.tables import CTable
from runtime.compiler import shared_library

from .walk_problem import WalkProblem

MOST = 12

# Nothing is static: what is private to a unit can be called; inline functions are then defined in every unit.
PRIVATE_TOO = ("-Dstatic=", "-fgnu89-inline", "-Wl,-z,muldefs")

COUNTED = ("-finstrument-functions",)
COUNTER = Path(__file__).parent / "calls.c"


class Complex(ctypes.Structure):
    """`double complex`, also where it is returned."""

    _fields_ = (("real", ctypes.c_double), ("imag", ctypes.c_double))

    @classmethod
    def of(cls, value: complex) -> "Complex":
        """Returns a number for the kernel."""
        return cls(value.real, value.imag)

    @property
    def value(self) -> complex:
        """Returns it for Python."""
        return complex(self.real, self.imag)


class Problem(ctypes.Structure):
    """`Problem` of kernel.h; keeps alive what it points to."""

    _fields_ = (
        ("trims", ctypes.c_int),
        *(
            (name, ctypes.c_void_p)
            for name in ("rate", "W", "C", "D", "bearing_D", "bearing_W", "size_D", "speed")
        ),
        ("fixed", ctypes.c_double),
        ("goal", Complex),
        ("tolerance", ctypes.c_double),
        ("slack", ctypes.c_double),
        ("wants_heading", ctypes.c_int),
        ("heading", ctypes.c_double),
        ("heading_tolerance", ctypes.c_double),
        ("heading_slack", ctypes.c_double),
        ("best", ctypes.c_double),
        ("multiplier", Complex),
        ("straight", ctypes.c_double),
        ("hardly_bent", ctypes.c_double),
        ("times", ctypes.c_double * MOST),
    )


class ActiveSet(ctypes.Structure):
    """`ActiveSet` of coasting.h."""

    _fields_ = (
        ("count", ctypes.c_int),
        ("place", ctypes.c_int * (MOST + 1)),
        ("turns", ctypes.c_int),
        ("bound_heading", ctypes.c_int),
        ("target", ctypes.c_double),
        ("shared", ctypes.c_int),
        ("slowest", ctypes.c_double),
        ("slow", ctypes.c_int),
        ("blurred", ctypes.c_int),
    )


class Stretch(ctypes.Structure):
    """`Stretch` of coasting.h."""

    _fields_ = (
        ("A", Complex),
        ("w", Complex),
        *((name, ctypes.c_double) for name in ("a", "size", "speed", "limit", "above", "K", "aside", "rate")),
        ("straight", ctypes.c_int),
        ("other", ctypes.c_int),
        ("w_other", Complex),
    )


class Chain(ctypes.Structure):
    """`Chain` of coasting.h."""

    _fields_ = (
        ("problem", ctypes.POINTER(Problem)),
        ("on", ctypes.POINTER(ActiveSet)),
        ("free", ctypes.c_int),
        ("stretch", Stretch * (MOST + 2)),
        ("straights", ctypes.c_int),
        ("fixed", ctypes.c_int),
        ("fixed_place", ctypes.c_int * 2),
        ("fixed_velocity", Complex * 2),
        ("rest", Complex),
        ("last", Complex),
        ("last_rate", ctypes.c_double),
        ("most", ctypes.c_double),
    )


@cache
def native() -> Any:
    """Returns the units."""
    units = [COUNTER, *(source for source in SOURCES if source.parent.name == "coasting")]
    flags = [*(flag for flag in FLAGS if "visibility" not in flag), *PRIVATE_TOO, *COUNTED]
    found = ctypes.CDLL(str(shared_library(units, headers=HEADERS, flags=flags)))
    found.calls_of.restype = ctypes.c_long
    found.motion.restype = Complex
    for name in ("least_time", "to_cover", "lower_bound", "best_cosine", "least_turn", "along", "slope_of"):
        getattr(found, name).restype = ctypes.c_double
    return found


def calls(name: str) -> int:
    """Returns how often a function was called since calls were forgotten."""
    address = ctypes.cast(getattr(native(), name), ctypes.c_void_p)
    return int(native().calls_of(address))


def problem_of(walk: WalkProblem, *, slack: float = 1e-9) -> Problem:
    """Returns a walk as the kernel sees it."""
    table, structure = walk.table(), CTable()
    table.fill(structure)
    found = Problem(trims=len(walk.rates))
    for name in ("rate", "W", "C", "D", "bearing_D", "bearing_W", "size_D", "speed"):
        long = {
            "W": "velocity",
            "C": "centre",
            "D": "displacement",
            "bearing_D": "bearing_displacement",
            "bearing_W": "bearing_velocity",
            "size_D": "size_displacement",
        }.get(name, name)
        setattr(found, name, getattr(structure, long))
    found.goal = Complex.of(walk.goal)
    found.tolerance, found.slack = walk.tolerance, slack
    found.wants_heading = int(walk.heading is not None)
    found.heading = (walk.heading or 0.0) - sum(turned for _, turned in walk.steps)
    found.heading_tolerance, found.heading_slack = walk.heading_tolerance, 1e-9
    found.best = np.inf
    found.table = table
    return found


def active(problem: Problem, *places: int) -> ActiveSet:
    """Returns the set of the times at some places."""
    found = ActiveSet()
    native().choose(
        ctypes.byref(problem), ctypes.byref(found), ctypes.c_uint(sum(1 << place for place in places))
    )
    return found
