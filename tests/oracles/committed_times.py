"""Committed coasting times by SLSQP at few levels, checked at many."""

from dataclasses import dataclass
from math import inf

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize

from flight.automaton.library import Library
from flight.mission.mission import Mission

from .coasting_flow import Ends, end_velocities, fly
from .coasting_problem import CoastingProblem, joined, whole_walks
from .goal_region import ROUNDING, GoalRegion, wrapped
from .least_time import natural_units

DENSE = 1001
"""Levels at which times are checked."""

INSIDE = 1e-9
"""Share of the tolerance that SLSQP keeps away from the edge, beside what levels between may miss."""

ROUNDS = 5
"""Of SLSQP, each with the level added that missed most."""


@dataclass(frozen=True, slots=True)
class CommittedTimes:
    """Times of a walk that reach the goal at every evaluated level.

    Attributes:
        cost: seconds at the level that takes longest; infinite where none were found.
        times: seconds in each trim.
    """

    cost: float
    times: tuple[float, ...] = ()


class CommittedWalk:
    """A walk whose coasting times are fixed before the level is known.

    Args:
        library: the primitives.
        mission: with a tolerance above 0.
        walk: trim ids.
        gamma: largest level.
    """

    def __init__(self, library: Library, mission: Mission, walk: tuple[int, ...], gamma: float) -> None:
        self._levels = np.linspace(-gamma, gamma, DENSE)
        self._goal = GoalRegion.of(mission)
        self._start = complex(mission.start.x, mission.start.y), mission.start.heading
        self._every = joined([whole_walks(library, [walk], one, np.array([0])) for one in self._levels])
        self._metres, self._seconds = natural_units(library, mission)

    def check(self, times: tuple[float, ...]) -> CommittedTimes:
        """Returns the times with their cost; infinite for a miss."""
        held = np.tile(np.maximum(times, 0.0), (DENSE, 1))
        ends = fly(self._every, held, self._start)
        rounding = ROUNDING * (ends.way + abs(self._goal.centre))
        inside = (self._goal.beyond(ends) + self._between(ends) <= rounding).all()
        inside &= (self._goal.heading_beyond(ends) <= ROUNDING * (10 + np.abs(ends.heading))).all()
        cost = float((self._every.fixed + held.sum(axis=1)).max())
        return CommittedTimes(cost if inside else inf, tuple(held[0].tolist()))

    def misses(self, times: tuple[float, ...], slack: float) -> bool:
        """Returns True if some level misses the goal by more than slack."""
        ends = fly(self._every, np.tile(times, (DENSE, 1)), self._start)
        beyond = self._goal.beyond(ends) - ROUNDING * ends.way
        return bool(beyond.max() > slack or self._goal.heading_beyond(ends).max() > slack)

    @staticmethod
    def _between(ends: Ends) -> float:
        """Returns metres by which a miss between two levels may exceed both."""
        # An eighth of the second difference, and as much again.
        return float(np.abs(np.diff(ends.position, 2)).max()) / 4

    def fastest(self, start: tuple[float, ...]) -> CommittedTimes:
        """Returns the fastest times that SLSQP finds from some."""
        chosen = [0, DENSE // 2, DENSE - 1]
        scaled = np.array(start) / self._seconds
        best = self.check(start)
        inside = INSIDE
        for _ in range(ROUNDS):
            problem = self._every.take(np.array(chosen))
            found = minimize(  # type: ignore[call-overload]
                lambda x: float(x.sum()),
                scaled,
                jac=lambda x: np.ones(len(x)),
                bounds=[(0.0, None)] * len(scaled),
                constraints={
                    "type": "ineq",
                    "fun": lambda x, p=problem, s=inside: self._spare(p, x, s)[0],
                    "jac": lambda x, p=problem, s=inside: self._spare(p, x, s)[1],
                },
                method="SLSQP",
                options={"maxiter": 60, "ftol": 1e-12},
            )
            if not np.isfinite(found.x).all():
                return best
            times = tuple((np.maximum(found.x, 0.0) * self._seconds).tolist())
            best = min(best, self.check(times), key=lambda one: one.cost)
            ends = fly(self._every, np.tile(times, (DENSE, 1)), self._start)
            worst = int(np.argmax(self._goal.beyond(ends)))
            more = self._between(ends) / self._goal.radius
            if worst in chosen and more <= inside:
                return best
            inside = max(inside, INSIDE + 1.01 * more)
            chosen = sorted({*chosen, worst})
        return best

    def _spare(
        self, problem: CoastingProblem, scaled: Float[np.ndarray, "trims"], inside: float
    ) -> tuple[Float[np.ndarray, "constraints"], Float[np.ndarray, "constraints trims"]]:
        """Returns the margins of the ends in natural units, and slopes."""
        times = np.tile(scaled * self._seconds, (len(problem.walk), 1))
        ends, moves = end_velocities(problem, times, self._start)
        off = (ends.position - self._goal.centre) / self._goal.radius
        value = 1 - inside - np.abs(off) ** 2
        slope = -2 * (np.conj(off)[:, None] * moves).real * self._seconds / self._goal.radius
        if self._goal.heading is None:
            return value, slope
        turned = wrapped(ends.heading - self._goal.heading)
        turn = problem.rate * self._seconds
        return (
            np.concatenate([value, self._goal.width - turned, self._goal.width + turned]),
            np.concatenate([slope, -turn, turn]),
        )
