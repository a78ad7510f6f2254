"""Which uncertainty level the vehicle has shown: one model for each level, and the best of them."""

from collections.abc import Sequence

from flight.library import Library
from flight.se2 import SE2

from .remainder import Step

MEMORY = 0.8
"""How much of what was seen still counts after another primitive; chosen."""


class Levels:
    """Scores every level by how well it foretold where primitives end.

    The worst case promises a time to whoever learns the level before flying. In flight it shows itself: each
    primitive ends where it would at one of the levels, or nearest to that. What counts is by how many metres
    a level misplaces the goal.

    Args:
        library: the primitives.
        levels: those that a policy plans for.
        goal: north and east in metres.
    """

    def __init__(self, library: Library, levels: Sequence[float], goal: tuple[float, float]) -> None:
        self._library, self._goal = library, goal
        self._scores = dict.fromkeys(levels, 0.0)
        self._seen = False

    def see(self, step: Step, begin: SE2, end: SE2) -> None:
        """Takes a primitive that was flown, from where and to where as far as the vehicle believes."""
        for level, score in self._scores.items():
            foretold = step.exit(begin, self._library, level)
            miss = _seen_from(foretold, self._goal).distance_to(_place(_seen_from(end, self._goal)))
            self._scores[level] = MEMORY * score + miss**2
        self._seen = True

    def shown(self, *, otherwise: float) -> float:
        """Returns the level that foretold best; another one where nothing was flown yet."""
        return min(self._scores, key=self._scores.__getitem__) if self._seen and self._scores else otherwise


def _seen_from(pose: SE2, place: tuple[float, float]) -> SE2:
    return pose.inverse() @ SE2(*place, 0.0)


def _place(pose: SE2) -> tuple[float, float]:
    return pose.x, pose.y
