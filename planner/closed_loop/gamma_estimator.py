"""Online estimate of gamma: the level with the least prediction error."""

from collections import deque
from collections.abc import Sequence

from flight.automaton.library import Library
from flight.se2 import SE2

from .remaining_plan import PlanStep

MEMORY = 0.8
"""Weight of the past after each further primitive; chosen."""

REMEMBERED = 40
"""Primitives kept to score new levels; older ones weigh less than a thousandth."""


class GammaEstimator:
    """Scores every level by its error in predicting the ends of primitives.

    The worst-case plan's time holds if the level is known. In flight it is estimated: each primitive ends
    near the end predicted at one of the levels. A level's error is the shift of the goal in metres.

    Args:
        library: the primitives.
        goal: north and east in metres.
    """

    def __init__(self, library: Library, goal: tuple[float, float]) -> None:
        self._library, self._goal = library, goal
        self._seen: deque[tuple[PlanStep, SE2, SE2]] = deque(maxlen=REMEMBERED)
        self._scores: dict[float, float] = {}

    def update(self, step: PlanStep, begin: SE2, end: SE2) -> None:
        """Updates the scores with one primitive and its estimated poses."""
        self._seen.append((step, begin, end))
        for level, score in self._scores.items():
            self._scores[level] = self._after(score, level, step, begin, end)

    def estimate(self, levels: Sequence[float], *, otherwise: float) -> float:
        """Returns the best-scoring level, or the default before any flight."""
        for level in levels:
            if level not in self._scores:
                score = 0.0
                for step, begin, end in self._seen:
                    score = self._after(score, level, step, begin, end)
                self._scores[level] = score
        return min(levels, key=self._scores.__getitem__) if self._seen and levels else otherwise

    def _after(self, score: float, level: float, step: PlanStep, begin: SE2, end: SE2) -> float:
        predicted = step.exit(begin, self._library, level)
        miss = _seen_from(predicted, self._goal).distance_to(_place(_seen_from(end, self._goal)))
        return MEMORY * score + miss**2


def _seen_from(pose: SE2, place: tuple[float, float]) -> SE2:
    return pose.inverse() @ SE2(*place, 0.0)


def _place(pose: SE2) -> tuple[float, float]:
    return pose.x, pose.y
