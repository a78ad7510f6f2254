"""Linear inequalities over boxes: interval contraction and dual bounds."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

ROUNDS = 3
"""Number of rounds in which the inequalities cut a box, each on the rest of the one before."""


@dataclass(frozen=True, slots=True, eq=False)
class LinearInequalities:
    """Linear inequalities slope . d <= room over offsets from the middle."""

    slope: Float[np.ndarray, "n count trims"]
    room: Float[np.ndarray, "n count"]


def least_values(
    slope: Float[np.ndarray, "n count trims"],
    below: Float[np.ndarray, "n trims"],
    above: Float[np.ndarray, "n trims"],
) -> Float[np.ndarray, "n count"]:
    """Returns the minimum of each slope . d over a box."""
    value: Float[np.ndarray, "n count"] = (
        np.maximum(slope, 0) @ below[:, :, None] + np.minimum(slope, 0) @ above[:, :, None]
    )[:, :, 0]
    return value


def least_sum(
    given: LinearInequalities, below: Float[np.ndarray, "n trims"], above: Float[np.ndarray, "n trims"]
) -> Float[np.ndarray, "n"]:
    """Returns a dual lower bound of the sum of offsets."""
    total = below.sum(axis=1)
    for place in range(below.shape[1]):
        falling = given.slope[:, :, place]
        with np.errstate(divide="ignore", invalid="ignore"):
            price = np.where(falling < 0, -1 / falling, 0.0)
            price = np.where(np.isfinite(price), price, 0.0)
        value = least_values(1 + price[:, :, None] * given.slope, below, above) - price * given.room
        total = np.maximum(total, value.max(axis=1))
    return np.asarray(total)


def tighten_offsets(
    given: LinearInequalities, width: Float[np.ndarray, "n trims"]
) -> tuple[Float[np.ndarray, "n trims"], Float[np.ndarray, "n trims"], Bool[np.ndarray, "n"]]:
    """Returns the tightened offset bounds, and where any offsets remain."""
    below, above, open_ = -width, width, np.ones(len(width), dtype=bool)
    rising, falling = given.slope > 0, given.slope < 0
    for _ in range(ROUNDS):
        slack = given.room - least_values(given.slope, below, above)
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = slack[:, :, None] / given.slope
        most = np.where(rising, below[:, None, :] + reach, np.inf).min(axis=1)
        fewest = np.where(falling, above[:, None, :] + reach, -np.inf).max(axis=1)
        open_ &= (slack >= 0).all(axis=1)
        below, above = np.maximum(below, fewest), np.minimum(above, most)
        open_ &= (below <= above).all(axis=1)
        above = np.maximum(above, below)
    return below, above, open_
