"""Coasting times that answer errors in proportion, so that a whole box of errors ends inside the tolerance.

One time may hold the end's distance from the goal, or two may hold the end; times that would become negative
are raised. Whatever is left must lie inside the tolerance by the enclosure: nothing is believed.
"""

from collections.abc import Iterator
from itertools import combinations

import numpy as np
from jaxtyping import Float

from .answer import Times
from .corners import furthest_corner
from .error_box import Enclosure, ErrorPath, enclose

MARGIN = 1e-9
"""Metres kept clear, for rounding."""

PARALLEL = 1e-3
"""Share of their product above which two velocities can hold an end."""

HELD = 1e-6
"""Seconds above which a coasting time counts as not zero."""


class ErrorCell:
    """A box of errors of a walk.

    Args:
        path: the walk.
        goal: north + i east in metres, seen from the start.
        tolerance: metres around it.
        errors: middle of the box.
        width: its half widths.
    """

    def __init__(
        self,
        path: ErrorPath,
        goal: complex,
        tolerance: float,
        errors: Float[np.ndarray, "variables"],
        width: Float[np.ndarray, "variables"],
    ) -> None:
        self._path, self._goal, self._tolerance = path, goal, tolerance
        self._errors, self._width = errors, width

    def served(self, times: Times) -> tuple[float, float]:
        """Returns seconds that suffice whatever the errors, and metres that the best answer lacks.

        The seconds are infinite where no answer is proved to stay within the tolerance.

        Args:
            times: coasting times that serve the middle of the box.
        """
        base = np.array(times)
        tried = [self._tried(base, answer) for answer in self._answers(base)]
        lacking = min(over for _, over in tried)
        return min((seconds for seconds, over in tried if over <= 0), default=np.inf), max(lacking, MARGIN)

    def stray(self, times: Times) -> Enclosure:
        """Returns where these coasting times lead without an answer."""
        base = np.array(times)
        return self._hull(base, np.zeros((len(base), len(self._width))))

    def _hull(
        self, base: Float[np.ndarray, "trims"], answer: Float[np.ndarray, "trims variables"]
    ) -> Enclosure:
        return enclose(self._path, self._errors[None], self._width[None], base[None], answer[None])

    def _tried(
        self, times: Float[np.ndarray, "trims"], answer: Float[np.ndarray, "trims variables"]
    ) -> tuple[float, float]:
        """Returns seconds that suffice with an answer, and by how many metres its end may lie outside."""
        base = np.maximum(times, np.abs(answer) @ self._width)
        hull = self._hull(base, answer)
        _, reach = furthest_corner(hull.middle - self._goal, hull.slope * self._width)
        fixed = self._path.fixed[0] + float(self._errors @ self._path.fixed[1])
        slower = float(np.abs(answer.sum(axis=0) + self._path.fixed[1]) @ self._width)
        over = float(reach[0] + hull.radius[0]) + MARGIN - self._tolerance
        return fixed + float(base.sum()) + slower, over

    def _answers(self, base: Float[np.ndarray, "trims"]) -> Iterator[Float[np.ndarray, "trims variables"]]:
        """Returns how coasting times may answer: not at all, one that is held, or any two."""
        still = np.zeros((len(base), len(self._width)))
        hull = self._hull(base, still)
        yield still
        off = hull.middle[0] - self._goal
        outward = off / abs(off) if abs(off) > 0 else 1.0
        for place in np.flatnonzero(base > HELD).tolist():
            along = (np.conj(outward) * hull.along[0, place]).real
            if abs(along) > PARALLEL * abs(hull.along[0, place]):
                answer = still.copy()
                answer[place] = -(np.conj(outward) * hull.slope[0]).real / along
                yield answer
        for pair in combinations(range(len(base)), 2):
            one, two = hull.along[0, list(pair)]
            if abs((np.conj(one) * two).imag) > PARALLEL * abs(one) * abs(two):
                columns = np.array([[one.real, two.real], [one.imag, two.imag]])
                answer = still.copy()
                answer[list(pair)] = -np.linalg.solve(columns, [hull.slope[0].real, hull.slope[0].imag])
                yield answer
