"""When a walk has arrived."""

from math import pi

from flight.mission.mission import Mission
from flight.se2 import SE2, rotate, wrap_angle

EQUALITY_TOLERANCE = 1e-6
"""Metres; a goal tolerance of 0 means equality to within this."""


def reaches_goal(end: SE2, mission: Mission) -> bool:
    """Whether a pose meets the goal, with the heading wanted there."""
    if not end.distance_to(mission.goal) <= max(mission.tolerance, EQUALITY_TOLERANCE):
        return False
    if mission.goal_heading is None:
        return True
    off = abs(wrap_angle(end.heading - mission.goal_heading))
    return off <= max(mission.heading_tolerance, EQUALITY_TOLERANCE)


def wants_heading(mission: Mission) -> bool:
    """Whether the heading at the goal is constrained."""
    return mission.goal_heading is not None and mission.heading_tolerance < pi


def goal_from_start(mission: Mission) -> complex:
    """Returns the goal seen from the start, ahead + i right in metres."""
    start = mission.start
    return complex(*rotate(mission.goal[0] - start.x, mission.goal[1] - start.y, -start.heading))
