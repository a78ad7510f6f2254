"""Closed-form integral of the trim flow: x' = exp(i heading) v.

Positions are north + i east in metres, headings clockwise from north in radians.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from .coasting_problem import CoastingProblem

Times = Float[np.ndarray, "rows *samples free"]
"""Seconds in each free coast."""


@dataclass(frozen=True, slots=True, eq=False)
class Ends:
    """Ends of flights.

    Attributes:
        position: north + i east, metres.
        heading: radians, not wrapped.
        way: metres flown and displaced in all: rounding grows with it.
    """

    position: Complex[np.ndarray, "rows *samples"]
    heading: Float[np.ndarray, "rows *samples"]
    way: Float[np.ndarray, "rows *samples"]


def coasted(
    velocity: Complex[np.ndarray, "*n"], rate: Float[np.ndarray, "*n"], time: Float[np.ndarray, "*n"]
) -> Complex[np.ndarray, "*n"]:
    """Returns the integral of `exp(i r s) v` over [0, time]."""
    angle = rate * time
    turning = angle != 0
    safe = np.where(turning, angle, 1.0)
    ahead = np.where(turning, np.sin(safe) / safe, 1.0)
    aside = np.where(turning, 2 * np.sin(0.5 * safe) ** 2 / safe, 0.0)
    return np.asarray(velocity * time * (ahead + 1j * aside))


def fly(problem: CoastingProblem, times: Times, start: tuple[complex, float], *, until: int = -1) -> Ends:
    """Flies rows of walks from a pose.

    Args:
        problem: the walks.
        times: seconds in the free coasts, rows x samples x free, or rows x free.
        start: position and heading at time 0.
        until: number of coasts after which to stop, before the gap that follows; all and the last gap
            where negative.
    """
    extra = (1,) * (times.ndim - 2)
    many = problem.free if until < 0 else until
    position = np.full(times.shape[:-1], start[0], dtype=complex)
    heading = np.full(times.shape[:-1], start[1])
    way = np.full(times.shape[:-1], abs(start[0]))
    for place in range(many):
        gap = problem.gap[:, place].reshape(-1, *extra)
        position = position + np.exp(1j * heading) * gap
        heading = heading + problem.gap_turn[:, place].reshape(-1, *extra)
        velocity = problem.velocity[:, place].reshape(-1, *extra)
        rate = problem.rate[:, place].reshape(-1, *extra)
        time = times[..., place]
        position = position + np.exp(1j * heading) * coasted(velocity, rate, time)
        heading = heading + rate * time
        way = way + np.abs(gap) + np.abs(velocity) * np.abs(time)
    if until < 0:
        gap = problem.gap[:, many].reshape(-1, *extra)
        position = position + np.exp(1j * heading) * gap
        heading = heading + problem.gap_turn[:, many].reshape(-1, *extra)
        way = way + np.abs(gap)
    return Ends(position, heading, way)


def end_velocities(
    problem: CoastingProblem, times: Float[np.ndarray, "rows free"], start: tuple[complex, float]
) -> tuple[Ends, Complex[np.ndarray, "rows free"]]:
    """Returns the ends and their velocities with each time."""
    ends = fly(problem, times, start)
    position = np.full(len(times), start[0], dtype=complex)
    heading = np.full(len(times), start[1])
    moves = np.zeros(times.shape, dtype=complex)
    for place in range(problem.free):
        position = position + np.exp(1j * heading) * problem.gap[:, place]
        heading = heading + problem.gap_turn[:, place]
        velocity, rate, time = problem.velocity[:, place], problem.rate[:, place], times[:, place]
        position = position + np.exp(1j * heading) * coasted(velocity, rate, time)
        heading = heading + rate * time
        moves[:, place] = np.exp(1j * heading) * velocity + 1j * rate * (ends.position - position)
    return ends, moves
