"""The coasting times of one walk at one uncertainty level: stated in CasADi, then solved.

Minimise the sum of the coasting times, none negative, so that the walk ends at the goal: exactly where the
tolerance is 0, else inside the tolerance disc; with the heading wanted there, if one is (thesis, Problem 6.1
for one sequence; 6.2 for one sequence and one gamma).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import inf
from typing import Any

import casadi
import numpy as np

from flight.mission.mission import Mission
from flight.se2 import wrap_angle
from planner.walks.answer import Times
from planner.walks.goal import goal_seen, reaches, wants_heading
from planner.walks.kinematics import Motion
from planner.walks.symbolic_motion import symbolic_motion

from .batch import Batch

SOLVER_MARGIN = 1e-7
"""Share of a tolerance by which a statement is stricter than the check: solvers relax bounds by 1e-8."""

HEADING_MARGIN = 3e-8
"""Share of a heading, or radians where that is below one, for the same reason."""

ROUNDS_TO_MEET = 3
"""Of Newton's method, from where a solver stopped."""

_QUIET: dict[str, Any] = {"print_time": False, "error_on_fail": False, "show_eval_warnings": False}

_OPTIONS: dict[str, dict[str, Any]] = {
    "sqpmethod": {
        "qpsol": "qrqp",
        "qpsol_options": {
            "print_iter": False,
            "print_header": False,
            "print_info": False,
            "error_on_fail": False,
        },
        "convexify_strategy": "regularize",
        "max_iter": 60,
        "print_header": False,
        "print_iteration": False,
        "print_status": False,
    },
    "ipopt": {"ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-10, "max_iter": 200}},
}


@dataclass(frozen=True, slots=True)
class Statement:
    """The problem for walks of one length, ready for any CasADi solver.

    Attributes:
        problem: variables `x` (coasting times in seconds), parameters `p` (velocities, displacements, start,
            goal, tolerance), objective `f`, constraints `g` (what ends where).
        exact: whether `g` begins with the two components of the miss in metres, to be 0; else it begins with
            the square of the miss in tolerances.
    """

    problem: dict[str, casadi.SX]
    exact: bool


@cache
def state(trims: int, *, exact: bool, heading: bool) -> Statement:
    """States the problem for walks of so many trims.

    Args:
        trims: length of the walk.
        exact: whether the goal is to be met exactly, or to within a tolerance.
        heading: whether the heading at the end is constrained: `g` then ends with it, in radians.
    """
    walk = symbolic_motion(trims)
    goal, tolerance = casadi.SX.sym("goal", 2), casadi.SX.sym("tolerance")
    miss = walk.end[:2] - goal
    constraints = [miss if exact else casadi.dot(miss, miss) / tolerance**2]
    if heading:
        constraints.append(walk.end[2])
    problem = {
        "x": walk.coasting_times,
        "p": casadi.vertcat(
            casadi.vec(walk.velocities), casadi.vec(walk.displacements), walk.start, goal, tolerance
        ),
        "f": casadi.sum1(walk.coasting_times),
        "g": casadi.vertcat(*constraints),
    }
    return Statement(problem, exact)


@cache
def solver(trims: int, *, exact: bool, heading: bool, name: str = "ipopt") -> casadi.Function:
    """Builds a solver for walks of so many trims, once.

    Args:
        trims: as for `state`.
        exact: as for `state`.
        heading: as for `state`.
        name: `ipopt`, which found an answer nearly wherever there is one, or `sqpmethod`, ten times as fast,
            which from one start in six finds none. (`fatrop` is as fast, but from some it never returns.)
    """
    statement = state(trims, exact=exact, heading=heading)
    return casadi.nlpsol(f"coasting_{trims}", name, statement.problem, {**_QUIET, **_OPTIONS[name]})


def solve(
    motion: Motion, mission: Mission, start_times: Sequence[float], *, solver_name: str = "ipopt"
) -> Times | None:
    """Returns locally optimal coasting times, or None where the solver found none that reach the goal.

    Args:
        motion: the walk at one uncertainty level.
        mission: from where to where, and how exactly.
        start_times: where to start from, seconds; its heading at the end decides which full turn is meant.
        solver_name: as for `solver`.
    """
    trims = len(motion.velocities)
    exact, heading = mission.tolerance == 0, wants_heading(mission)
    if trims < 2 * exact + (heading and mission.heading_tolerance == 0):
        # More equations than times: solvers refuse it, closed forms have found what there is.
        return None
    run = solver(trims, exact=exact, heading=heading, name=solver_name)
    low, high = ([0.0, 0.0], [0.0, 0.0]) if exact else ([-inf], [(1 - SOLVER_MARGIN) ** 2])
    if heading:
        nearest = _nearest_turn(motion.end(mission.start, start_times).heading, mission)
        margin = HEADING_MARGIN * max(1.0, abs(nearest) + mission.heading_tolerance)
        half_width = max(mission.heading_tolerance - margin, 0.0)
        low, high = [*low, nearest - half_width], [*high, nearest + half_width]
    answer = run(x0=list(start_times), p=_parameters(motion, mission), lbx=0, ubx=inf, lbg=low, ubg=high)
    times = _met(motion, mission, [max(float(time), 0.0) for time in answer["x"].nonzeros()])
    return times if reaches(motion.end(mission.start, times), mission) else None


def _met(motion: Motion, mission: Mission, times: list[float]) -> Times:
    """Returns times moved by least to what is to be met exactly: solvers stop where it is nearly met."""
    batch, start = Batch.of([motion]), mission.start
    goal, exact_heading = goal_seen(mission), wants_heading(mission) and mission.heading_tolerance == 0
    known = np.array([times])
    held = known[0] > 0
    for _ in range(ROUNDS_TO_MEET if mission.tolerance == 0 or exact_heading else 0):
        end, heading = batch.end(known)
        moves, rows, off = batch.end_velocities(known)[0] * held, [], []
        if mission.tolerance == 0:
            rows, off = [moves.real, moves.imag], [(end[0] - goal).real, (end[0] - goal).imag]
        if exact_heading:
            rows.append(batch.rate[0] * held)
            off.append(wrap_angle(heading[0] + start.heading - (mission.goal_heading or 0.0)))
        known[0] -= np.linalg.lstsq(np.array(rows), np.array(off), rcond=None)[0]
    return tuple(np.maximum(known[0], 0.0).tolist())


def _nearest_turn(heading: float, mission: Mission) -> float:
    """Returns the wanted heading with the full turns that bring it nearest to a heading."""
    assert mission.goal_heading is not None
    return heading + wrap_angle(mission.goal_heading - heading)


def _parameters(motion: Motion, mission: Mission) -> list[float]:
    start = mission.start
    return [
        *(value for v in motion.velocities for value in (v.forward, v.side, v.yaw_rate)),
        *(value for d in motion.displacements for value in (d.x, d.y, d.heading)),
        *(start.x, start.y, start.heading),
        *mission.goal,
        mission.tolerance,
    ]
