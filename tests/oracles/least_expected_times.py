"""Value iteration in NumPy: an oracle for the C code of `planner.recourse`."""

import numpy as np
from jaxtyping import Float

from planner.recourse.grid import RATIO
from planner.recourse.problem import Action, ShortestPathProblem

Values = Float[np.ndarray, "trims levels side side"]


def looked_up(
    problem: ShortestPathProblem, values: Values, trim: int, goals: Float[np.ndarray, "n 2"]
) -> Float[np.ndarray, "n"]:
    """Returns interpolated seconds, of nodes outside the tolerance only."""
    grid, largest = problem.grid, np.abs(goals).max(axis=1)
    level = np.zeros(len(goals), dtype=int)
    for coarser in range(1, grid.levels):
        level[largest > grid.half * grid.step * RATIO ** (coarser - 1)] = coarser
    step = grid.step * RATIO**level
    edge = step * np.where(level == grid.levels - 1, grid.outer, grid.half)
    share = np.minimum(1.0, edge / np.maximum(largest, 1e-9))
    beyond = np.hypot(*goals.T) * (1 - share) / problem.best_speed
    row, column = (share * axis / step + grid.half for axis in goals.T)
    i, j = (np.minimum(place.astype(int), 2 * grid.half - 1) for place in (row, column))
    total, weights = np.zeros(len(goals)), np.zeros(len(goals))
    for node_row, node_column in ((i, j), (i, j + 1), (i + 1, j), (i + 1, j + 1)):
        value = values[trim, level, node_row, node_column].astype(float)
        weight = np.where(value >= 0, (1 - np.abs(row - node_row)) * (1 - np.abs(column - node_column)), 0.0)
        total, weights = total + weight * value, weights + weight
    found = beyond + np.where(weights > 0, total / np.where(weights > 0, weights, 1.0), 0.0)
    inside = problem.ends[trim] & (np.hypot(*goals.T) <= problem.tolerance)
    return np.where(inside, 0.0, found)


def action_cost(
    problem: ShortestPathProblem, values: Values, action: Action, goals: Float[np.ndarray, "n 2"]
) -> Float[np.ndarray, "n"]:
    """Returns the seconds of an action and those left after it, on average."""
    costs = []
    for outcome in range(len(action.duration)):
        duration, (forward, side, cosine, sine) = action.duration[outcome], action.displacement[outcome]
        left = goals - np.array([forward, side])
        after = np.column_stack(
            [cosine * left[:, 0] + sine * left[:, 1], cosine * left[:, 1] - sine * left[:, 0]]
        )
        cost = duration + looked_up(problem, values, action.to, after)
        if action.arrives:
            share = _entry(action.path[outcome], goals, problem.tolerance)
            cost = np.where(share <= 1, duration * share, cost)
        costs.append(cost)
    return np.asarray(np.mean(costs, axis=0))


def _entry(
    path: Float[np.ndarray, "points 2"], goals: Float[np.ndarray, "n 2"], tolerance: float
) -> Float[np.ndarray, "n"]:
    """Returns the share of a polyline at which it first comes within the tolerance; 2 where never."""
    share = np.full(len(goals), 2.0)
    pieces = len(path) - 1
    for piece in range(pieces - 1, -1, -1):
        way, offset = path[piece + 1] - path[piece], path[piece] - goals
        a, b = way @ way, offset @ way
        c = (offset**2).sum(axis=1) - tolerance**2
        root = b * b - a * c
        with np.errstate(invalid="ignore", divide="ignore"):
            first = (-b - np.sqrt(root)) / a
        hit = (root >= 0) & (first >= 0) & (first <= 1)
        share = np.where(hit, (piece + first) / pieces, share)
        share = np.where(c <= 0, piece / pieces, share)
    return share


def improved(problem: ShortestPathProblem, values: Values) -> Values:
    """Returns the values after one sweep over all actions from the values before."""
    grid, made = problem.grid, values.copy()
    for trim in range(len(problem.trims)):
        for level in range(grid.levels):
            nodes = grid.used(level) & (values[trim, level] >= 0)
            goals = np.column_stack([axis[nodes] for axis in grid.positions(level)])
            costs = [
                action_cost(problem, values, one, goals)
                for one in problem.actions
                if one.trim == trim and level <= one.coarsest
            ]
            made[trim, level][nodes] = np.min(costs, axis=0)
    return made
