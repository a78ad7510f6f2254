"""Coasting times polished by Newton's method on the optimality conditions."""

import numpy as np
from jaxtyping import Float

from .coasting_flow import end_velocities
from .coasting_problem import CoastingProblem
from .goal_region import GoalRegion, wrapped

STEPS = 12
"""Of Newton's method."""

RESTORING_STEPS = 3
"""Steps that return an end to the edge, to rounding."""

LONGEST_TURN = 0.7
"""Radians that one step may change a coast by, and the bearing of the end."""

LONGEST_STEP = 0.5
"""Share of the seconds in all that one step may change a coast by."""

SINGULAR = 1e-11
"""Added to the diagonal against singularity for families of equal times."""

Rows = Float[np.ndarray, "rows"]
Times = Float[np.ndarray, "rows free"]


def polished(
    problem: CoastingProblem,
    times: Times,
    bearing: Rows,
    start: tuple[complex, float],
    goal: GoalRegion,
    limit: float | None,
) -> Times:
    """Returns nearby stationary times on the edge of the disc.

    Units are such that distances and times are of the order of 1. The end is not judged here.

    Args:
        problem: the walks, a row for each set of times.
        times: to start from, in seconds.
        bearing: from the centre of the disc to the end, radians.
        start: position and heading at time 0.
        goal: with a radius of 0 the end stays at its centre.
        limit: heading that the end keeps; None leaves it free.
    """
    free, edge, bound = problem.free, int(goal.radius > 0), int(limit is not None)
    rows, size = len(times), free + edge + 2 + bound
    worth = _multipliers(problem, times, bearing, start, edge, bound)
    for _ in range(STEPS):
        ends, moves = end_velocities(problem, times, start)
        normal = np.exp(1j * bearing)
        vector = worth[:, 0] + 1j * worth[:, 1]
        matrix, error = np.zeros((rows, size, size)), np.zeros((rows, size))
        pull = np.conj(vector)[:, None] * moves
        for one in range(free):
            for two in range(one, free):
                bend = (1j * problem.rate[:, one] * pull[:, two]).real
                matrix[:, one, two] = matrix[:, two, one] = bend
        first = free + edge
        error[:, :free] = 1 + pull.real
        matrix[:, :free, first], matrix[:, :free, first + 1] = moves.real, moves.imag
        off = ends.position - goal.centre - goal.radius * normal
        if edge:
            tangent = 1j * goal.radius * normal
            error[:, free] = -(np.conj(vector) * tangent).real
            matrix[:, free, free] = (np.conj(vector) * goal.radius * normal).real
            matrix[:, free, first], matrix[:, free, first + 1] = -tangent.real, -tangent.imag
        if limit is not None:
            error[:, :free] += worth[:, 2:] * problem.rate
            matrix[:, :free, first + 2] = problem.rate
            error[:, first + 2] = wrapped(ends.heading - limit)
        error[:, first], error[:, first + 1] = off.real, off.imag
        matrix[:, first:, :first] = matrix[:, :first, first:].transpose(0, 2, 1)
        step = _solved(matrix, error)
        step *= _shortened(step, problem, times, edge)[:, None]
        times, worth = times + step[:, :free], worth + step[:, first:]
        if edge:
            bearing = bearing + step[:, free]
    return _restored(problem, times, start, goal, limit)


def _multipliers(
    problem: CoastingProblem, times: Times, bearing: Rows, start: tuple[complex, float], edge: int, bound: int
) -> Float[np.ndarray, "rows multipliers"]:
    """Returns the multipliers that violate the conditions least."""
    _, moves = end_velocities(problem, times, start)
    columns = [moves.real, moves.imag] + ([problem.rate] if bound else [])
    wanted = -np.ones(times.shape)
    if edge:
        tangent = np.stack([-np.sin(bearing), np.cos(bearing)] + [0 * bearing] * bound, axis=1)
        columns = [np.column_stack([one, tangent[:, place]]) for place, one in enumerate(columns)]
        wanted = np.column_stack([wanted, 0 * bearing])
    slopes = np.stack(columns, axis=2)
    square = np.einsum("rki,rkj->rij", slopes, slopes)
    return _solved(square, -np.einsum("rki,rk->ri", slopes, wanted))


def _solved(
    matrix: Float[np.ndarray, "rows n n"], error: Float[np.ndarray, "rows n"]
) -> Float[np.ndarray, "rows n"]:
    """Returns the Newton step; 0 where numbers have diverged."""
    size = matrix.shape[1]
    usable = np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(error).all(axis=1)
    matrix = np.where(usable[:, None, None], matrix, np.eye(size))
    error = np.where(usable[:, None], error, 0.0)
    # Of unequal size, so that no sum of two columns becomes 0.
    ridge = SINGULAR * np.diag(1 + 0.3 * np.arange(size))
    while True:
        try:
            return -np.linalg.solve(matrix + ridge, error[..., None])[..., 0]
        except np.linalg.LinAlgError:
            ridge = 7 * ridge


def _shortened(step: Float[np.ndarray, "r n"], problem: CoastingProblem, times: Times, edge: int) -> Rows:
    free = problem.free
    most = 0.1 + LONGEST_STEP * np.abs(times).sum(axis=1)
    share = np.abs(step[:, :free]).max(axis=1) / most
    share = np.maximum(share, np.abs(step[:, :free] * problem.rate).max(axis=1) / LONGEST_TURN)
    if edge:
        share = np.maximum(share, np.abs(step[:, free]) / LONGEST_TURN)
    return np.asarray(1 / np.maximum(share, 1.0))


def _restored(
    problem: CoastingProblem,
    times: Times,
    start: tuple[complex, float],
    goal: GoalRegion,
    limit: float | None,
) -> Times:
    """Returns times corrected to the edge and the kept heading."""
    for _ in range(RESTORING_STEPS):
        times = np.where(times > 0, times, 0.0)
        ends, moves = end_velocities(problem, times, start)
        moves = np.where(times > 0, moves, 0.0)
        off = ends.position - goal.centre
        if goal.radius > 0:
            size = np.maximum(np.abs(off), 1e-300)
            lines = [(np.conj(off / size)[:, None] * moves).real]
            errors = [size - goal.radius]
        else:
            lines, errors = [moves.real, moves.imag], [off.real, off.imag]
        if limit is not None:
            lines.append(np.where(times > 0, problem.rate, 0.0))
            errors.append(wrapped(ends.heading - limit))
        slopes, error = np.stack(lines, axis=1), np.stack(errors, axis=1)
        usable = np.isfinite(slopes).all(axis=(1, 2)) & np.isfinite(error).all(axis=1)
        slopes[~usable], error[~usable] = 0.0, 0.0
        square = np.einsum("rik,rjk->rij", slopes, slopes)
        size = np.maximum(np.trace(square, axis1=1, axis2=2), 1e-30)
        square = square + 1e-15 * size[:, None, None] * np.eye(square.shape[1])
        step = np.linalg.solve(square, error[..., None])[..., 0]
        times = times - np.einsum("rik,ri->rk", slopes, step)
    return times
