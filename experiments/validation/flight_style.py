"""Track and style of closed-loop flights in pictures."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from matplotlib.axes import Axes

from review.pictures import palette
from review.pictures.stroke import Dashes, Stroke

MANEUVERED: Dashes = (0.0, (2.5, 1.5))
"""Dashes of maneuvers; coasts are solid, as in the thesis's figures."""

POLICY_COLORS = {
    "feedback": palette.INK,
    "nominal": palette.ALARM,
    "worst-case": palette.TRUE_COLOR,
    "committed": palette.GOAL,
}
POLICY_MARKS = {"feedback": "D", "nominal": "s", "worst-case": "o", "committed": "^"}


@dataclass(frozen=True, slots=True, eq=False)
class LegTrack:
    """One primitive flown.

    Attributes:
        trim: id of the trim; for a maneuver, of the trim left.
        maneuver: id of the maneuver; None for a coast.
        duration: seconds.
        track: north and east in metres.
    """

    trim: int
    maneuver: int | None
    duration: float
    track: Float[np.ndarray, "n 2"]


@dataclass(frozen=True, slots=True, eq=False)
class FlightTrack:
    """Track of one closed-loop flight.

    Attributes:
        policy: policy of the planner.
        reached: True if it reached the goal.
        flown_time: seconds to the goal, or of the whole flight.
        predicted_time: predicted seconds; None without a plan.
        level: gamma of the plan; None without one.
        legs: primitives in the order flown.
    """

    policy: str
    reached: bool
    flown_time: float
    predicted_time: float | None
    level: float | None
    legs: tuple[LegTrack, ...]


def draw_flight(axes: Axes, flight: FlightTrack, *, width: float, opacity: float) -> None:
    """Draws a flight's track in its policy's colour."""
    color = policy_color(flight.policy)
    for leg in flight.legs:
        dashes: Dashes = "solid" if leg.maneuver is None else MANEUVERED
        stroke = Stroke(color, width, dashes=dashes, opacity=opacity, layer=4.0)
        stroke.draw(axes, leg.track[:, 1], leg.track[:, 0])


def policy_color(policy: str) -> str:
    """Returns the colour of a policy."""
    return POLICY_COLORS.get(policy, palette.INK)


def policies_of(flights: Iterable[FlightTrack]) -> tuple[str, ...]:
    """Returns the distinct policies of flights, shipped ones first."""
    flown = {flight.policy for flight in flights}
    order = [policy for policy in POLICY_COLORS if policy in flown]
    return (*order, *sorted(flown - set(order)))
