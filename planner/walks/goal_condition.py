"""When a walk has arrived."""

from flight.mission.mission import Mission
from flight.se2 import SE2, rotate


def reaches_goal(end: SE2, mission: Mission) -> bool:
    """Whether a pose meets the goal, with the heading wanted there."""
    return mission.destination.reached(end)


def wants_heading(mission: Mission) -> bool:
    """Whether the heading at the goal is constrained."""
    return mission.destination.wants_heading


def goal_from_start(mission: Mission) -> complex:
    """Returns the goal seen from the start, ahead + i right in metres."""
    start = mission.start
    return complex(*rotate(mission.goal[0] - start.x, mission.goal[1] - start.y, -start.heading))
