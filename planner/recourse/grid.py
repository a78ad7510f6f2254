"""Nested square grids of goal positions as seen from the vehicle."""

from dataclasses import dataclass
from math import ceil

import numpy as np
from jaxtyping import Float

STEPS_IN_TOLERANCE = 4
"""Nodes within the tolerance's radius, at least; its edge then lies half a step beyond a node."""

LARGEST_STEP = 0.35
"""Metres between the finest nodes, at most."""

MARGIN = 5.0
"""Metres beyond the longest displacement that the finest grid covers."""

REACH = 100.0
"""Metres that the grids cover, at least; beyond stands the asymptote."""


@dataclass(frozen=True, slots=True)
class NestedGrid:
    """Square grids around the vehicle, each twice as wide and coarse as the one inside.

    The nodes of a coarser grid that the one inside covers are not used. Forward is the first axis, to the
    right the second.

    Attributes:
        step: metres between the finest nodes.
        half: steps from the middle to the edge of every grid; even.
        levels: number of grids.
    """

    step: float
    half: int
    levels: int

    @classmethod
    def around(cls, tolerance: float, *, longest: float, reach: float = REACH, refinement: int = 1) -> "NestedGrid":
        """Returns the grids for a tolerance.

        Args:
            tolerance: radius around the goal in metres.
            longest: displacement of the longest primitive in metres.
            reach: metres that the grids cover.
            refinement: the finest step is that many times smaller, for studies of its error.
        """
        steps = max(STEPS_IN_TOLERANCE, ceil(tolerance / LARGEST_STEP - 0.5))
        step = tolerance / (refinement * (2 * steps + 1) // 2 + 0.5)
        near = max(longest + MARGIN, tolerance + 4 * step)
        half = 2 * ceil(near / (2 * step))
        levels = 1
        while half * step * 2 ** (levels - 1) < reach:
            levels += 1
        return cls(step, half, levels)

    @property
    def side(self) -> int:
        """Nodes along one side of a grid."""
        return 2 * self.half + 1

    @property
    def edge(self) -> float:
        """Metres from the vehicle to the edge of the widest grid."""
        return self.half * self.step * 2.0 ** (self.levels - 1)

    def positions(self, level: int) -> tuple[Float[np.ndarray, "side side"], Float[np.ndarray, "side side"]]:
        """Returns forward and side of the nodes of one grid."""
        axis = (np.arange(self.side) - self.half) * (self.step * 2.0**level)
        forward, side = np.meshgrid(axis, axis, indexing="ij")
        return forward, side

    def used(self, level: int) -> np.ndarray:
        """Returns which nodes of one grid the one inside does not cover."""
        inner = self.half // 2 if level else 0
        axis = np.abs(np.arange(self.side) - self.half) < inner
        return np.asarray(~(axis[:, None] & axis[None, :]))
