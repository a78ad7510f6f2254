"""Local search of coasting times over a whole gamma interval.

The semi-infinite problem is solved by exchange: for finitely many levels, then the level that misses most
joins them, until none misses more than it may.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import nnls

from flight.automaton.library import Library
from planner.walks.walk import Walk

from .committed_task import CommittedTask
from .exchange import HEADING_MARGIN, FiniteProblem
from .walk_batch import walk_batch
from .whole_interval import LinearWalk, WorstMiss, worst_miss

ROUNDS = 12
"""Most exchanges in a descent."""

RESOLUTION = 1e-9
"""Metres to which the largest miss is known."""

RESOLUTION_AS_GIVEN = 1e-10
"""Metres likewise, at the limit of a tolerance."""

MARGIN = 1e-6
"""Metres by which a descent aims inside the tolerance, for the solver's overshoot."""

ACTIVE = 1e-4
"""Metres within which a miss counts as one of the largest."""

AT_LIMIT = 1e-6
"""Radians within which a heading counts as being at a limit."""

HELD = 1e-6
"""Seconds above which a coasting time counts as not zero."""

SAME_LEVEL = 1e-9


@dataclass(frozen=True, slots=True)
class LocalOptimum:
    """Locally best coasting times of a walk.

    Attributes:
        times: seconds, one for each trim.
        worst: the largest miss.
        levels: levels with the largest misses.
        position_weights: for each of these, direction and weight of its constraint in the KKT condition.
        heading_weights: weights there of the heading at the smallest and the largest level, signed.
    """

    times: tuple[float, ...]
    worst: WorstMiss
    levels: tuple[float, ...]
    position_weights: tuple[complex, ...]
    heading_weights: tuple[float, float]


class LocalSearch:
    """Local search in one walk.

    Args:
        library: the primitives.
        walk: trim ids.
        task: the mission over the levels.
    """

    def __init__(self, library: Library, walk: Walk, task: CommittedTask) -> None:
        self._library, self._walk, self._task = library, walk, task
        self._lines = LinearWalk.of(library, walk)

    def minimise_time(self, start: Float[np.ndarray, "trims"], budget: float) -> LocalOptimum | None:
        """Returns the least times within tolerance at every level, or None.

        Args:
            start: seconds.
            budget: seconds that the coasting times may take together.
        """
        return self._descended(start, budget) or self._as_given(start, budget)

    def _as_given(self, times: Float[np.ndarray, "trims"], budget: float) -> LocalOptimum | None:
        """Returns the given times if feasible, without correction; else None."""
        gamma, task, turns = self._task.gamma, self._task, self._turns(times)
        levels = (-gamma, 0.0, gamma)
        problem = FiniteProblem(
            walk_batch(self._library, (self._walk,), levels), levels, task, turns, budget, task.tolerance
        )
        worst = worst_miss(
            self._lines, times, task.goal, gamma, resolution=RESOLUTION_AS_GIVEN, enough=task.tolerance
        )
        if worst.bound > task.tolerance or times.sum() > budget or not problem.faces(times):
            return None
        return _local_optimum(problem, times, worst)

    def _descended(self, start: Float[np.ndarray, "trims"], budget: float) -> LocalOptimum | None:
        aim = self._task.tolerance - MARGIN
        if aim <= 0:
            return None
        found = self._accept(self._exchange(start, budget, aim))
        if found is not None:
            return found
        near = self._accept(self.minimise_miss(start, budget))
        if near is None:
            return None
        return self._accept(self._exchange(np.array(near.times), budget, aim)) or near

    def minimise_miss(self, start: Float[np.ndarray, "trims"], budget: float) -> LocalOptimum | None:
        """Returns the times of least largest miss, or None.

        Args:
            start: seconds.
            budget: seconds that the coasting times may take together.
        """
        return self._exchange(start, budget, None)

    def _accept(self, found: LocalOptimum | None) -> LocalOptimum | None:
        return None if found is None or found.worst.bound > self._task.tolerance else found

    def _exchange(
        self, times: Float[np.ndarray, "trims"], budget: float, radius: float | None
    ) -> LocalOptimum | None:
        gamma, task, turns = self._task.gamma, self._task, self._turns(times)
        gammas = [-gamma, 0.0, gamma]
        for _ in range(ROUNDS):
            levels = tuple(gammas)
            problem = FiniteProblem(
                walk_batch(self._library, (self._walk,), levels), levels, task, turns, budget, radius
            )
            solved = problem.solve(times)
            if solved is None:
                return None
            times, allowed = solved
            worst = worst_miss(self._lines, times, task.goal, gamma, resolution=RESOLUTION)
            if worst.found <= allowed + 0.5 * MARGIN:
                return _local_optimum(problem, times, worst)
            if min(abs(worst.gamma - one) for one in gammas) < SAME_LEVEL:
                return None
            gammas.append(worst.gamma)
        return None

    def _turns(self, times: Float[np.ndarray, "trims"]) -> float:
        """Returns full turns, in radians, to the nearest wanted heading."""
        heading = float(self._lines.turn[0].sum() + self._lines.rate[0] @ times)
        return 2 * np.pi * round((heading - self._task.heading) / (2 * np.pi))


def _local_optimum(
    problem: FiniteProblem, times: Float[np.ndarray, "trims"], worst: WorstMiss
) -> LocalOptimum:
    """Returns times with the multipliers of the active levels."""
    end, _, _ = problem.walk_batch.ends(times[None, :])
    size, growth = problem.misses(times)
    active = size > size.max() - ACTIVE
    normal = ((end[0] - problem.task.goal) / size)[active]
    held = times > HELD
    turning, sides = _active_headings(problem, times)
    rows, count = np.hstack([growth[active].T[held], turning.T[held]]), int(active.sum())
    if problem.radius is None:
        # Where the largest miss is least, weights sum to 1; where time is, they outweigh each second held.
        ones = np.append(np.ones(count), np.zeros(len(turning)))
        rows, wanted = np.vstack([rows, ones]), np.append(np.zeros(int(held.sum())), 1.0)
    else:
        wanted = -np.ones(int(held.sum()))
    weights = nnls(rows, wanted)[0] if len(rows) else np.zeros(count + len(turning))
    levels = tuple(np.array(problem.gammas)[active].tolist())
    position_weights = tuple((weights[:count] * normal).tolist())
    low, high = (weights[count:] @ sides).tolist()
    return LocalOptimum(tuple(times.tolist()), worst, levels, position_weights, (low, high))


def _active_headings(
    problem: FiniteProblem, times: Float[np.ndarray, "trims"]
) -> tuple[Float[np.ndarray, "active trims"], Float[np.ndarray, "active 2"]]:
    """Returns gradients and signs of the active heading constraints."""
    rates, task = problem.walk_batch.rate[0], problem.task
    outer = [int(np.argmin(problem.gammas)), int(np.argmax(problem.gammas))]
    off = (problem.walk_batch.turned[0] - task.heading - problem.turns + rates @ times)[outer]
    limit = task.heading_tolerance - HEADING_MARGIN - AT_LIMIT if task.wants_heading else np.inf
    sides = [sign * np.eye(2)[place] for place in (0, 1) for sign in (1, -1) if sign * off[place] > limit]
    picked = np.array(sides).reshape(-1, 2)
    return picked @ rates[outer], picked
