"""Seconds that no coasting times of a walk can undercut."""

import numpy as np
from jaxtyping import Float

from flight.mission.mission import Mission
from flight.se2 import wrap_angle
from planner.walks.goal import wants_heading

from .batch import Batch


def least_costs(batch: Batch, mission: Mission) -> Float[np.ndarray, "rows"]:
    """Returns a lower bound of each row's cost in seconds; infinite where the goal is out of reach, proved.

    What the maneuvers leave of the distance must be flown. A trim brings the end nearer at no more than its
    speed, and a turning trim by no more than the diameter of its circle: the fastest trims are used first.
    """
    distance = mission.start.distance_to(mission.goal) - mission.destination.reach
    left = distance - np.abs(batch.displacement).sum(axis=1)
    speed = np.abs(batch.velocity)
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = np.where(speed == 0, 0.0, np.where(batch.rate == 0, np.inf, 2 * speed / np.abs(batch.rate)))
    order = np.argsort(-speed, axis=1)
    time = np.zeros(len(left))
    for place in order.T:
        rows = np.arange(len(left))
        part = np.clip(left, 0, reach[rows, place])
        with np.errstate(divide="ignore", invalid="ignore"):
            time += np.where(part > 0, part / speed[rows, place], 0)
        left = left - part
    least: Float[np.ndarray, "rows"] = np.where(left > 0, np.inf, batch.fixed_time + time)
    return np.where(_heading_out_of_reach(batch, mission), np.inf, least)


def _heading_out_of_reach(batch: Batch, mission: Mission) -> Float[np.ndarray, "rows"]:
    """Returns whether a walk without turning trims ends with another heading than the one wanted."""
    if not wants_heading(mission) or mission.goal_heading is None:
        return np.zeros(len(batch.rate), dtype=bool)
    fixed = mission.start.heading + batch.turn.sum(axis=1)
    off = np.array([abs(wrap_angle(heading - mission.goal_heading)) for heading in fixed])
    never_turns: Float[np.ndarray, "rows"] = (batch.rate == 0).all(axis=1)
    return never_turns & (off > mission.destination.heading_reach)
