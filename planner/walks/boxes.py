"""Boxes of coasting times or of errors for branch and bound."""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Self, TypeVar

import numpy as np
from jaxtyping import Bool, Float, Int


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes, one a row, with optional per-box data in subclasses.

    Attributes:
        low: smallest values in each.
        high: largest values.
    """

    low: Float[np.ndarray, "n places"]
    high: Float[np.ndarray, "n places"]

    def __len__(self) -> int:
        return len(self.low)

    @cached_property
    def middle(self) -> Float[np.ndarray, "n places"]:
        """Values in the middle of each."""
        middle: Float[np.ndarray, "n places"] = 0.5 * (self.low + self.high)
        return middle

    @cached_property
    def width(self) -> Float[np.ndarray, "n places"]:
        """Half widths of each."""
        width: Float[np.ndarray, "n places"] = 0.5 * (self.high - self.low)
        return width

    def take(self, which: Bool[np.ndarray, "n"] | Int[np.ndarray, "taken"]) -> Self:
        """Returns some of them."""
        return type(self)(**{one.name: getattr(self, one.name)[which] for one in fields(self)})

    def halves(self, place: Int[np.ndarray, "n"]) -> Self:
        """Returns both halves of each box, cut at the given places."""
        at = np.arange(len(self)), place
        below, above = self.high.copy(), self.low.copy()
        below[at] = above[at] = self.middle[at]
        return joined(replace(self, high=below), replace(self, low=above))


Some = TypeVar("Some", bound=Boxes)


def joined(*parts: Some) -> Some:
    """Returns the concatenation of several sets of boxes."""
    every: dict[str, Any] = {
        one.name: np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(parts[0])
    }
    return type(parts[0])(**every)
