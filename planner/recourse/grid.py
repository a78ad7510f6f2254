"""Nested square grids of goal positions as seen from the vehicle."""

from dataclasses import dataclass
from math import ceil

import numpy as np
from jaxtyping import Bool, Float

STEPS_IN_TOLERANCE = 4.5
"""Steps in the tolerance's radius, at least.

The jump of the cost at the edge then lies half a step beyond a node, and interpolation spreads it evenly to
both sides. So it does on the next grid, as three of these steps are one of that, and on the one after it.
"""

RATIO = 3
"""Steps of one grid that are one of the next."""

LARGEST_STEP = 0.35
"""Metres between the finest nodes, at most."""

MARGIN = 5.0
"""Metres beyond the longest displacement that the finest grid covers."""

REACH = 100.0
"""Metres that the grids cover, at least; beyond stands the asymptote."""


@dataclass(frozen=True, slots=True)
class NestedGrid:
    """Square grids around the vehicle, each three times wider and coarser.

    The nodes of a coarser grid that the one inside covers are not used. Forward is the first axis, to the
    right the second.

    Attributes:
        step: metres between the finest nodes.
        half: steps from the middle to the edge of every grid; a multiple of the ratio.
        levels: number of grids.
        outer: steps from the middle to the edge of what is used of the last one.
    """

    step: float
    half: int
    levels: int
    outer: int

    @classmethod
    def around(
        cls, tolerance: float, *, longest: float, reach: float = REACH, refined: bool = False
    ) -> "NestedGrid":
        """Returns the grids for a tolerance.

        Args:
            tolerance: radius around the goal in metres.
            longest: displacement of the longest primitive in metres.
            reach: metres that the grids cover.
            refined: whether the finest step is a third of the usual one, for studies of its error.
        """
        steps = STEPS_IN_TOLERANCE + RATIO * max(
            0, ceil((tolerance / LARGEST_STEP - STEPS_IN_TOLERANCE) / RATIO)
        )
        step = tolerance / (steps * RATIO if refined else steps)
        half = RATIO * ceil(max(longest + MARGIN, tolerance + 2 * step) / (RATIO * step))
        levels = 1
        while half * step * RATIO ** (levels - 1) < reach:
            levels += 1
        return cls(step, half, levels, min(half, ceil(reach / (step * RATIO ** (levels - 1)))))

    @property
    def side(self) -> int:
        """Nodes along one side of a grid."""
        return 2 * self.half + 1

    def positions(self, level: int) -> tuple[Float[np.ndarray, "side side"], Float[np.ndarray, "side side"]]:
        """Returns forward and side of the nodes of one grid."""
        axis = (np.arange(self.side) - self.half) * (self.step * RATIO**level)
        forward, side = np.meshgrid(axis, axis, indexing="ij")
        return forward, side

    def used(self, level: int) -> Bool[np.ndarray, "side side"]:
        """Returns which nodes of one grid are computed."""
        axis = np.abs(np.arange(self.side) - self.half)
        steps = np.maximum(axis[:, None], axis[None, :])
        inner = self.half // RATIO if level else 0
        outer = self.outer if level == self.levels - 1 else self.half
        return np.asarray((steps >= inner) & (steps <= outer))
