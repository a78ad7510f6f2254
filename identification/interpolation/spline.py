"""Smoothing spline over scattered points with closed-form leave-one-out errors.

A radial spline with kernel -r and a linear trend; scipy's `RBFInterpolator` with `kernel="linear", degree=1`
gives the same values. Leave-one-out errors need no further spline: they solve a small system with the
inverse's rows and columns of the points left out and their coefficients on the right-hand side (for one point
Rippa, Adv. Comput. Math. 11, 1999; for several it follows in the same way from a partitioned inverse).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Float

# Candidate smoothings, in units of scaled distances.
SMOOTHINGS = (0.0, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)


@dataclass(frozen=True, slots=True, eq=False)
class Spline:
    """A fitted smoothing spline.

    Attributes:
        points: points of known values, in scaled coordinates.
        coefficients: coefficients of the kernel at every point, then of the linear trend.
        left_out: leave-one-out errors: value minus prediction at each point, with its group left out.
        smoothing: the smoothing chosen.
    """

    points: Float[np.ndarray, "n d"]
    coefficients: Float[np.ndarray, "n_and_d_and_1"]
    left_out: Float[np.ndarray, "n"]
    smoothing: float

    @classmethod
    def fit(
        cls,
        points: Float[np.ndarray, "n d"],
        values: Float[np.ndarray, "n"],
        *,
        groups: Sequence[Sequence[int]] | None = None,
    ) -> Self:
        """Fits the spline with the smoothing of least leave-one-out error.

        Args:
            points: points of known values, in scaled coordinates.
            values: values at the points.
            groups: for each point the rows left out together with it, its own included; its own alone where
                None.

        Raises:
            ValueError: too few points for a linear trend with a point left out, or the points, all or without
                a group, lie in a plane.
        """
        count, dimensions = points.shape
        if count < dimensions + 3:
            raise ValueError(f"expected at least {dimensions + 3} points, got {count}")
        for rows in groups or ():
            _check_not_planar(np.delete(points, list(rows), axis=0))
        best: Self | None = None
        for smoothing in SMOOTHINGS:
            inverse = np.linalg.inv(_system(points, smoothing))
            coefficients = inverse[:, :count] @ values
            left_out = _leave_one_out_errors(inverse[:count, :count], coefficients[:count], groups)
            if best is None or (left_out**2).sum() < (best.left_out**2).sum():
                best = cls(points, coefficients, left_out, smoothing)
        assert best is not None
        return best

    def at(self, points: Float[np.ndarray, "m d"]) -> Float[np.ndarray, "m"]:
        """Returns the interpolated values at points in scaled coordinates."""
        kernel = -np.linalg.norm(points[:, None, :] - self.points, axis=2)
        rows = np.hstack([kernel, np.ones((len(points), 1)), points])
        values: Float[np.ndarray, "m"] = rows @ self.coefficients
        return values


def _leave_one_out_errors(
    inverse: Float[np.ndarray, "n n"],
    coefficients: Float[np.ndarray, "n"],
    groups: Sequence[Sequence[int]] | None,
) -> Float[np.ndarray, "n"]:
    if groups is None:
        alone: Float[np.ndarray, "n"] = coefficients / np.diag(inverse)
        return alone
    errors = [
        np.linalg.solve(inverse[np.ix_(rows, rows)], coefficients[rows])[rows.index(place)]
        for place, rows in enumerate(map(list, groups))
    ]
    return np.array(errors)


def _system(points: Float[np.ndarray, "n d"], smoothing: float) -> Float[np.ndarray, "m m"]:
    count = len(points)
    kernel = -np.linalg.norm(points[:, None, :] - points, axis=2) + smoothing * np.eye(count)
    _check_not_planar(points)
    trend = np.hstack([np.ones((count, 1)), points])
    corner = np.zeros((trend.shape[1], trend.shape[1]))
    system: Float[np.ndarray, "m m"] = np.block([[kernel, trend], [trend.T, corner]])
    return system


def _check_not_planar(points: Float[np.ndarray, "n d"]) -> None:
    trend = np.hstack([np.ones((len(points), 1)), points])
    if np.linalg.matrix_rank(trend) < trend.shape[1]:
        raise ValueError("expected points that span all their coordinates, got points in a plane")
