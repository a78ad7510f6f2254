"""The best walk for a mission, over several uncertainty levels at once.

For every walk the coasting times are chosen anew at every level; a walk is as good as its worst level, and
out where one level does not reach the goal (thesis, Problem 6.2; Problem 6.1 is the case of level 0 alone).

First all walks at all levels together, in closed form; then, best first, the walks that may still win are
solved by CasADi from the best starts. A walk whose lower bound exceeds the best plan so far is left out.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import inf

import numpy as np
from jaxtyping import Float

from flight.library import Library
from flight.mission import Mission
from flight.se2 import rotate

from .batch import Batch
from .bounds import least_costs
from .coasting import Times, reaches, solve, wants_heading
from .kinematics import Motion, motion
from .sequences import Walk, walks
from .starts import Goal, Starts, closed_forms, gather, one_more_time

STARTS = 3
"""Starts of the solver for one walk at one level."""

ROUNDING = 1e-9
"""Share of the tolerance that closed forms leave unused, so that rounding does not fail the check."""

COST_ROUNDING = 1e-9
"""Seconds by which a bound may exceed the cost it bounds, through rounding alone."""

PROMISE = 0.03
"""Share of its cost by which the solver may improve a start that is no optimum; beyond, it is not tried."""


@dataclass(frozen=True)
class WalkTable:
    """All walks of one length from one trim, at every level: row = walk x levels + level."""

    walks: tuple[Walk, ...]
    gammas: tuple[float, ...]
    motions: tuple[Motion, ...]

    @cached_property
    def batch(self) -> Batch:
        """The same as arrays."""
        return Batch.of(self.motions)

    def take(self, kept: Float[np.ndarray, "walks"]) -> "WalkTable":
        """Returns the walks that are marked."""
        levels = len(self.gammas)
        chosen = [place for place in range(len(self.walks)) if kept[place]]
        return WalkTable(
            tuple(self.walks[place] for place in chosen),
            self.gammas,
            tuple(self.motions[place * levels + level] for place in chosen for level in range(levels)),
        )


@dataclass(frozen=True, slots=True)
class Answer:
    """The best walk found, with its coasting times at every level; no walk where none was found.

    Attributes:
        walk: trim ids; empty where none was found.
        times: seconds, one tuple for each level.
        costs: seconds, one for each level.
        lower_bound: seconds that no plan undercuts; infinite where it is proved that there is none.
    """

    walk: Walk
    times: tuple[Times, ...]
    costs: tuple[float, ...]
    lower_bound: float


def tabulate(
    library: Library, gammas: tuple[float, ...], start_trim: int, max_trims: int, goal_trim: int | None
) -> tuple[WalkTable, ...]:
    """Returns the walks from a trim with their numbers at every level, a table for each length."""
    by_length: dict[int, list[Walk]] = {}
    for walk in walks(library, start_trim, max_trims=max_trims, goal_trim=goal_trim):
        by_length.setdefault(len(walk), []).append(walk)
    return tuple(
        WalkTable(
            tuple(group), gammas, tuple(motion(library, walk, gamma) for walk in group for gamma in gammas)
        )
        for group in by_length.values()
    )


def search(tables: tuple[WalkTable, ...], mission: Mission) -> Answer:
    """Returns the walk whose worst level is best."""
    bounded = [(table, _worst(table, least_costs(table.batch, mission))) for table in tables]
    lower_bound = min((float(bound.min()) for _, bound in bounded), default=inf)
    kept = [(table.take(np.isfinite(bound)), bound[np.isfinite(bound)]) for table, bound in bounded]
    candidates = list(_candidates([pair for pair in kept if len(pair[1])], mission))
    best = Answer((), (), (), lower_bound)
    worst = inf
    for candidate in sorted(candidates, key=lambda one: one.hope):
        if candidate.hope >= worst:
            break
        found = _solve(candidate, mission, worst)
        if found is not None and max(found[1]) < worst:
            worst = max(found[1])
            best = Answer(candidate.walk, found[0], found[1], lower_bound)
    return best


@dataclass(frozen=True, slots=True)
class _Candidate:
    """A walk with the starts of its solver at each level.

    Attributes:
        walk: trim ids.
        motions: its numbers, one for each level.
        starts: coasting times to start from, the cheapest first, for each level.
        hopes: seconds that a solver may reach at each level; optimistic.
        hope: the worst of them.
    """

    walk: Walk
    motions: tuple[Motion, ...]
    starts: tuple[tuple[Times, ...], ...]
    hopes: tuple[float, ...]

    @property
    def hope(self) -> float:
        return max(self.hopes)


def _solve(
    candidate: _Candidate, mission: Mission, worst: float
) -> tuple[tuple[Times, ...], tuple[float, ...]] | None:
    """Solves the least hopeful level first, and gives up as soon as one is no better than the best plan."""
    levels = len(candidate.motions)
    times: list[Times] = [()] * levels
    costs = [inf] * levels
    for level in sorted(range(levels), key=lambda one: -candidate.hopes[one]):
        times[level], costs[level] = _solve_level(candidate.motions[level], mission, candidate.starts[level])
        if costs[level] >= worst:
            return None
    return tuple(times), tuple(costs)


def _solve_level(numbers: Motion, mission: Mission, starts: tuple[Times, ...]) -> tuple[Times, float]:
    best: Times = ()
    cost = inf
    for start in starts:
        for times in (solve(numbers, mission, start), start):
            if (
                times is not None
                and numbers.cost(times) < cost
                and reaches(numbers.end(mission.start, times), mission)
            ):
                best, cost = times, numbers.cost(times)
    return best, cost


def _candidates(
    bounded: list[tuple[WalkTable, Float[np.ndarray, "walks"]]], mission: Mission
) -> Iterator[_Candidate]:
    x, y = mission.goal[0] - mission.start.x, mission.goal[1] - mission.start.y
    goal = Goal(complex(*rotate(x, y, -mission.start.heading)), mission.tolerance * (1 - ROUNDING))
    free = not wants_heading(mission)
    closed = [closed_forms(table.batch, goal) for table, _ in bounded]
    costs = [
        _worst(table, _cheapest(table, found)) for (table, _), found in zip(bounded, closed, strict=True)
    ]
    best = min((float(cost.min()) for cost in costs), default=inf) if free else inf
    for (table, bound), found in zip(bounded, closed, strict=True):
        levels = len(table.gammas)
        # A walk that arrives without coasting costs as much as its bound: it must not exclude itself.
        kept = bound <= best + COST_ROUNDING
        rows = np.repeat(kept, levels)
        if not kept.any():
            continue
        smaller = table.take(kept)
        mapped = found.take(rows[found.row])
        mapped = Starts((np.cumsum(rows) - 1)[mapped.row], mapped.times, mapped.aim, mapped.cost)
        limit = best if np.isfinite(best) else 4 * float(np.max(bound)) + 60
        longest = np.maximum(limit - smaller.batch.fixed_time, 0)
        more = one_more_time(smaller.batch, goal, longest)
        yield from _gathered(smaller, gather([mapped, more]), mission)


def _gathered(table: WalkTable, found: Starts, mission: Mission) -> Iterator[_Candidate]:
    levels = len(table.gammas)
    free = not wants_heading(mission)
    chosen = found.best_of_each_row(STARTS)
    by_row: dict[int, list[Times]] = {}
    costs: dict[int, float] = {}
    for row, times, cost in zip(
        chosen.row.tolist(), chosen.times.tolist(), chosen.cost.tolist(), strict=True
    ):
        by_row.setdefault(row, []).append(tuple(times))
        costs.setdefault(row, cost)
    for place, walk in enumerate(table.walks):
        rows = range(place * levels, (place + 1) * levels)
        if all(row in by_row for row in rows):
            yield _Candidate(
                walk,
                table.motions[rows.start : rows.stop],
                tuple(tuple(by_row[row]) for row in rows),
                tuple(costs[row] * (1 - PROMISE) if free else 0.0 for row in rows),
            )


def _cheapest(table: WalkTable, found: Starts) -> Float[np.ndarray, "rows"]:
    cheapest = np.full(len(table.motions), inf)
    np.minimum.at(cheapest, found.row, found.cost)
    return cheapest


def _worst(table: WalkTable, by_row: Float[np.ndarray, "rows"]) -> Float[np.ndarray, "walks"]:
    worst: Float[np.ndarray, "walks"] = by_row.reshape(-1, len(table.gammas)).max(axis=1)
    return worst
