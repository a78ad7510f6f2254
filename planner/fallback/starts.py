"""Where to look for coasting times: every closed-form way to the goal, along a grid of the remaining times.

Nine optima in ten have two times that are not zero, or one that meets the tolerance disc: those are found
here exactly. For the others one more time runs over a grid, the best of each curve is refined, and what comes
out is where the solver starts.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Complex, Float, Int

from flight.mission.goal import SLACK

from .batch import Batch
from .two_times import Times, close, meet_disc

GRID = 16
"""Samples of the third time along its range; a turn is sampled every 23 degrees or closer."""

ZOOMS = 2
"""Closer looks at the best samples; each one is four times finer."""

OFFSETS = np.array([-0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75])
"""Where a closer look samples, in steps of the grid before it."""

DIRECTIONS = 8
"""Points on the edge of the tolerance disc that are tried first."""

ROUNDS = 4
"""Corrections of the point on the edge; each one gains about two digits."""


HEADING_WORTH = 3.0
"""Seconds a radian: how much a wrong heading at the goal counts among starts that the solver has to turn."""


@dataclass(frozen=True, slots=True)
class Goal:
    """Where walks are to end, seen from a start that heads north.

    Attributes:
        centre: north + i east in metres.
        tolerance: radius around it in metres; 0 for equality.
        heading: wanted there, radians; None for any.
        heading_tolerance: half width around the heading, radians.
    """

    centre: complex
    tolerance: float
    heading: float | None = None
    heading_tolerance: float = 0.0

    def detour(self, heading: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n"]:
        """Returns seconds that a heading at the goal is ranked lower by; 0 where it is as wanted, or free."""
        if self.heading is None:
            return np.zeros(len(heading))
        off = heading - self.heading
        off = np.abs(off - 2 * np.pi * np.round(off / (2 * np.pi)))
        return HEADING_WORTH * np.maximum(off - self.heading_tolerance, 0.0)

    def points(self) -> Complex[np.ndarray, "points"]:
        """Returns points to aim at: the centre, the nearest of the edge, more along the edge."""
        if self.tolerance == 0:
            return np.array([self.centre])
        outward = -self.centre / abs(self.centre) if self.centre else 1.0
        edge = self.tolerance * outward * np.exp(2j * np.pi * np.arange(DIRECTIONS) / DIRECTIONS)
        return np.concatenate([[self.centre], self.centre + edge])


@dataclass(frozen=True, slots=True, eq=False)
class Starts:
    """Coasting times that reach the goal; one row may have none or many.

    Attributes:
        row: of the batch.
        times: seconds, not negative.
        aim: the point of the disc that was aimed at.
        cost: seconds of the whole walk; more where it ends with another heading than the one wanted.
    """

    row: Int[np.ndarray, "found"]
    times: Times
    aim: Complex[np.ndarray, "found"]
    cost: Float[np.ndarray, "found"]

    def take(self, index: Int[np.ndarray, "taken"] | Bool[np.ndarray, "found"]) -> "Starts":
        """Returns some of them, in the order asked for."""
        return Starts(self.row[index], self.times[index], self.aim[index], self.cost[index])

    def renumbered(self, row: Int[np.ndarray, "rows"]) -> "Starts":
        """Returns the same with other row numbers."""
        return Starts(row[self.row], self.times, self.aim, self.cost)

    def best_of_each_row(self, count: int) -> "Starts":
        """Returns the cheapest few of each row."""
        order = np.lexsort((self.cost, self.row))
        ordered = self.row[order]
        first = np.searchsorted(ordered, ordered)
        return self.take(order[np.arange(len(order)) - first < count])


def gather(parts: list[Starts]) -> Starts:
    """Returns all of them in one."""
    return Starts(
        np.concatenate([part.row for part in parts]),
        np.concatenate([part.times for part in parts]),
        np.concatenate([part.aim for part in parts]),
        np.concatenate([part.cost for part in parts]),
    )


def closed_forms(batch: Batch, goal: Goal) -> Starts:
    """Returns the ways to the goal with at most two coasting times that are not zero.

    Args:
        batch: the walks, from the origin with heading 0.
        goal: seen from there.
    """
    rows = np.arange(len(batch.rate))
    still = np.zeros(batch.rate.shape)
    centre = np.full(len(rows), goal.centre)
    found = [_arrived(batch, goal, rows, still, centre)]
    for place in range(batch.trims):
        times = meet_disc(batch, still, centre, goal.tolerance, place=place)
        found.append(_arrived(batch, goal, np.tile(rows, 2), times, np.tile(centre, 2)))
    points = goal.points()
    each = np.repeat(rows, len(points))
    for first, second in combinations(range(batch.trims), 2):
        ways = _Ways(batch, goal, first, second)
        pair = ways.closed(each, np.repeat(still, len(points), axis=0), np.tile(points, len(rows)))
        found.append(pair)
        if goal.tolerance:
            found += ways.along_the_edge(pair)
    return gather(found)


def one_more_time(batch: Batch, goal: Goal, longest: Float[np.ndarray, "rows"]) -> Starts:
    """Returns ways to the goal with three coasting times, the best along each curve of such ways.

    Args:
        batch: as for `closed_forms`.
        goal: as for `closed_forms`.
        longest: seconds that the third time may take, for each row.
    """
    nothing = np.zeros(0, dtype=int)
    found = [Starts(nothing, np.zeros((0, batch.trims)), nothing * 0j, nothing * 0.0)]
    for triple in combinations(range(batch.trims), 3):
        # The fastest turn runs over its grid: one full turn is all it can want.
        fastest = np.abs(batch.rate[:, triple]).argmax(axis=1)
        for turn in range(3):
            rows = np.flatnonzero(fastest == turn)
            if len(rows):
                found.append(
                    _three_times(batch.take(rows), goal, longest[rows], triple, turn).renumbered(rows)
                )
    return gather(found)


def _three_times(
    batch: Batch, goal: Goal, longest: Float[np.ndarray, "rows"], triple: tuple[int, ...], turn: int
) -> Starts:
    third = triple[turn]
    first, second = (place for place in triple if place != third)
    with np.errstate(divide="ignore"):
        ranges = np.minimum(longest, 2 * np.pi / np.abs(batch.rate[:, third]))
    ways = _Ways(batch, goal, first, second)
    return ways.refined(ways.sampled(goal.points()[:2], ranges, third), ranges / GRID, third)


@dataclass(frozen=True, slots=True, eq=False)
class _Ways:
    """The ways to a goal in which the times at two places follow from the others in closed form."""

    batch: Batch
    goal: Goal
    first: int
    second: int

    def closed(self, rows: Int[np.ndarray, "n"], times: Times, aims: Complex[np.ndarray, "n"]) -> Starts:
        """Returns the ways to the points aimed at with the other times as given."""
        closed = close(self.batch.take(rows), times, aims, first=self.first, second=self.second)
        return _arrived(self.batch, self.goal, np.tile(rows, 2), closed, np.tile(aims, 2))

    def along_the_edge(self, pair: Starts) -> list[Starts]:
        """Moves the point aimed at along the edge of the disc to where the walk is shortest.

        With the multipliers that make both coasting times equally worth while, the cost falls fastest in the
        direction of the multiplier; at the best point that is the outward normal.
        """
        found = []
        best = pair.best_of_each_row(2)
        for _ in range(ROUNDS):
            multiplier = multipliers(
                self.batch.take(best.row), best.times, first=self.first, second=self.second
            )
            size = np.abs(multiplier)
            known = np.isfinite(size) & (size > 0)
            best = best.take(known)
            if not len(best.row):
                break
            aims = self.goal.centre + self.goal.tolerance * multiplier[known] / size[known]
            moved = self.closed(best.row, best.times, aims)
            found.append(moved)
            best = moved.best_of_each_row(2)
        return found

    def sampled(
        self, points: Complex[np.ndarray, "points"], ranges: Float[np.ndarray, "rows"], third: int
    ) -> Starts:
        """Returns the best ways of each row along a grid of a third time."""
        rows = np.repeat(np.arange(len(ranges)), GRID * len(points))
        times = np.zeros((len(rows), self.batch.trims))
        grid = np.repeat((np.arange(GRID) + 1) / GRID, len(points))
        times[:, third] = (ranges[:, None] * grid).ravel()
        return self.closed(rows, times, np.tile(points, GRID * len(ranges))).best_of_each_row(2)

    def refined(self, coarse: Starts, step: Float[np.ndarray, "rows"], third: int) -> Starts:
        """Looks more closely around the third times found."""
        best = coarse
        for _ in range(ZOOMS):
            rows = np.repeat(best.row, len(OFFSETS))
            times = np.repeat(best.times, len(OFFSETS), axis=0)
            times[:, third] += np.tile(OFFSETS, len(best.row)) * step[rows]
            times[:, third] = np.maximum(times[:, third], 0)
            best = self.closed(rows, times, np.repeat(best.aim, len(OFFSETS))).best_of_each_row(2)
            step = step / 4
        return best


def multipliers(batch: Batch, times: Times, *, first: int, second: int) -> Complex[np.ndarray, "rows"]:
    """Returns the vector m (s/m) with m . v = -1 for the end velocities v of two coasting times."""
    velocity = batch.end_velocities(times)
    one, two = velocity[:, first], velocity[:, second]
    with np.errstate(divide="ignore", invalid="ignore"):
        multiplier: Complex[np.ndarray, "rows"] = 1j * (two - one) / (np.conj(one) * two).imag
    return multiplier


def _arrived(
    batch: Batch, goal: Goal, rows: Int[np.ndarray, "n"], times: Times, aims: Complex[np.ndarray, "n"]
) -> Starts:
    """Keeps what is a way to the goal; not-a-number is none."""
    possible = (times >= -1e-9).all(axis=1) & (times < 1e6).all(axis=1)
    rows, times, aims = rows[possible], np.maximum(times[possible], 0), aims[possible]
    end, heading = batch.take(rows).end(times)
    there = np.abs(end - goal.centre) <= goal.tolerance + SLACK
    rows, times, aims, heading = rows[there], times[there], aims[there], heading[there]
    return Starts(rows, times, aims, batch.fixed_time[rows] + times.sum(axis=1) + goal.detour(heading))
