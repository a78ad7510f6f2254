"""Goal condition of a walk."""

from flight.mission.mission import Mission
from flight.se2 import SE2, rotate


def reaches_goal(end: SE2, mission: Mission) -> bool:
    """Returns True if a pose meets the goal and its heading."""
    return mission.destination.reached(end)


def wants_heading(mission: Mission) -> bool:
    """Returns True if the heading at the goal is constrained."""
    return mission.destination.wants_heading


def goal_from_start(mission: Mission) -> complex:
    """Returns the goal in the start frame, ahead + i right, metres."""
    start = mission.start
    return complex(*rotate(mission.goal[0] - start.x, mission.goal[1] - start.y, -start.heading))
