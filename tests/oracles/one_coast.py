"""Candidate times of one free coast: line or circle meets disc."""

from math import inf, pi

import numpy as np
from jaxtyping import Complex, Float

from .coasting_flow import end_velocities, fly
from .coasting_problem import CoastingProblem
from .goal_region import GoalRegion

STEPS = 4
"""Newton steps that correct cancellation in turns of large radius."""


def telling_times(
    problem: CoastingProblem, start: tuple[complex, float], goal: GoalRegion
) -> Float[np.ndarray, "rows candidates"]:
    """Returns candidate times, among them the least that reaches the goal.

    At the least time the goal's edge is entered or touched, or a heading limit is met.

    Args:
        problem: rows with one free coast.
        start: position and heading at time 0.
        goal: where to end.
    """
    nearest, crossing, limits = _candidates(problem, start, goal)
    for _ in range(STEPS):
        nearest = nearest - _toward_nearest(problem, nearest, start, goal)
        crossing = crossing - _toward_edge(problem, crossing, start, goal)
    every = np.concatenate([np.zeros((len(nearest), 1)), nearest, crossing, limits], axis=1)
    every = np.where(np.isfinite(every), every, -1.0)
    return every


def _candidates(
    problem: CoastingProblem, start: tuple[complex, float], goal: GoalRegion
) -> tuple[Float[np.ndarray, "rows n"], Float[np.ndarray, "rows m"], Float[np.ndarray, "rows k"]]:
    """Returns times nearest the centre, on the edge, at heading limits."""
    still = fly(problem, np.zeros((len(problem.walk), 1)), start)
    velocity, rate = problem.velocity[:, 0], problem.rate[:, 0]
    heading = start[1] + problem.gap_turn[:, 0]
    direction = np.exp(1j * heading)
    turning = rate != 0
    full = np.where(turning, 2 * pi / np.where(turning, np.abs(rate), 1.0), inf)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        line, line_edge = _on_line(still.position, direction * velocity, goal)
        radius = np.where(turning, velocity / (1j * np.where(turning, rate, 1.0)), 0.0)
        begin = start[0] + np.exp(1j * start[1]) * problem.gap[:, 0]
        middle = begin - direction * radius
        arm = direction * (radius + problem.gap[:, 1])
        angle, angle_edge = _on_circle(middle, arm, goal)
        turn = np.mod(angle * np.sign(rate), 2 * pi) / np.abs(rate)
        turn_edge = np.mod(angle_edge * np.sign(rate)[:, None], 2 * pi) / np.abs(rate)[:, None]
    # A time just before the begin by rounding is at the begin.
    turn_edge = np.concatenate([turn_edge, turn_edge - full[:, None]], axis=1)
    nearest = np.stack([line, turn, turn - full], axis=1)
    limits = np.full((len(rate), 1), np.nan)
    if goal.heading is not None:
        sides = np.array([[-goal.width, goal.width]])
        off = goal.heading + sides - still.heading[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            limits = np.mod(off * np.sign(rate)[:, None], 2 * pi) / np.abs(rate)[:, None]
    return nearest, np.concatenate([line_edge, turn_edge], axis=1), limits


def _on_line(
    begin: Complex[np.ndarray, "rows"], velocity: Complex[np.ndarray, "rows"], goal: GoalRegion
) -> tuple[Float[np.ndarray, "rows"], Float[np.ndarray, "rows 2"]]:
    unit = velocity / np.abs(velocity)
    away = np.conj(unit) * (goal.centre - begin)
    half = np.sqrt(np.maximum(goal.radius**2 - away.imag**2, 0.0))
    speed = np.abs(velocity)
    return away.real / speed, np.stack([(away.real - half) / speed, (away.real + half) / speed], axis=1)


def _on_circle(
    middle: Complex[np.ndarray, "rows"], arm: Complex[np.ndarray, "rows"], goal: GoalRegion
) -> tuple[Float[np.ndarray, "rows"], Float[np.ndarray, "rows 2"]]:
    away = goal.centre - middle
    angle = np.angle(away * np.conj(arm))
    share = (np.abs(away) ** 2 + np.abs(arm) ** 2 - goal.radius**2) / (2 * np.abs(away) * np.abs(arm))
    half = np.arccos(np.clip(share, -1.0, 1.0))
    return angle, np.stack([angle - half, angle + half], axis=1)


def _moved(
    problem: CoastingProblem, times: Float[np.ndarray, "rows n"], start: tuple[complex, float]
) -> tuple[Complex[np.ndarray, "rows n"], Complex[np.ndarray, "rows n"]]:
    """Returns ends and their velocities for several times in each row."""
    count = times.shape[1]
    many = problem.take(np.repeat(np.arange(len(times)), count))
    ends, moves = end_velocities(many, np.nan_to_num(times, posinf=0, neginf=0).reshape(-1, 1), start)
    return ends.position.reshape(times.shape), moves[:, 0].reshape(times.shape)


def _toward_nearest(
    problem: CoastingProblem,
    times: Float[np.ndarray, "rows n"],
    start: tuple[complex, float],
    goal: GoalRegion,
) -> Float[np.ndarray, "rows n"]:
    position, moves = _moved(problem, times, start)
    off = position - goal.centre
    slope = (np.conj(off) * moves).real
    bend = np.abs(moves) ** 2 + (np.conj(off) * 1j * problem.rate * moves).real
    return np.where(bend > 0, slope / np.where(bend > 0, bend, 1.0), 0.0)


def _toward_edge(
    problem: CoastingProblem,
    times: Float[np.ndarray, "rows n"],
    start: tuple[complex, float],
    goal: GoalRegion,
) -> Float[np.ndarray, "rows n"]:
    position, moves = _moved(problem, times, start)
    off = position - goal.centre
    slope = (np.conj(off) * moves).real
    beyond = 0.5 * (np.abs(off) - goal.radius) * (np.abs(off) + goal.radius)
    steep = np.abs(slope) > 1e-6 * np.abs(off) * np.abs(moves)
    return np.where(steep, beyond / np.where(steep, slope, 1.0), 0.0)
