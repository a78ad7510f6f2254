"""Coasting times on dense grids: the last two coasts solved exactly for each point of the others."""

from dataclasses import dataclass
from math import pi

import numpy as np
from jaxtyping import Complex, Float, Int

from .coasting_flow import fly
from .coasting_problem import CoastingProblem
from .goal_region import GoalRegion
from .two_coasts import last_two_times

POINTS = (1, 64, 256, 512, 768)
"""Points of a grid of so many dimensions."""

BINS = 4
"""Parts of a grid of which each gives its best point, for each of the two solutions."""

STEEPEST = 0.25
"""Share by which a point may cost more than what is sought, to be worth a closer look."""


@dataclass(frozen=True, slots=True, eq=False)
class Seeds:
    """Times that end on the edge of the disc, or nearly at a wanted heading.

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
) -> Seeds:
    """Returns the best points of a grid over all coasts but two, and over the edge of the disc.

    Args:
        problem: rows with two free coasts or more.
        start: position and heading at time 0.
        goal: where to end.
        ceiling: seconds; slower plans are of no interest.
        rng: shifts the grid.
    """
    others, edge = problem.free - 2, int(goal.radius > 0)
    points = kronecker(POINTS[min(others + edge, len(POINTS) - 1)], others + edge, rng)
    horizons = horizon(problem, start, goal, ceiling)
    before = _spread(problem, points[:, :others], horizons)
    bearing = 2 * pi * points[:, others] if edge else np.zeros(len(points))
    target = np.broadcast_to(
        goal.centre + goal.radius * np.exp(1j * bearing), (len(problem.walk), len(points))
    )
    longest = float(horizons.max(initial=1e-300))
    pairs = last_two_times(problem, before, target, start, longest)
    times = np.concatenate([np.broadcast_to(before, (2, *before.shape)), pairs], axis=-1)
    merit = np.stack([_merit(problem, one, start, goal) for one in times])
    return _best(problem, times, merit, bearing, ceiling)


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
    """Returns seconds that each coast may take: what the ceiling leaves, or what covers the way."""
    speed, rate = np.abs(problem.velocity), np.abs(problem.rate)
    base = abs(goal.centre - start[0]) + goal.radius + np.abs(problem.gap).sum(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        across = np.where(rate > 0, 2 * speed / rate, 0.0)
        reach = base + np.minimum(across, 4 * base).sum(axis=1, keepdims=True)
        seconds = np.where(speed > 0, reach / np.where(speed > 0, speed, 1.0), 0.0)
        full = np.where(rate > 0, 2 * pi / np.where(rate > 0, rate, 1.0), np.inf)
    seconds = np.where(speed > 0, np.minimum(seconds, full), full)
    # A turn that hardly bends is as long as a straight line may be; any other may be a full one.
    seconds = np.where(rate * seconds > 1.0, full, seconds)
    return np.minimum(seconds, np.maximum(ceiling - problem.fixed, 0.0)[:, None])


def _spread(
    problem: CoastingProblem, points: Float[np.ndarray, "samples others"], longest: Float[np.ndarray, "r f"]
) -> Float[np.ndarray, "rows samples others"]:
    """Returns times of the first coasts: turns evenly, straight lines denser where short."""
    others = points.shape[1]
    most = longest[:, None, :others]
    straight = (np.abs(problem.rate[:, :others]) * longest[:, :others] < 0.5)[:, None]
    return most * np.where(straight, points**1.5, points)


def _merit(
    problem: CoastingProblem,
    times: Float[np.ndarray, "rows samples free"],
    start: tuple[complex, float],
    goal: GoalRegion,
) -> Float[np.ndarray, "rows samples"]:
    """Returns seconds, and those that a heading outside its limits would need; infinite without times."""
    total = problem.fixed[:, None] + times.sum(axis=-1)
    possible = np.isfinite(total) & (times >= 0).all(axis=-1)
    if goal.heading is not None:
        clean = np.where(possible[..., None], times, 0.0)
        excess = np.maximum(goal.heading_beyond(fly(problem, clean, start)), 0.0)
        fastest = np.abs(problem.rate).max(axis=1, initial=0.0)[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            total = total + np.where(excess > 1e-12, excess / fastest, 0.0)
    return np.where(possible & np.isfinite(total), total, np.inf)


def _best(
    problem: CoastingProblem,
    times: Float[np.ndarray, "2 rows samples free"],
    merit: Float[np.ndarray, "2 rows samples"],
    bearing: Float[np.ndarray, "samples"],
    ceiling: float,
) -> Seeds:
    """Returns the best point of each part of the grid and each solution, where it is good enough."""
    samples = merit.shape[2]
    chosen = []
    for part in np.array_split(np.arange(samples), min(BINS, samples)):
        for branch in range(2):
            place = part[np.argmin(merit[branch][:, part], axis=1)]
            rows = np.arange(len(place))
            good = merit[branch, rows, place] <= (1 + STEEPEST) * ceiling
            good &= np.isfinite(merit[branch, rows, place])
            chosen.append((rows[good], times[branch, rows[good], place[good]], bearing[place[good]]))
    return Seeds(
        np.concatenate([one[0] for one in chosen]),
        np.concatenate([one[1] for one in chosen]).reshape(-1, problem.free),
        np.concatenate([one[2] for one in chosen]),
    )


def on_edge(seed: Seeds, goal: GoalRegion) -> Complex[np.ndarray, "seeds"]:
    """Returns the points of the disc's edge at which seeds aim."""
    return goal.centre + goal.radius * np.exp(1j * seed.bearing)
