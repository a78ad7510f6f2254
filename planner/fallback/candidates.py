"""Walks that may win, with the coasting times that their solver starts from."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

import numpy as np
from jaxtyping import Float

from flight.mission.mission import Mission
from flight.se2 import rotate
from planner.walks.goal_condition import reaches_goal, wants_heading
from planner.walks.kinematics import WalkMotion
from planner.walks.search_result import Times
from planner.walks.walk import Walk

from .coasting import solve
from .optimality import settled
from .starts import Goal, Starts, closed_forms, gather, one_more_time
from .walk_table import WalkTable

STARTS = 3
"""Coasting times kept for one walk at one level; with a heading wanted, twice as many."""

ROUNDING = 1e-9
"""Share of a tolerance that closed forms leave unused, so that rounding does not fail the check."""

COST_ROUNDING = 1e-9
"""Seconds by which a bound may exceed the cost it bounds, through rounding alone."""

PROMISE = 0.03
"""Share of its cost by which the solver may improve a start that is no optimum; beyond, it is not tried."""


@dataclass(frozen=True, slots=True)
class Start:
    """Coasting times in seconds, and whether they are locally optimal as they stand."""

    times: Times
    settled: bool


@dataclass(frozen=True, slots=True)
class Candidate:
    """A walk that may win.

    Attributes:
        walk: trim ids.
        motions: its numbers, one for each level.
        starts: for each level, the most promising first.
        hopes: seconds that may be reached at each level; optimistic.
    """

    walk: Walk
    motions: tuple[WalkMotion, ...]
    starts: tuple[tuple[Start, ...], ...]
    hopes: tuple[float, ...]

    @property
    def hope(self) -> float:
        """The worst of the hopes."""
        return max(self.hopes)


def candidates(
    bounded: list[tuple[WalkTable, Float[np.ndarray, "walks"]]], mission: Mission
) -> Iterator[Candidate]:
    """Returns the walks that reach the goal at every level, unless a bound excludes them.

    Args:
        bounded: tables of walks, with a lower bound of each walk's worst level in seconds.
        mission: from where to where.
    """
    goal = _goal(mission)
    closed = [closed_forms(table.batch, goal) for table, _ in bounded]
    best = inf
    if goal.heading is None:
        costs = [_worst_found(table, found) for (table, _), found in zip(bounded, closed, strict=True)]
        best = min((float(cost.min()) for cost in costs), default=inf)
    for (table, bound), found in zip(bounded, closed, strict=True):
        # A walk that arrives without coasting costs as much as its bound: it must not exclude itself.
        kept = bound <= best + COST_ROUNDING
        if not kept.any():
            continue
        smaller = table.take(kept)
        rows = np.repeat(kept, len(table.gammas))
        known = found.take(rows[found.row]).renumbered(np.cumsum(rows) - 1)
        limit = best if np.isfinite(best) else 4 * float(np.max(bound)) + 60
        longest = np.maximum(limit - smaller.batch.fixed_time, 0)
        more = one_more_time(smaller.batch, goal, longest)
        yield from _gathered(smaller, bound[kept], gather([known, more]), goal)


def solved(
    candidate: Candidate, mission: Mission, limit: float
) -> tuple[tuple[Times, ...], tuple[float, ...]] | None:
    """Returns coasting times and costs at every level, or None where one level is no better than a limit.

    Args:
        candidate: the walk; its least hopeful level is solved first.
        mission: from where to where.
        limit: seconds.
    """
    levels = len(candidate.motions)
    times: list[Times] = [()] * levels
    costs = [inf] * levels
    for level in sorted(range(levels), key=lambda one: -candidate.hopes[one]):
        numbers = candidate.motions[level]
        for start in candidate.starts[level]:
            tried = start.times if start.settled else solve(numbers, mission, start.times)
            times[level], costs[level] = _better(
                numbers, mission, (times[level], costs[level]), tried, start.times
            )
        if costs[level] >= limit:
            return None
    return tuple(times), tuple(costs)


def polished(candidate: Candidate, mission: Mission, times: tuple[Times, ...]) -> tuple[Times, ...]:
    """Returns coasting times after one more solution from themselves at every level, never worse ones."""
    return tuple(
        _better(numbers, mission, (known, numbers.cost(known)), solve(numbers, mission, known))[0]
        for numbers, known in zip(candidate.motions, times, strict=True)
    )


def _better(
    numbers: WalkMotion, mission: Mission, known: tuple[Times, float], *tried: Times | None
) -> tuple[Times, float]:
    best, cost = known
    for times in tried:
        if times is None or numbers.cost(times) >= cost:
            continue
        if reaches_goal(numbers.end(mission.start, times), mission):
            best, cost = times, numbers.cost(times)
    return best, cost


def _goal(mission: Mission) -> Goal:
    x, y = mission.goal[0] - mission.start.x, mission.goal[1] - mission.start.y
    centre = complex(*rotate(x, y, -mission.start.heading))
    tolerance = mission.tolerance * (1 - ROUNDING)
    if mission.goal_heading is None or not wants_heading(mission):
        return Goal(centre, tolerance)
    return Goal(centre, tolerance, mission.goal_heading - mission.start.heading, mission.heading_tolerance)


def _gathered(
    table: WalkTable, bound: Float[np.ndarray, "walks"], found: Starts, goal: Goal
) -> Iterator[Candidate]:
    levels = len(table.gammas)
    chosen = found.best_of_each_row(STARTS if goal.heading is None else 2 * STARTS)
    done = settled(table.batch, goal, chosen)
    if goal.heading is None:
        hopes = np.where(done, chosen.cost, chosen.cost * (1 - PROMISE))
    else:
        hopes = np.repeat(bound, levels)[chosen.row]
    starts: dict[int, list[Start]] = {}
    hope: dict[int, float] = {}
    for row, times, is_done, seconds in zip(
        chosen.row.tolist(), chosen.times.tolist(), done.tolist(), hopes.tolist(), strict=True
    ):
        starts.setdefault(row, []).append(Start(tuple(times), is_done))
        hope[row] = min(hope.get(row, inf), seconds)
    for place, walk in enumerate(table.walks):
        rows = range(place * levels, (place + 1) * levels)
        if all(row in starts for row in rows):
            yield Candidate(
                walk,
                table.motions[rows.start : rows.stop],
                tuple(tuple(starts[row]) for row in rows),
                tuple(hope[row] for row in rows),
            )


def _worst_found(table: WalkTable, found: Starts) -> Float[np.ndarray, "walks"]:
    cheapest = np.full(len(table.motions), inf)
    np.minimum.at(cheapest, found.row, found.cost)
    return table.worst(cheapest)
