"""From some coasting times to locally best ones, for a whole interval of uncertainty levels.

The semi-infinite problem is solved by exchange: for finitely many levels by SLSQP, then the level that misses
most joins them, until none misses more than it may.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize, nnls

from flight.library import Library
from planner.sequences import Walk

from .fan import fan
from .task import Task
from .whole_interval import Lines, WorstMiss, worst_miss

ROUNDS = 12
"""Exchanges after which a descent is given up."""

RESOLUTION = 1e-9
"""Metres to which the largest miss is known."""

MARGIN = 1e-6
"""Metres by which a descent aims inside the tolerance: it ends somewhat outside of what it aims for."""

ACTIVE = 1e-4
"""Metres within which a miss counts as one of the largest."""

HELD = 1e-6
"""Seconds above which a coasting time counts as not zero."""


@dataclass(frozen=True, slots=True)
class Descended:
    """Locally best coasting times of a walk.

    Attributes:
        times: seconds, one for each trim.
        worst: the largest miss.
        levels: where the miss is among the largest.
        pulls: for each of these, direction and weight of its constraint in the optimality condition.
    """

    times: tuple[float, ...]
    worst: WorstMiss
    levels: tuple[float, ...]
    pulls: tuple[complex, ...]


class Descent:
    """Descends in one walk.

    Args:
        library: the primitives.
        walk: trim ids.
        task: what is asked.
    """

    def __init__(self, library: Library, walk: Walk, task: Task) -> None:
        self._library, self._walk, self._task = library, walk, task
        self._lines = Lines.of(library, walk)

    def soonest(self, start: Float[np.ndarray, "trims"], budget: float) -> Descended | None:
        """Returns the least times that stay within the tolerance at every level, or None if not found.

        Args:
            start: seconds.
            budget: seconds that the coasting times may take together.
        """
        aim = self._task.tolerance - MARGIN
        if aim <= 0:
            return None
        found = self._allowed(self._exchanged(start, budget, radius=aim))
        if found is not None:
            return found
        near = self._allowed(self._exchanged(start, budget, radius=None))
        if near is None:
            return None
        return self._allowed(self._exchanged(np.array(near.times), budget, radius=aim)) or near

    def _allowed(self, found: Descended | None) -> Descended | None:
        return None if found is None or found.worst.bound > self._task.tolerance else found

    def nearest(self, start: Float[np.ndarray, "trims"], budget: float) -> Descended | None:
        """Returns the times whose largest miss is least, or None if not found.

        Args:
            start: seconds.
            budget: seconds that the coasting times may take together.
        """
        return self._exchanged(start, budget, radius=None)

    def _exchanged(
        self, start: Float[np.ndarray, "trims"], budget: float, radius: float | None
    ) -> Descended | None:
        gamma = self._task.gamma
        gammas = [-gamma, 0.0, gamma]
        times = start
        for _ in range(ROUNDS):
            solved = self._solved(times, tuple(gammas), budget, radius)
            if solved is None:
                return None
            times, reached = solved
            worst = worst_miss(self._lines, times, self._task.goal, gamma, resolution=RESOLUTION)
            if worst.found <= reached + 0.5 * MARGIN:
                return self._described(times, worst, tuple(gammas), radius)
            if min(abs(worst.gamma - one) for one in gammas) < 1e-9:
                return None
            gammas.append(worst.gamma)
        return None

    def _solved(
        self,
        start: Float[np.ndarray, "trims"],
        gammas: tuple[float, ...],
        budget: float,
        radius: float | None,
    ) -> tuple[Float[np.ndarray, "trims"], float] | None:
        """Returns locally best times for some levels, with their largest miss; seconds in, metres out."""
        numbers = fan(self._library, (self._walk,), gammas)
        task, count, row = self._task, len(self._walk), np.zeros(1, dtype=int)

        def misses(
            times: Float[np.ndarray, "trims"],
        ) -> tuple[Float[np.ndarray, "levels"], Float[np.ndarray, "levels trims"]]:
            end, _, along = numbers.ends(row, times[None, :])
            off = end[0] - task.goal
            size = np.maximum(np.abs(off), 1e-12)
            return size, (np.conj(off / size)[:, None] * along[0]).real

        turns = self._turns(start)
        rates = numbers.rate[0]
        fixed = task.heading_off(numbers.turned[0], turns)
        matrix = np.vstack([-np.ones(count), *([-rates, rates] if task.wants_heading else [])])
        room = np.concatenate(
            [
                [budget],
                *([task.heading_tolerance - fixed, task.heading_tolerance + fixed] if task.wants_heading else []),
            ]
        )
        free = radius is None
        if free:
            matrix = np.hstack([matrix, np.zeros((len(matrix), 1))])

        def value(x: Float[np.ndarray, "x"]) -> Float[np.ndarray, "constraints"]:
            allowed = x[-1] if free else radius
            return np.concatenate([allowed - misses(x[:count])[0], room + matrix @ x])

        def slope(x: Float[np.ndarray, "x"]) -> Float[np.ndarray, "constraints x"]:
            along = -misses(x[:count])[1]
            if free:
                along = np.hstack([along, np.ones((len(along), 1))])
            return np.vstack([along, matrix])

        cost = np.zeros(count + free)
        cost[-1 if free else slice(None)] = 1.0
        first = np.append(start, misses(start)[0].max()) if free else start
        answer = _slsqp(first, cost, value, slope)
        if answer is None:
            return None
        times = np.maximum(answer[:count], 0.0)
        reached = float(misses(times)[0].max())
        too_far = radius is not None and reached > radius + 0.25 * MARGIN
        if too_far or (room + matrix[:, :count] @ times).min() < -1e-7:
            return None
        return times, reached if radius is None else radius

    def _turns(self, times: Float[np.ndarray, "trims"]) -> float:
        """Returns the full turns that the heading at level 0 is nearest to the wanted one with, in radians."""
        if not self._task.wants_heading:
            return 0.0
        heading = float(self._lines.turn[0].sum() + self._lines.rate[0] @ times)
        return 2 * np.pi * round((heading - self._task.heading) / (2 * np.pi))

    def _described(
        self,
        times: Float[np.ndarray, "trims"],
        worst: WorstMiss,
        gammas: tuple[float, ...],
        radius: float | None,
    ) -> Descended:
        numbers = fan(self._library, (self._walk,), gammas)
        end, _, along = numbers.ends(np.zeros(1, dtype=int), times[None, :])
        off = end[0] - self._task.goal
        size = np.abs(off)
        active = (size > size.max() - ACTIVE) & (size > 0)
        normal = off[active] / size[active]
        speed = (np.conj(normal)[:, None] * along[0][active]).real
        held = times > HELD
        # Where the largest miss is least, weights sum to 1; where time is, they outweigh each second held.
        rows = np.vstack([speed.T[held], np.ones(active.sum())]) if radius is None else speed.T[held]
        wanted = np.append(np.zeros(held.sum()), 1.0) if radius is None else -np.ones(held.sum())
        weights = nnls(rows, wanted)[0] if active.any() and len(rows) else np.zeros(active.sum())
        levels = tuple(np.array(gammas)[active].tolist())
        return Descended(tuple(times.tolist()), worst, levels, tuple((weights * normal).tolist()))


def _slsqp(
    start: Float[np.ndarray, "x"],
    cost: Float[np.ndarray, "x"],
    value: Callable[[Float[np.ndarray, "x"]], Float[np.ndarray, "constraints"]],
    slope: Callable[[Float[np.ndarray, "x"]], Float[np.ndarray, "constraints x"]],
) -> Float[np.ndarray, "x"] | None:
    answer = minimize(
        lambda x: float(cost @ x),
        start,
        jac=lambda _: cost,
        bounds=[(0.0, None)] * len(start),
        constraints={"type": "ineq", "fun": value, "jac": slope},
        method="SLSQP",
        options={"ftol": 1e-9, "maxiter": 100},
    )
    found: Float[np.ndarray, "x"] = answer.x
    return found if np.isfinite(found).all() else None
