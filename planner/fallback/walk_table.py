"""All walks of one length from one trim, at every uncertainty level."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from flight.automaton.library import Library
from planner.walks.kinematics import WalkMotion, walk_motion
from planner.walks.walk import Walk, walks

from .batch import Batch


@dataclass(frozen=True, slots=True, eq=False)
class WalkTable:
    """Walks with their numbers: row = walk x levels + level.

    Attributes:
        walks: trim ids.
        gammas: uncertainty levels.
        motions: the numbers of each row.
        batch: the same as arrays.
    """

    walks: tuple[Walk, ...]
    gammas: tuple[float, ...]
    motions: tuple[WalkMotion, ...]
    batch: Batch

    def take(self, kept: Bool[np.ndarray, "walks"]) -> "WalkTable":
        """Returns the walks that are marked."""
        if kept.all():
            return self
        rows = np.flatnonzero(np.repeat(kept, len(self.gammas)))
        return WalkTable(
            tuple(self.walks[place] for place in np.flatnonzero(kept)),
            self.gammas,
            tuple(self.motions[row] for row in rows),
            self.batch.take(rows),
        )

    def worst(self, by_row: Float[np.ndarray, "rows"]) -> Float[np.ndarray, "walks"]:
        """Returns the largest value of each walk over its levels."""
        largest: Float[np.ndarray, "walks"] = by_row.reshape(-1, len(self.gammas)).max(axis=1)
        return largest


def tabulate(
    library: Library, gammas: tuple[float, ...], start_trim: int, max_trims: int, goal_trim: int | None
) -> tuple[WalkTable, ...]:
    """Returns the walks from a trim with their numbers at every level, a table for each length.

    Raises:
        UnknownTrimError: the library has no such start or goal trim.
    """
    by_length: dict[int, list[Walk]] = {}
    for walk in walks(library, start_trim, max_trims=max_trims, goal_trim=goal_trim):
        by_length.setdefault(len(walk), []).append(walk)
    tables = []
    for group in by_length.values():
        motions = tuple(walk_motion(library, walk, gamma) for walk in group for gamma in gammas)
        tables.append(WalkTable(tuple(group), gammas, motions, Batch.of(motions)))
    return tuple(tables)
