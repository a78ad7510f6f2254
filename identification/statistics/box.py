"""A box that holds what many flights showed of one primitive: a centre and half widths, scalar by scalar."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """The values within `size` of `centre`, closed.

    Attributes:
        centre: a number for each scalar.
        size: half widths.
        support: numbers that were fitted to the samples; what the coverage depends on.
    """

    centre: Float[np.ndarray, "scalars"]
    size: Float[np.ndarray, "scalars"]
    support: int

    def contains(
        self, low: Float[np.ndarray, "n scalars"], high: Float[np.ndarray, "n scalars"]
    ) -> np.ndarray:
        """Returns for each sample whether the box holds it from its lowest to its highest value."""
        inside = (np.abs(low - self.centre) <= self.size) & (np.abs(high - self.centre) <= self.size)
        return np.asarray(inside.all(axis=1))


def box_around(
    centre: Float[np.ndarray, "scalars"],
    low: Float[np.ndarray, "n scalars"],
    high: Float[np.ndarray, "n scalars"],
) -> Box:
    """Returns the smallest box about a centre that was fixed before the samples were seen.

    Args:
        centre: of the box.
        low: lowest value of each sample and scalar; at least one sample.
        high: highest value.
    """
    return Box(centre, _half_widths(centre, low, high), len(centre))


def smallest_box(low: Float[np.ndarray, "n scalars"], high: Float[np.ndarray, "n scalars"]) -> Box:
    """Returns the smallest box of all: both sides of every scalar are fitted, so the claim is weaker.

    Args:
        low: lowest value of each sample and scalar; at least one sample.
        high: highest value.
    """
    centre = (low.min(axis=0) + high.max(axis=0)) / 2
    return Box(centre, _half_widths(centre, low, high), 2 * len(centre))


def _half_widths(
    centre: Float[np.ndarray, "scalars"],
    low: Float[np.ndarray, "n scalars"],
    high: Float[np.ndarray, "n scalars"],
) -> Float[np.ndarray, "scalars"]:
    return np.asarray(np.maximum(np.abs(low - centre), np.abs(high - centre)).max(axis=0))
