"""Error of the table of least expected times against Monte Carlo in its own model.

`python -m benchmarks.planning.recourse_error STATES ROLLOUTS SCALE...` solves the table of `gtmax-sim` at
each scale of the errors and flies its own policy from random states, 2 m to 100 m from the goal, by fresh
draws of the law. It shares nothing with the table but the look-ups.
"""

import sys
from time import process_time

import numpy as np
from jaxtyping import Float

from planner.recourse.law import CoastDistribution, ManeuverDistribution, TransitionLaw, transition_law
from planner.recourse.problem import state_problem
from planner.recourse.solve import solve
from planner.recourse.table import CostTable
from scenarios.find import find_library

TOLERANCE = 0.9144
LIMIT_MEAN, LIMIT_SHARE, LIMIT_TIME = 0.05, 0.03, 0.3
_GIVEN_UP = 600.0
_STEP = 0.1


def fly(
    table: CostTable, law: TransitionLaw, order: dict[int, int], states: np.ndarray, rng: np.random.Generator
) -> Float[np.ndarray, "n"]:
    """Returns the times of flights from states: place of the trim, forward and side of the goal."""
    problem, first = table.problem, table.problem.first
    trims, goals = states[:, 0].astype(int), states[:, 1:].copy()
    times, flying = np.zeros(len(states)), np.arange(len(states))
    while len(flying):
        chosen = first[trims[flying]] + table.action_costs(trims[flying], goals[flying]).argmin(axis=1)
        done = np.zeros(len(states), dtype=bool)
        for number in np.unique(chosen):
            rows, action = flying[chosen == number], problem.actions[number]
            if action.maneuver is None:
                path, turn = _coast(law.trims[action.trim], action.mean, len(rows), rng)
                duration = np.full(len(rows), action.mean)
            else:
                path, turn, duration = _maneuver(law.maneuvers[order[action.maneuver]], len(rows), rng)
            share = _first_passage(path, goals[rows], problem.tolerance)
            times[rows] += np.minimum(share, 1.0) * duration
            away = goals[rows] - path[:, -1]
            heading = np.exp(-1j * turn) * (away[:, 0] + 1j * away[:, 1])
            goals[rows] = np.column_stack([heading.real, heading.imag])
            trims[rows] = action.to
            done[rows] = (share <= 1.0) | (np.abs(heading) <= problem.tolerance)
        flying = flying[~done[flying] & (times[flying] < _GIVEN_UP)]
    return times


def _coast(
    law: CoastDistribution, duration: float, count: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    velocity = rng.multivariate_normal(law.mean, law.averaged(duration), count)
    time = np.linspace(0.0, duration, round(duration / _STEP) + 1)
    turned = velocity[:, 2:3] * time
    # The integral of a turning velocity, as complex numbers, by its closed form.
    arc = time * np.sinc(turned / (2 * np.pi)) * np.exp(0.5j * turned)
    path = (velocity[:, 0:1] + 1j * velocity[:, 1:2]) * arc
    return np.stack([path.real, path.imag], axis=2), velocity[:, 2] * duration


def _maneuver(
    law: ManeuverDistribution, count: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    values = rng.multivariate_normal(law.mean, law.covariance, count)
    share = np.linspace(0.0, 1.0, len(law.path))[None, :, None]
    path = law.path[None, :, :2] + share * (values[:, None, 1:3] - law.mean[1:3])
    return path, values[:, 3], np.maximum(values[:, 0], 0.0)


def _first_passage(path: np.ndarray, goals: np.ndarray, tolerance: float) -> Float[np.ndarray, "n"]:
    """Returns the share of each path at which it is inside first; 2 where never."""
    offset, way = path[:, :-1] - goals[:, None], np.diff(path, axis=1)
    a, b = (way**2).sum(axis=2), (offset * way).sum(axis=2)
    c = (offset**2).sum(axis=2) - tolerance**2
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    enters = np.where((b < 0) & (b * b >= a * c) & (a > 0), (-b - root) / np.where(a > 0, a, 1.0), 2.0)
    enters = np.where(c <= 0, 0.0, enters)
    hit = enters <= 1
    piece = hit.argmax(axis=1)
    share = (piece + enters[np.arange(len(piece)), piece]) / way.shape[1]
    return np.where(hit.any(axis=1), share, 2.0)


def main(states: int, rollouts: int, scales: list[float]) -> bool:
    """Prints the errors at each scale; returns whether all are within the limits."""
    library = find_library("gtmax-sim")
    order = {one.id: place for place, one in enumerate(library.maneuvers)}
    passed = True
    for scale in scales:
        began = process_time()
        problem = state_problem(library, tolerance=TOLERANCE, error_scale=scale)
        solution = solve(problem)
        table = CostTable(problem, solution.values, solution.gap)
        spent, rng = process_time() - began, np.random.default_rng(11)
        distance, bearing = rng.uniform(2.0, 100.0, states), rng.uniform(-np.pi, np.pi, states)
        begin = np.column_stack(
            [
                rng.integers(0, len(problem.trims), states),
                distance * np.cos(bearing),
                distance * np.sin(bearing),
            ]
        )
        law = transition_law(library, error_scale=scale)
        flown = fly(table, law, order, np.repeat(begin, rollouts, axis=0), rng).reshape(states, rollouts)
        mean = flown.mean(axis=1)
        error = table.times(begin[:, 0].astype(int), begin[:, 1:]) - mean
        chance = float(np.sqrt((flown.var(axis=1) / rollouts).sum()) / states)
        within = float(np.mean(np.abs(error) <= np.maximum(LIMIT_TIME, LIMIT_SHARE * mean)))
        print(
            f"errors x {scale:g}: mean error {error.mean():+.4f} s (standard error {chance:.4f} s), "
            f"{100 * within:.1f} % of states within 3 % or 0.3 s, {np.mean(flown >= _GIVEN_UP):.2g} never "
            f"arrive; solved in {spent:.1f} s of the processor, {solution.sweeps} sweeps, "
            f"gap {solution.gap:.3f} s"
        )
        passed = passed and abs(error.mean()) <= LIMIT_MEAN and within >= 0.9
    return passed


if __name__ == "__main__":
    raise SystemExit(0 if main(int(sys.argv[1]), int(sys.argv[2]), list(map(float, sys.argv[3:]))) else 1)
