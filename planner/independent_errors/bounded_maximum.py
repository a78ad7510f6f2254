"""Bounded maximum over a box of errors: best found and upper bound."""

from dataclasses import dataclass
from math import inf
from typing import Self

import numpy as np
from jaxtyping import Float

from planner.walks.boxes import Boxes

ROUNDING = 1e-9
"""Metres and seconds that every bound is widened by."""

GAP = 0.01
"""Share of the bound within which what was found is close enough."""


@dataclass(frozen=True, slots=True)
class BoundedMaximum:
    """Maximum over a box of errors: best found and upper bound.

    Attributes:
        found: the worst that was found, seconds or metres.
        errors: the error variables there, each between -1 and 1.
        bound: upper bound over all errors of the box; infinite if none was proved.
        boxes: number of boxes evaluated.
    """

    found: float
    errors: tuple[float, ...]
    bound: float
    boxes: int


@dataclass(frozen=True, eq=False)
class BoundedBoxes(Boxes):
    """Boxes of error variables.

    Attributes:
        bound: upper bounds over all errors of each, seconds or metres; infinite if unknown.
    """

    bound: Float[np.ndarray, "n"]

    @classmethod
    def whole(cls, variables: int) -> Self:
        """Returns the single box of all errors."""
        return cls(-np.ones((1, variables)), np.ones((1, variables)), np.array([inf]))
