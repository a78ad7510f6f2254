"""Reference planner: the least total time found that reaches the goal."""

from dataclasses import dataclass, replace
from math import inf, log2

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.mission.mission import Mission

from .coasting_flow import fly
from .coasting_problem import CoastingProblem, coasting_problems
from .goal_region import GoalRegion, wrapped
from .one_coast import telling_times
from .sampled_times import seeds
from .stationary_times import polished

ON_THE_SPOT = 1e-2
"""Speed of a last coast, and of the end that it turns about, that counts as none; scaled."""

ROWS_AT_ONCE = 64
"""Walks with a choice of free coasts that are solved together: more do not fit a cache."""


@dataclass(frozen=True, slots=True, eq=False)
class LeastTimes:
    """The least time found for each walk.

    Attributes:
        cost: seconds; infinite where no times were found.
        times: seconds in each trim, 0 beyond the end of a walk.
    """

    cost: Float[np.ndarray, "walks"]
    times: Float[np.ndarray, "walks longest"]


def least_times(
    library: Library,
    mission: Mission,
    walks: list[tuple[int, ...]],
    gamma: float,
    *,
    ceiling: float = inf,
    rng: np.random.Generator,
) -> LeastTimes:
    """Returns the least time found for each walk at a level.

    Args:
        library: the primitives.
        mission: from where to where.
        walks: trim ids.
        gamma: level of the errors.
        ceiling: seconds; walks that need more may count as not possible.
        rng: shifts the grids.
    """
    cost = np.full(len(walks), inf)
    longest = max(map(len, walks), default=0)
    times = np.zeros((len(walks), longest))
    if not walks:
        return LeastTimes(cost, times)
    every = coasting_problems(library, walks, gamma)
    metres, seconds = natural_units(library, mission)
    start = complex(mission.start.x, mission.start.y), mission.start.heading
    goal = GoalRegion.of(mission)
    small = replace(goal, centre=(goal.centre - start[0]) / metres, radius=goal.radius / metres)
    for _free, problem in sorted(every.items()):
        possible = problem.take(problem.fixed < ceiling)
        for begin in range(0, len(possible.walk), ROWS_AT_ONCE):
            part = possible.take(np.arange(begin, min(begin + ROWS_AT_ONCE, len(possible.walk))))
            limit = ceiling / seconds
            found = _solved(_scaled(part, metres, seconds), (0j, start[1]), small, limit, rng)
            for rows, scaled in found:
                chosen, held = part.take(rows), scaled * seconds
                ends = fly(chosen, held, start)
                inside = goal.holds(ends) & (held >= 0).all(axis=1)
                _keep(chosen.take(inside), held[inside], cost, times)
    return LeastTimes(cost, times)


def _solved(
    problem: CoastingProblem,
    start: tuple[complex, float],
    goal: GoalRegion,
    ceiling: float,
    rng: np.random.Generator,
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Returns rows with times that may end inside the goal."""
    rows = np.arange(len(problem.walk))
    if problem.free == 0:
        return [(rows, np.zeros((len(rows), 0)))]
    if problem.free > 1 and goal.heading is not None:
        # A rotation (almost) on the spot at the end leads nowhere: it takes what the heading needs.
        aside = np.abs(problem.velocity[:, -1]) + np.abs(problem.gap[:, -1] * problem.rate[:, -1])
        spot = np.flatnonzero((aside < ON_THE_SPOT) & (problem.rate[:, -1] != 0))
        if len(spot):
            found = _rotated(problem.take(spot), start, goal, ceiling, rng)
            return [(spot[some], times) for some, times in found] + _moved(problem, start, goal, ceiling, rng)
    return _moved(problem, start, goal, ceiling, rng)


def _moved(
    problem: CoastingProblem,
    start: tuple[complex, float],
    goal: GoalRegion,
    ceiling: float,
    rng: np.random.Generator,
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Returns rows with times whose last coasts lead to the goal."""
    rows = np.arange(len(problem.walk))
    if problem.free == 1:
        times = telling_times(problem, start, goal)
        return [(np.repeat(rows, times.shape[1]), times.reshape(-1, 1))]
    anywhere, limits = seeds(problem, start, goal, ceiling, rng)
    found = [(anywhere.row, anywhere.times)]
    if goal.heading is None or goal.width > 0:
        limits = {**limits, None: anywhere}  # type: ignore[dict-item]
    for limit, seed in limits.items():
        if len(seed.row):
            chosen = problem.take(seed.row)
            found.append((seed.row, polished(chosen, seed.times, seed.bearing, start, goal, limit)))
    return found


def _rotated(
    problem: CoastingProblem,
    start: tuple[complex, float],
    goal: GoalRegion,
    ceiling: float,
    rng: np.random.Generator,
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Returns times of walks with a final rotation on the spot."""
    assert goal.heading is not None
    before = replace(
        problem,
        place=problem.place[:, :-1],
        velocity=problem.velocity[:, :-1],
        rate=problem.rate[:, :-1],
        gap=problem.gap[:, :-1],
        gap_turn=np.column_stack([problem.gap_turn[:, :-2], problem.gap_turn[:, -2:].sum(axis=1)]),
    )
    found = []
    for rows, times in _solved(before, start, replace(goal, heading=None), ceiling, rng):
        chosen = problem.take(rows)
        ends = fly(before.take(rows), times, start)
        rate = chosen.rate[:, -1]
        off = wrapped(goal.heading - ends.heading)
        first = np.mod(np.sign(rate) * off - goal.width, 2 * np.pi) / np.abs(rate)
        turn = np.where(np.abs(off) <= goal.width, 0.0, first)
        whole = np.column_stack([times, turn])
        found.append((rows, whole))
        bearing = np.angle(ends.position - goal.centre)
        for side in (-1.0, 1.0) if goal.width > 0 else (0.0,):
            limit = goal.heading + side * goal.width
            found.append((rows, polished(chosen, whole, bearing, start, goal, limit)))
    return found


def _keep(
    problem: CoastingProblem,
    times: Float[np.ndarray, "rows free"],
    cost: Float[np.ndarray, "walks"],
    best: Float[np.ndarray, "walks longest"],
) -> None:
    """Records improvements over the best known times of each walk."""
    total = problem.fixed + times.sum(axis=1)
    for row in np.argsort(-total):
        walk = problem.walk[row]
        if total[row] < cost[walk]:
            cost[walk] = total[row]
            best[walk] = 0.0
            best[walk, problem.place[row]] = times[row]


def natural_units(library: Library, mission: Mission) -> tuple[float, float]:
    """Returns powers of 2 as exact units of metres and seconds."""
    away = abs(complex(*mission.goal) - complex(mission.start.x, mission.start.y))
    moved = [abs(complex(one.displacement.x, one.displacement.y)) for one in library.maneuvers]
    metres = max(away, mission.tolerance, *moved, 0.0)
    speed = max(abs(complex(one.velocity.forward, one.velocity.side)) for one in library.trims)
    turning = max(abs(one.velocity.yaw_rate) for one in library.trims)
    metres = 2.0 ** round(log2(metres)) if metres > 0 else 1.0
    rate = max(speed / metres, turning)
    return metres, 2.0 ** round(-log2(rate)) if rate > 0 else 1.0


def _scaled(problem: CoastingProblem, metres: float, seconds: float) -> CoastingProblem:
    return replace(
        problem,
        velocity=problem.velocity * (seconds / metres),
        rate=problem.rate * seconds,
        gap=problem.gap / metres,
        fixed=problem.fixed / seconds,
    )


def worst_of_each(
    library: Library,
    mission: Mission,
    walks: list[tuple[int, ...]],
    gammas: tuple[float, ...],
    *,
    ceiling: float = inf,
    rng: np.random.Generator,
) -> tuple[Float[np.ndarray, "walks"], Float[np.ndarray, "levels walks longest"]]:
    """Returns each walk's largest least time over levels, with the times.

    Walks that reach the ceiling at one level are skipped at the others.
    """
    worst = np.zeros(len(walks))
    times = np.zeros((len(gammas), len(walks), max(map(len, walks), default=0)))
    left = np.arange(len(walks))
    for place, gamma in enumerate(gammas):
        some = [walks[index] for index in left]
        found = least_times(library, mission, some, gamma, ceiling=ceiling, rng=rng)
        worst[left] = np.maximum(worst[left], found.cost)
        times[place, left, : found.times.shape[1]] = found.times
        left = left[worst[left] < ceiling]
    return worst, times
