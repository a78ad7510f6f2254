"""Least worst-case time by brute force: Newton's method from many starts.

It shares the equations of motion with the proofs, and nothing with the search: random sets of nonzero times,
random values, first moved to the goal, then Newton's method on the optimality conditions. A solution counts
only if its end is at the goal.
"""

from math import inf

import numpy as np
from jaxtyping import Bool, Complex, Int

from flight.automaton.library import Library
from flight.mission.mission import Mission
from planner.proof.dual_bound import PerBox, PerTrim, WalkProblems
from planner.walks.kinematics import walk_motion
from planner.walks.walk import walks

MOST_FREE = 4
"""Most nonzero times."""

TIME_SCALES = (1.0, 3.0, 6.0, 15.0, 60.0)
"""Seconds around which random times are."""

TO_THE_GOAL, TO_THE_OPTIMUM = 5, 12
"""Steps of Newton's method."""

LONGEST_STEP = 5.0
"""Seconds that one step may change a time by."""

RUN_AWAY = 1e6
"""Magnitude above which a start has diverged."""

MEETS = 1e-7
"""Metres and radians, beyond the tolerance, at which a goal counts as reached."""


def brute_force(
    library: Library, mission: Mission, gammas: tuple[float, ...], rng: np.random.Generator, *, starts: int
) -> float:
    """Returns the least worst-case time found, or infinity.

    Args:
        library: the primitives.
        mission: from where to where.
        gammas: the uncertainty levels.
        rng: of the starts.
        starts: for every walk at every level.
    """
    every = walks(library, mission.start_trim, max_trims=mission.max_trims, goal_trim=mission.goal_trim)
    if not every:
        return inf
    worst = np.zeros(len(every))
    for gamma in gammas:
        problems = WalkProblems.of([walk_motion(library, walk, gamma) for walk in every], mission)
        worst = np.maximum(worst, least_costs(problems, rng, starts))
    return float(worst.min())


def least_costs(problems: WalkProblems, rng: np.random.Generator, starts: int) -> PerBox:
    """Returns the least cost found for each walk, or infinity."""
    count = len(problems.rate)
    row = np.repeat(np.arange(count), starts)
    many = problems.take(row)
    useful = many.longest > 0
    order = np.argsort(rng.random(useful.shape) - useful, axis=1)
    rank = np.argsort(order, axis=1)
    free = (rank < rng.integers(0, MOST_FREE + 1, (len(row), 1))) & useful
    scale = rng.choice(TIME_SCALES, (len(row), 1))
    times = np.where(free, np.minimum(scale * rng.exponential(1.0, free.shape), many.longest), 0.0)
    # With a heading wanted: free at the end, or at one of its limits.
    side = rng.integers(-1, 2, len(row)) if problems.heading is not None else None
    best = np.full(count, inf)
    for _ in range(TO_THE_GOAL):
        times = np.where(free, np.clip(times - _to_the_goal(many, times, free, side), 0, many.longest), 0.0)
    np.minimum.at(best, row, _costs(many, times))
    multiplier = _multiplier(many, times, free)
    bound = np.zeros(len(row))
    for _ in range(TO_THE_OPTIMUM):
        step, along, turning = _to_the_optimum(many, times, (multiplier, bound), free, side)
        times = np.where(free, times + np.clip(step, -LONGEST_STEP, LONGEST_STEP), 0.0)
        multiplier, bound = multiplier + along, bound + turning
    np.minimum.at(best, row, _costs(many, np.where(np.abs(times) < 1e-9, 0.0, times)))
    return best


def _off(problems: WalkProblems, turned: PerBox, side: Int[np.ndarray, "starts"]) -> PerBox:
    """Returns heading errors from the chosen limit."""
    assert problems.heading is not None
    off = turned + problems.turned - problems.heading - side * problems.heading_tolerance
    nearest: PerBox = off - 2 * np.pi * np.round(off / (2 * np.pi))
    return nearest


def _to_the_goal(
    problems: WalkProblems,
    times: PerTrim,
    free: Bool[np.ndarray, "starts trims"],
    side: Int[np.ndarray, "s"] | None,
) -> PerTrim:
    velocity, end, turned = problems.propagate(times)
    away = end - problems.goal
    size = np.abs(away)
    inside = 0.9 * problems.tolerance
    miss = np.where(size > inside, away * (1 - inside / np.maximum(size, 1e-12)), 0.0)
    rows, wrong = [velocity.real * free, velocity.imag * free], [miss.real, miss.imag]
    if side is not None:
        rows.append(problems.rate * free)
        wrong.append(np.where(side == 0, 0.0, _off(problems, turned, side)))
    matrix, error = np.stack(rows, axis=1), np.stack(wrong, axis=1)
    square = matrix @ matrix.transpose(0, 2, 1) + 1e-9 * np.eye(len(rows))
    step: PerTrim = (matrix.transpose(0, 2, 1) @ np.linalg.solve(square, error[..., None]))[..., 0]
    return step


def _multiplier(
    problems: WalkProblems, times: PerTrim, free: Bool[np.ndarray, "starts trims"]
) -> Complex[np.ndarray, "starts"]:
    """Returns the multiplier vector that best fits the free times' stationarity."""
    velocity, _, _ = problems.propagate(times)
    x, y = velocity.real * free, velocity.imag * free
    square = np.stack([(x * x).sum(1), (x * y).sum(1), (x * y).sum(1), (y * y).sum(1)], axis=1)
    matrix = square.reshape(-1, 2, 2) + 1e-9 * np.eye(2)
    found = np.linalg.solve(matrix, -np.stack([x.sum(1), y.sum(1)], axis=1)[..., None])[..., 0]
    vector: Complex[np.ndarray, "starts"] = found[:, 0] + 1j * found[:, 1]
    return vector


def _to_the_optimum(
    problems: WalkProblems,
    times: PerTrim,
    shadow_prices: tuple[Complex[np.ndarray, "starts"], PerBox],
    free: Bool[np.ndarray, "starts trims"],
    side: Int[np.ndarray, "starts"] | None,
) -> tuple[PerTrim, Complex[np.ndarray, "starts"], PerBox]:
    """Returns a Newton step for times, multiplier vector and heading multiplier."""
    velocity, end, turned = problems.propagate(times)
    multiplier, bound = shadow_prices
    count, trims = times.shape
    size = trims + 3
    matrix, error = np.zeros((count, size, size)), np.zeros((count, size))
    every = np.arange(trims)
    first, last = np.minimum.outer(every, every), np.maximum.outer(every, every)
    bend = (np.conj(multiplier)[:, None, None] * 1j * problems.rate[:, first] * velocity[:, last]).real
    matrix[:, :trims, :trims] = bend * (free[:, :, None] & free[:, None, :])
    matrix[:, every, every] += ~free
    x, y, turn = velocity.real * free, velocity.imag * free, problems.rate * free
    for place, column in enumerate((x, y, turn)):
        matrix[:, :trims, trims + place] = matrix[:, trims + place, :trims] = column
    value = 1 + (np.conj(multiplier)[:, None] * velocity).real + bound[:, None] * problems.rate
    error[:, :trims] = np.where(free, value, 0.0)
    length = np.maximum(np.abs(multiplier), 1e-9)
    unit = multiplier / length
    share = problems.tolerance / length
    matrix[:, trims, trims] = -share * (1 - unit.real**2)
    matrix[:, trims, trims + 1] = matrix[:, trims + 1, trims] = share * unit.real * unit.imag
    matrix[:, trims + 1, trims + 1] = -share * (1 - unit.imag**2)
    miss = end - problems.goal - problems.tolerance * unit
    error[:, trims], error[:, trims + 1] = miss.real, miss.imag
    limited = np.zeros(count, dtype=bool) if side is None else side != 0
    matrix[~limited, trims + 2, :] = matrix[~limited, :, trims + 2] = 0.0
    matrix[~limited, trims + 2, trims + 2] = 1.0
    if side is not None:
        error[:, trims + 2] = np.where(limited, _off(problems, turned, side), 0.0)
    # Diverged rows are left unchanged.
    usable = (np.abs(matrix).max(axis=(1, 2)) < RUN_AWAY) & (np.abs(error).max(axis=1) < RUN_AWAY)
    matrix[~usable], error[~usable] = np.eye(size), 0.0
    step = -np.linalg.solve(matrix + 1e-9 * np.diag(1 + 0.37 * np.arange(size)), error[..., None])[..., 0]
    step = np.clip(np.where(np.isfinite(step), step, 0.0), -1e3, 1e3)
    return step[:, :trims], step[:, trims] + 1j * step[:, trims + 1], step[:, trims + 2]


def _costs(problems: WalkProblems, times: PerTrim) -> PerBox:
    """Returns the costs of times; infinite where they miss the goal."""
    with np.errstate(invalid="ignore", over="ignore"):
        _, end, turned = problems.propagate(times)
        there = np.abs(end - problems.goal) <= problems.tolerance + MEETS
        if problems.heading is not None:
            middle = np.zeros(len(times), dtype=int)
            there &= np.abs(_off(problems, turned, middle)) <= problems.heading_tolerance + MEETS
        there &= (times >= 0).all(axis=1)
    costs: PerBox = np.where(there, problems.fixed + times.sum(axis=1), inf)
    return costs
