"""Problem and table as the arrays that the C code reads."""

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from .problem import ShortestPathProblem

# Seconds that an action of no duration counts for in the bounds.
_SHORTEST = 1e-3


class CCostTable(ctypes.Structure):
    """`Table` of recourse.h."""

    _fields_ = (
        ("value", ctypes.c_void_p),
        ("ends", ctypes.c_void_p),
        *((name, ctypes.c_double) for name in ("step", "tolerance", "best_speed")),
        *((name, ctypes.c_int) for name in ("half", "levels", "outer")),
    )


_ARRAYS = (
    *("first", "to", "outcome", "points", "path", "coarsest", "mean", "circle"),
    *("duration", "displacement", "position"),
)


class CActions(ctypes.Structure):
    """`Actions` of recourse.h."""

    _fields_ = tuple((name, ctypes.c_void_p) for name in _ARRAYS)


@dataclass(frozen=True, slots=True, eq=False)
class Structures:
    """C structures with the arrays that they point to."""

    table: CCostTable
    actions: CActions
    arrays: tuple[np.ndarray, ...]


def structures(
    problem: ShortestPathProblem, values: Float[np.ndarray, "trims levels side side"]
) -> Structures:
    """Returns a problem and its values, not copied, as C reads them."""
    actions, grid = problem.actions, problem.grid
    points = np.array([one.path.shape[1] if one.arrives else 0 for one in actions], dtype=np.intc)
    ends = np.array(problem.ends, dtype=np.uint8)
    arrays = (
        problem.first,
        np.array([one.to for one in actions], dtype=np.intc),
        _starts([len(one.duration) for one in actions]),
        points,
        _starts([one.path.shape[0] * one.path.shape[1] for one in actions]),
        np.array([one.coarsest for one in actions], dtype=np.intc),
        np.array([max(one.mean, _SHORTEST) for one in actions]),
        np.array([_circle(one.path) for one in actions]),
        np.concatenate([one.duration for one in actions]),
        np.ascontiguousarray(np.concatenate([one.displacement for one in actions])),
        np.ascontiguousarray(np.concatenate([one.path.reshape(-1, 2) for one in actions])),
    )
    table = CCostTable(
        values.ctypes.data,
        ends.ctypes.data,
        grid.step,
        problem.tolerance,
        problem.best_speed,
        grid.half,
        grid.levels,
        grid.outer,
    )
    pointers: list[Any] = [array.ctypes.data for array in arrays]
    return Structures(table, CActions(*pointers), (*arrays, ends, values))


def _starts(counts: list[int]) -> np.ndarray:
    return np.concatenate([[0], np.cumsum(counts)]).astype(np.intc)


def _circle(path: Float[np.ndarray, "n points 2"]) -> tuple[float, float, float]:
    """Returns a circle around all points, a little wider than need be."""
    points = path.reshape(-1, 2)
    middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    radius = float(np.sqrt(((points - middle) ** 2).sum(axis=1).max()))
    return float(middle[0]), float(middle[1]), radius * (1 + 1e-9) + 1e-9
