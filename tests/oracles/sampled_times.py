"""Coasting times on dense grids, with exact last two coasts."""

from dataclasses import dataclass
from math import inf, pi

import numpy as np
from jaxtyping import Float, Int

from .coasting_flow import fly
from .coasting_problem import CoastingProblem
from .goal_region import GoalRegion, wrapped
from .two_coasts import last_two_times

LINES = (0, 1, 12, 24, 32)
"""Lines in a grid of so many dimensions."""

POINTS = (1, 80, 40, 40, 40)
"""Points along a line, likewise."""

BINS = 4
"""Parts of a grid of which each gives its best point, for each of the two solutions."""

CROSSINGS = 5
"""Points of each solution near which a heading limit is met."""

NEAR = 0.5
"""Radians from a heading limit at which a point is tried that has a neighbour without a solution."""

STEEPEST = 0.25
"""Share by which a point may exceed the sought cost and still be refined."""


@dataclass(frozen=True, slots=True, eq=False)
class Seeds:
    """Times that end on the disc's edge or near a wanted heading.

    Attributes:
        row: of the problem.
        times: seconds in the free coasts.
        bearing: from the centre of the disc to the end, radians.
    """

    row: Int[np.ndarray, "seeds"]
    times: Float[np.ndarray, "seeds free"]
    bearing: Float[np.ndarray, "seeds"]


def seeds(
    problem: CoastingProblem,
    start: tuple[complex, float],
    goal: GoalRegion,
    ceiling: float,
    rng: np.random.Generator,
) -> tuple[Seeds, dict[float, Seeds]]:
    """Returns the best grid points, and those on the disc's edge.

    Those with any heading, or one inside the limits; and those at which a limit is met, for each limit.

    Args:
        problem: rows with two free coasts or more.
        start: position and heading at time 0.
        goal: where to end.
        ceiling: seconds; slower plans are ignored.
        rng: shifts the grid.
    """
    points, bearing, times = _grid(problem, start, goal, ceiling, rng)
    with np.errstate(invalid="ignore"):
        total = problem.fixed[:, None] + times.sum(axis=-1)
    total = np.where((times >= 0).all(axis=-1) & (total <= (1 + STEEPEST) * ceiling), total, inf)
    free = _cheapest(times, total, bearing)
    if goal.heading is None:
        return free, {}
    clean = np.where(np.isfinite(total)[..., None], times, 0.0)
    heading = np.stack([fly(problem, one, start).heading for one in clean])
    outside = np.abs(wrapped(heading - goal.heading)) > goal.width
    inside = _cheapest(times, np.where(outside, inf, total), bearing)
    limits = {}
    for side in (-1.0, 1.0) if goal.width > 0 else (0.0,):
        limit = goal.heading + side * goal.width
        off = np.where(np.isfinite(total), wrapped(heading - limit), np.nan)
        limits[limit] = _crossing(times, total, off, bearing, points)
    return _both(free, inside), limits


def _grid(
    problem: CoastingProblem,
    start: tuple[complex, float],
    goal: GoalRegion,
    ceiling: float,
    rng: np.random.Generator,
) -> tuple[int, Float[np.ndarray, "samples"], Float[np.ndarray, "2 rows samples free"]]:
    """Returns grid points along lines, with edge bearings and times."""
    others, edge = problem.free - 2, int(goal.radius > 0)
    dimensions = others + edge
    along = POINTS[min(dimensions, len(POINTS) - 1)]
    lines = kronecker(max(LINES[min(dimensions, len(LINES) - 1)], 1), max(dimensions - 1, 0), rng)
    line = (np.arange(along) + rng.random()) / along
    across = np.repeat(lines, along, axis=0)
    inner = np.tile(line, len(lines))[:, None]
    # The last of the other coasts runs along the lines; without one, the bearing.
    cube = np.column_stack([across[:, edge:], inner]) if others else np.zeros((len(inner), 0))
    turn = across[:, 0] if others and edge else inner[:, 0]
    bearing = 2 * pi * turn if edge else np.zeros(len(inner))
    horizons = horizon(problem, start, goal, ceiling)
    before = _spread(problem, cube, horizons)
    target = np.broadcast_to(
        goal.centre + goal.radius * np.exp(1j * bearing), (len(problem.walk), len(bearing))
    )
    pairs = last_two_times(problem, before, target, start, float(horizons.max(initial=1e-300)))
    times = np.concatenate([np.broadcast_to(before, (2, *before.shape)), pairs], axis=-1)
    return along, bearing, times


def kronecker(count: int, dimensions: int, rng: np.random.Generator) -> Float[np.ndarray, "count dims"]:
    """Returns points that fill the unit cube evenly, shifted at random."""
    root = 1.0
    for _ in range(60):
        root = (1 + root) ** (1 / (dimensions + 1))
    steps = root ** -np.arange(1.0, dimensions + 1)
    shift = rng.random(dimensions)
    return np.mod(shift + steps * np.arange(count)[:, None], 1.0)


def horizon(
    problem: CoastingProblem, start: tuple[complex, float], goal: GoalRegion, ceiling: float
) -> Float[np.ndarray, "rows free"]:
    """Returns upper limits in seconds for each coast."""
    speed, rate = np.abs(problem.velocity), np.abs(problem.rate)
    base = abs(goal.centre - start[0]) + goal.radius + np.abs(problem.gap).sum(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        across = np.where(rate > 0, 2 * speed / rate, 0.0)
        reach = base + np.minimum(across, 4 * base).sum(axis=1, keepdims=True)
        seconds = np.where(speed > 0, reach / np.where(speed > 0, speed, 1.0), 0.0)
        full = np.where(rate > 0, 2 * pi / np.where(rate > 0, rate, 1.0), np.inf)
    # With a ceiling every turn may be a full one; without, one that hardly bends is no longer than a line.
    bends = rate * np.minimum(seconds, 1e300) > (0.0 if ceiling < inf else 1e-2)
    seconds = np.where((speed > 0) & ~bends, np.minimum(seconds, full), np.where(rate > 0, full, seconds))
    return np.minimum(seconds, np.maximum(ceiling - problem.fixed, 0.0)[:, None])


def _spread(
    problem: CoastingProblem, points: Float[np.ndarray, "samples others"], longest: Float[np.ndarray, "r f"]
) -> Float[np.ndarray, "rows samples others"]:
    """Returns times of the first coasts: turns uniform, straights denser near zero."""
    others = points.shape[1]
    most = longest[:, None, :others]
    straight = (np.abs(problem.rate[:, :others]) * longest[:, :others] < 0.5)[:, None]
    return most * np.where(straight, points**1.5, points)


def _cheapest(
    times: Float[np.ndarray, "2 rows samples free"],
    total: Float[np.ndarray, "2 rows samples"],
    bearing: Float[np.ndarray, "samples"],
) -> Seeds:
    """Returns the cheapest point of each grid part and solution."""
    samples = total.shape[2]
    chosen = []
    for part in np.array_split(np.arange(samples), min(BINS, samples)):
        for branch in range(2):
            place = part[np.argmin(total[branch][:, part], axis=1)]
            rows = np.flatnonzero(np.isfinite(total[branch, np.arange(len(place)), place]))
            chosen.append(Seeds(rows, times[branch, rows, place[rows]], bearing[place[rows]]))
    return _both(*chosen)


def _crossing(
    times: Float[np.ndarray, "2 rows samples free"],
    total: Float[np.ndarray, "2 rows samples"],
    off: Float[np.ndarray, "2 rows samples"],
    bearing: Float[np.ndarray, "samples"],
    along: int,
) -> Seeds:
    """Returns the cheapest points between which a heading crosses its limit."""
    if along == 1:
        return _cheapest(times, total, bearing)
    shape = (*off.shape[:2], -1, along)
    grid = off.reshape(shape)
    one, two = grid[..., :-1], grid[..., 1:]
    passes = (one * two <= 0) & (np.abs(one - two) < pi)
    share = np.where(passes, one / np.where(passes & (one != two), one - two, 1.0), 0.0)
    # Where no solution is beyond, the limit may be met between.
    ends, begins = np.isnan(two) & (np.abs(one) < NEAR), np.isnan(one) & (np.abs(two) < NEAR)
    # Where it is touched, neighbours are further away on the same side.
    dip = np.abs(grid) < NEAR
    dip[..., 1:] &= ~(np.abs(grid[..., :-1]) < np.abs(grid[..., 1:]))
    dip[..., :-1] &= ~(np.abs(grid[..., 1:]) < np.abs(grid[..., :-1]))
    ends |= dip[..., :-1] & ~passes & ~begins
    share = np.where(begins, 1.0, share)
    price = total.reshape(shape)
    price = np.where(begins, price[..., 1:], np.where(passes | ends, price[..., :-1], inf))
    cost = price.reshape(*off.shape[:2], -1)
    count = min(CROSSINGS, cost.shape[2])
    place = np.argpartition(cost, count - 1, axis=2)[..., :count]
    branch, row, chosen = (one.ravel() for one in _indices(place))
    good = np.isfinite(cost[branch, row, chosen])
    branch, row, chosen = branch[good], row[good], chosen[good]
    line, step = np.divmod(chosen, along - 1)
    first = line * along + step
    weight = share.reshape(cost.shape)[branch, row, chosen][:, None]
    before, after = times[branch, row, first], times[branch, row, first + 1]
    after = np.where(np.isfinite(after), after, before)
    before = np.where(np.isfinite(before), before, after)
    mixed = before + weight * (after - before)
    # A time that starts anew after a full turn is not between the two.
    most = 0.5 * (np.abs(after) + np.abs(before)) + 0.05 * cost[branch, row, chosen][:, None]
    jumps = np.abs(after - before) > most
    held = np.where(jumps, np.where(weight < 0.5, before, after), mixed)
    turn = bearing[first] + weight[:, 0] * wrapped(bearing[first + 1] - bearing[first])
    return Seeds(row, held, turn)


def _indices(place: Int[np.ndarray, "2 rows n"]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    branch, row, _ = (np.asarray(one) for one in np.indices(place.shape))
    return branch, row, np.asarray(place)


def _both(*parts: Seeds) -> Seeds:
    return Seeds(
        np.concatenate([one.row for one in parts]),
        np.concatenate([one.times for one in parts]),
        np.concatenate([one.bearing for one in parts]),
    )
