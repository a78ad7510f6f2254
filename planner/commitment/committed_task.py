"""Task of a committed plan in the start frame, heading north."""

from dataclasses import dataclass

from flight.mission.mission import Mission
from planner.walks.goal_condition import goal_from_start, wants_heading


@dataclass(frozen=True, slots=True)
class CommittedTask:
    """A mission at every level from -gamma to gamma.

    Attributes:
        goal: north + i east in metres.
        tolerance: radius around it in metres.
        gamma: the largest level.
        wants_heading: True if the heading at the goal is constrained.
        heading: wanted there, radians.
        heading_tolerance: half width around the heading, radians.
    """

    goal: complex
    tolerance: float
    gamma: float
    wants_heading: bool
    heading: float
    heading_tolerance: float

    @classmethod
    def of(cls, mission: Mission, gamma: float) -> "CommittedTask":
        """Returns the task of a mission."""
        start = mission.start
        return cls(
            goal_from_start(mission),
            mission.destination.reach,
            gamma,
            wants_heading(mission),
            (mission.goal_heading or 0.0) - start.heading,
            mission.destination.heading_reach,
        )
