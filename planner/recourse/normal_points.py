"""Joint normal deviations as few points, the same on every machine."""

from functools import cache
from math import fsum, sqrt
from statistics import NormalDist

import numpy as np
from jaxtyping import Float

# Decimals kept of points and of sines: rounding removes what libraries of mathematics differ by.
_DECIMALS = 10


@cache
def _standard_points(count: int, dimensions: int) -> tuple[tuple[float, ...], ...]:
    """Returns points with mean 0, variance 1 and no correlation.

    They are an additive recurrence with the generalised golden ratio (Roberts, 2018), taken through the
    inverse normal distribution and made exact in their first two moments by Gram and Schmidt.
    """
    ratio = 2.0
    for _ in range(60):
        ratio = (1 + ratio) ** (1 / (dimensions + 1))
    normal = NormalDist()
    columns: list[list[float]] = []
    for axis in range(dimensions):
        step = ratio ** -(axis + 1)
        column = [normal.inv_cdf((0.5 + (row + 0.5) * step) % 1.0) for row in range(count)]
        mean = fsum(column) / count
        column = [value - mean for value in column]
        for other in columns:
            share = fsum(a * b for a, b in zip(column, other, strict=True)) / count
            column = [a - share * b for a, b in zip(column, other, strict=True)]
        scale = sqrt(fsum(value * value for value in column) / count)
        columns.append([value / scale for value in column])
    return tuple(tuple(round(column[row], _DECIMALS) for column in columns) for row in range(count))


def normal_points(
    mean: Float[np.ndarray, "d"], covariance: Float[np.ndarray, "d d"], count: int
) -> Float[np.ndarray, "count d"]:
    """Returns points of equal weight with exactly this mean and covariance.

    Args:
        mean: of the joint normal distribution.
        covariance: positive semidefinite.
        count: number of points; above the number of dimensions.
    """
    root = _lower_root(covariance)
    points = np.array(_standard_points(count, len(mean)))
    rows = np.array([[fsum(root[i] * point) for i in range(len(mean))] for point in points])
    return np.asarray(np.round(mean + rows, _DECIMALS))


def unit_vector(angle: Float[np.ndarray, "*n"]) -> tuple[Float[np.ndarray, "*n"], Float[np.ndarray, "*n"]]:
    """Returns cosine and sine, rounded so that every machine gives the same."""
    return np.round(np.cos(angle), 12), np.round(np.sin(angle), 12)


def _lower_root(covariance: Float[np.ndarray, "d d"]) -> Float[np.ndarray, "d d"]:
    """Returns the Cholesky factor; rows of no variance are 0."""
    size = len(covariance)
    root = np.zeros((size, size))
    for i in range(size):
        for j in range(i + 1):
            rest = float(covariance[i, j]) - fsum(root[i, k] * root[j, k] for k in range(j))
            if i == j:
                root[i, i] = sqrt(max(rest, 0.0))
            elif root[j, j] > 0:
                root[i, j] = rest / root[j, j]
    return root
