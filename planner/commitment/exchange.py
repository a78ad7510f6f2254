"""Local optimum of coasting times at finitely many levels, by SLSQP."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize

from .committed_task import CommittedTask
from .walk_batch import WalkBatch

OUTSIDE = 2.5e-7
"""Metres, and seconds or radians, by which a solution may violate its constraints."""

HEADING_MARGIN = 3e-8
"""Radians by which heading limits are tightened: solvers relax constraints by some 1e-8."""

COINCIDENT = 1e-12
"""Metres within which the goal is met exactly; a miss has no direction there."""


@dataclass(frozen=True, slots=True, eq=False)
class FiniteProblem:
    """Coasting times of the only walk of a batch, at its levels.

    Attributes:
        walk_batch: the walk.
        gammas: those levels.
        task: the mission over the levels.
        turns: full turns in radians added to the wanted heading.
        budget: seconds that the times may take together.
        radius: metres within which every level must end; None to make the largest miss least instead.
    """

    walk_batch: WalkBatch
    gammas: tuple[float, ...]
    task: CommittedTask
    turns: float
    budget: float
    radius: float | None

    def misses(
        self, times: Float[np.ndarray, "trims"]
    ) -> tuple[Float[np.ndarray, "levels"], Float[np.ndarray, "levels trims"]]:
        """Returns each level's miss in metres and its gradient."""
        end, _, along = self.walk_batch.ends(times[None, :])
        off = end[0] - self.task.goal
        size = np.maximum(np.abs(off), COINCIDENT)
        return size, (np.conj(off / size)[:, None] * along[0]).real

    def linear_constraints(self) -> tuple[Float[np.ndarray, "rows trims"], Float[np.ndarray, "rows"]]:
        """Returns `A, b` of `A @ times + b >= 0`: budget and heading."""
        rates, task = self.walk_batch.rate[0], self.task
        matrix, room = -np.ones((1, rates.shape[1])), np.array([self.budget])
        if not task.wants_heading:
            return matrix, room
        off = self.walk_batch.turned[0] - task.heading - self.turns
        width = max(task.heading_tolerance - HEADING_MARGIN, 0.0)
        return np.vstack([matrix, -rates, rates]), np.concatenate([room, width - off, width + off])

    def faces(self, times: Float[np.ndarray, "trims"]) -> bool:
        """Returns True if every level ends with the wanted heading."""
        if not self.task.wants_heading:
            return True
        off = self.walk_batch.turned[0] - self.task.heading - self.turns + self.walk_batch.rate[0] @ times
        return bool((np.abs(off) <= self.task.heading_tolerance).all())

    def solve(self, start: Float[np.ndarray, "trims"]) -> tuple[Float[np.ndarray, "trims"], float] | None:
        """Returns locally optimal times and their largest miss, or None.

        Args:
            start: seconds to start from.
        """
        free, count = self.radius is None, len(start)
        matrix, room = self.linear_constraints()

        def value(x: Float[np.ndarray, "x"]) -> Float[np.ndarray, "constraints"]:
            allowed = x[-1] if self.radius is None else self.radius
            return np.concatenate([allowed - self.misses(x[:count])[0], room + matrix @ x[:count]])

        def slope(x: Float[np.ndarray, "x"]) -> Float[np.ndarray, "constraints x"]:
            rows = np.vstack([-self.misses(x[:count])[1], matrix])
            if not free:
                return rows
            last = (np.arange(len(rows)) < len(rows) - len(matrix)).astype(float)
            return np.hstack([rows, last[:, None]])

        cost = np.append(np.zeros(count), 1.0) if free else np.ones(count)
        # SciPy's stubs accept no constant gradient.
        problem: Any = {
            "fun": lambda x: float(cost @ x),
            "x0": np.append(start, self.misses(start)[0].max()) if free else start,
            "jac": lambda _: cost,
            "bounds": [(0.0, None)] * len(cost),
            "constraints": [{"type": "ineq", "fun": value, "jac": slope}],
        }
        solution: Any = minimize(**problem, method="SLSQP", options={"ftol": 1e-9, "maxiter": 100})
        if not np.isfinite(solution.x).all():
            return None
        times = np.maximum(solution.x[:count], 0.0)
        reached = float(self.misses(times)[0].max())
        within = reached if self.radius is None else self.radius
        if reached > within + OUTSIDE or (room + matrix @ times).min() < -OUTSIDE:
            return None
        return times, within
