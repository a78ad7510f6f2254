"""Coasting times of one walk by CasADi and IPOPT, for comparison.

Minimise the sum of the coasting times, none negative, so that the walk ends at the goal: exactly where the
tolerance is 0, else within it; with the heading wanted there, if one is (thesis, Problem 6.1 for one walk).
"""

from collections.abc import Sequence
from functools import cache
from math import inf
from typing import Any

import casadi

from flight.mission.mission import Mission
from flight.se2 import wrap_angle
from planner.walks.goal_condition import reaches_goal, wants_heading
from planner.walks.kinematics import WalkMotion
from planner.walks.search_result import Times

MARGIN = 1e-7
"""Share of a tolerance by which the statement is stricter than the check: IPOPT relaxes bounds by 1e-8."""

HEADING_MARGIN = 3e-8
"""Share of a heading, or radians where that is below one, for the same reason."""

OPTIONS: dict[str, Any] = {
    "print_time": False,
    "error_on_fail": False,
    "show_eval_warnings": False,
    "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-10, "max_iter": 200},
}


def solve(motion: WalkMotion, mission: Mission, start_times: Sequence[float]) -> Times | None:
    """Returns locally optimal coasting times, or None if the goal is missed.

    Args:
        motion: the walk at one uncertainty level.
        mission: start, goal and tolerance.
        start_times: initial values, seconds; their final heading selects the full turn.
    """
    trims = len(motion.velocities)
    exact, heading = mission.tolerance == 0, wants_heading(mission)
    if trims < 2 * exact + (heading and mission.heading_tolerance == 0):
        # Solvers refuse more equations than variables.
        return None
    low, high = ([0.0, 0.0], [0.0, 0.0]) if exact else ([-inf], [(1 - MARGIN) ** 2])
    if heading:
        assert mission.goal_heading is not None
        turned = motion.end(mission.start, start_times).heading
        wanted = turned + wrap_angle(mission.goal_heading - turned)
        margin = HEADING_MARGIN * max(1.0, abs(wanted) + mission.heading_tolerance)
        width = max(mission.heading_tolerance - margin, 0.0)
        low, high = [*low, wanted - width], [*high, wanted + width]
    run = solver(trims, exact=exact, heading=heading)
    answer = run(x0=list(start_times), p=_numbers(motion, mission), lbx=0, ubx=inf, lbg=low, ubg=high)
    times = tuple(max(float(time), 0.0) for time in answer["x"].nonzeros())
    return times if reaches_goal(motion.end(mission.start, times), mission) else None


@cache
def solver(trims: int, *, exact: bool, heading: bool) -> casadi.Function:
    """Builds the solver for walks of so many trims, once.

    Args:
        trims: length of the walk.
        exact: whether the goal is met exactly, or to within a tolerance.
        heading: whether the heading at the end is constrained.
    """
    times, goal, tolerance = (
        casadi.SX.sym("times", trims),
        casadi.SX.sym("goal", 2),
        casadi.SX.sym("tolerance"),
    )
    velocities, displacements = casadi.SX.sym("v", 3, trims), casadi.SX.sym("d", 3, trims - 1)
    start = casadi.SX.sym("start", 3)
    end = start
    for place in range(trims):
        if place:
            end = _onward(end, displacements[:, place - 1])
        end = _onward(end, _coast(velocities[:, place], times[place]))
    miss = end[:2] - goal
    constraints = [miss if exact else casadi.dot(miss, miss) / tolerance**2, *([end[2]] if heading else [])]
    problem = {
        "x": times,
        "p": casadi.vertcat(casadi.vec(velocities), casadi.vec(displacements), start, goal, tolerance),
        "f": casadi.sum1(times),
        "g": casadi.vertcat(*constraints),
    }
    return casadi.nlpsol(f"coasting_{trims}", "ipopt", problem, OPTIONS)


def _coast(velocity: casadi.SX, time: casadi.SX) -> casadi.SX:
    """Returns the displacement of a coast as a CasADi expression."""
    half = 0.5 * velocity[2] * time
    sinc = casadi.if_else(half == 0, 1, casadi.sin(half) / casadi.if_else(half == 0, 1, half))
    chord = casadi.vertcat(velocity[:2] * time * sinc, half)
    return casadi.vertcat(_onward(casadi.vertcat(0, 0, half), chord)[:2], 2 * half)


def _onward(pose: casadi.SX, displacement: casadi.SX) -> casadi.SX:
    c, s = casadi.cos(pose[2]), casadi.sin(pose[2])
    return casadi.vertcat(
        pose[0] + c * displacement[0] - s * displacement[1],
        pose[1] + s * displacement[0] + c * displacement[1],
        pose[2] + displacement[2],
    )


def _numbers(motion: WalkMotion, mission: Mission) -> list[float]:
    start = mission.start
    return [
        *(value for v in motion.velocities for value in (v.forward, v.side, v.yaw_rate)),
        *(value for d in motion.displacements for value in (d.x, d.y, d.heading)),
        *(start.x, start.y, start.heading),
        *mission.goal,
        mission.tolerance,
    ]
