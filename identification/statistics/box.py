"""Box of bounds of one primitive: centre and half widths."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """Closed box of values within `size` of `centre`.

    Attributes:
        centre: centre of each scalar.
        size: half widths.
        support: number of values fitted to the samples, on which the coverage depends.
    """

    centre: Float[np.ndarray, "scalars"]
    size: Float[np.ndarray, "scalars"]
    support: int

    def contains(
        self, low: Float[np.ndarray, "n scalars"], high: Float[np.ndarray, "n scalars"]
    ) -> np.ndarray:
        """Returns True for each sample that lies entirely inside."""
        inside = (np.abs(low - self.centre) <= self.size) & (np.abs(high - self.centre) <= self.size)
        return np.asarray(inside.all(axis=1))


def box_around(
    centre: Float[np.ndarray, "scalars"],
    low: Float[np.ndarray, "n scalars"],
    high: Float[np.ndarray, "n scalars"],
) -> Box:
    """Returns the smallest box around a centre fixed before the samples.

    Args:
        centre: centre of the box.
        low: lowest value of each sample and scalar; at least one sample.
        high: highest value of each sample and scalar.
    """
    return Box(centre, _half_widths(centre, low, high), len(centre))


def smallest_box(low: Float[np.ndarray, "n scalars"], high: Float[np.ndarray, "n scalars"]) -> Box:
    """Returns the smallest box of the samples.

    Both sides of every scalar are fitted, so its coverage is lower than about a fixed centre.

    Args:
        low: lowest value of each sample and scalar; at least one sample.
        high: highest value of each sample and scalar.
    """
    centre = (low.min(axis=0) + high.max(axis=0)) / 2
    return Box(centre, _half_widths(centre, low, high), 2 * len(centre))


def _half_widths(
    centre: Float[np.ndarray, "scalars"],
    low: Float[np.ndarray, "n scalars"],
    high: Float[np.ndarray, "n scalars"],
) -> Float[np.ndarray, "scalars"]:
    return np.asarray(np.maximum(np.abs(low - centre), np.abs(high - centre)).max(axis=0))
