"""Goal region of a mission: closed disc and heading interval."""

from dataclasses import dataclass
from math import pi

import numpy as np
from jaxtyping import Float

from flight.mission.mission import Mission

from .coasting_flow import Ends

ROUNDING = 4e-15
"""Rounding slack of an end, as a share of path length and of radians turned."""


FORGIVEN = 1e-9
"""Metres and radians by which a plan may be beyond its tolerance, 0 or more ..."""

FORGIVEN_SHARE = 1e-12
"""... and share of numbers in metres that are larger than a thousand."""


@dataclass(frozen=True, slots=True)
class GoalRegion:
    """Closed disc and heading interval; zero tolerance means equality.

    Attributes:
        centre: north + i east, metres.
        radius: metres.
        heading: radians; None without a constraint.
        width: half width of the interval of headings, radians.
    """

    centre: complex
    radius: float
    heading: float | None
    width: float

    @classmethod
    def of(cls, mission: Mission) -> "GoalRegion":
        """Returns the region of a mission."""
        heading = mission.goal_heading if mission.heading_tolerance < pi else None
        return cls(complex(*mission.goal), mission.tolerance, heading, mission.heading_tolerance)

    def beyond(self, ends: Ends) -> Float[np.ndarray, "*n"]:
        """Returns metres by which ends are outside the disc; negative inside."""
        return np.abs(ends.position - self.centre) - self.radius

    def heading_beyond(self, ends: Ends) -> Float[np.ndarray, "*n"]:
        """Returns radians by which headings are outside the interval; negative inside."""
        if self.heading is None:
            return np.full(ends.heading.shape, -pi)
        return np.asarray(np.abs(wrapped(ends.heading - self.heading)) - self.width)

    def holds(self, ends: Ends, *, slack: float = ROUNDING) -> "np.ndarray":
        """Returns True where ends are inside, with relative slack for rounding."""
        near = slack * (ends.way + abs(self.centre) + self.radius)
        turned = slack * (1 + np.abs(ends.heading) + abs(self.heading or 0.0))
        return np.asarray((self.beyond(ends) <= near) & (self.heading_beyond(ends) <= turned))


def wrapped(angle: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Returns angles brought into [-pi, pi]."""
    return angle - 2 * pi * np.round(angle / (2 * pi))


def slack(mission: Mission) -> float:
    """Returns metres by which a plan may be beyond the tolerance."""
    sizes = (*mission.start.position, *mission.goal, mission.tolerance)
    return max(FORGIVEN, FORGIVEN_SHARE * sum(map(abs, sizes)))
