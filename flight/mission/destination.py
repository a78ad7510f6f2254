"""Destination of a flight, its tolerance, and first arrival of its track."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, pi

import numpy as np
from jaxtyping import Float

from flight.se2 import SE2, wrap_angle

Track = Float[np.ndarray, "_ 4"]

SLACK = 1e-9
"""Metres and radians by which rounding may leave an end outside a tolerance of 0 or more.

Tolerances are closed sets. An end is the sum of some hundred rounded terms: on ways of 10^5 m they are less
than this, which is far less than any flight shows.
"""

LARGE = 1e3
"""Metres; of larger problems the slack is the 10^-12th part, as numbers round to a part of their size."""


def slack_of(*sizes: float) -> float:
    """Returns the slack for rounding, in metres or seconds.

    Args:
        sizes: of the numbers that a problem is stated in, likewise.
    """
    return SLACK * max(1.0, sum(map(abs, sizes)) / LARGE)


@dataclass(frozen=True, slots=True)
class Destination:
    """Goal position and heading with their tolerances.

    Attributes:
        position: north and east in metres.
        tolerance: radius in metres.
        heading: wanted there, in radians; None leaves it free.
        heading_tolerance: half width around that heading, in radians.
        slack: metres that rounding may leave an end outside.
    """

    position: tuple[float, float]
    tolerance: float
    heading: float | None = None
    heading_tolerance: float = pi
    slack: float = SLACK

    @property
    def reach(self) -> float:
        """Metres from the position within which it counts as reached."""
        return self.tolerance + self.slack

    @property
    def heading_reach(self) -> float:
        """Radians from the heading within which it counts as reached."""
        return self.heading_tolerance + SLACK

    @property
    def wants_heading(self) -> bool:
        """True where some heading is outside the tolerance."""
        return self.heading is not None and self.heading_tolerance < pi

    def reached(self, pose: SE2) -> bool:
        """Returns True where a pose meets position and heading, closed sets."""
        if not pose.distance_to(self.position) <= self.reach:
            return False
        return self.heading is None or abs(wrap_angle(pose.heading - self.heading)) <= self.heading_reach


@dataclass(frozen=True, slots=True)
class Arrival:
    """First arrival at a goal, and the least distance to it.

    Attributes:
        time: seconds since the start at which the tolerance was entered; None where it never was.
        closest: metres between the goal and the nearest point of the track, up to the stretch between two
            points in which it arrives, and no more than the tolerance then.
    """

    time: float | None
    closest: float


def first_arrival(tracks: Sequence[Track], destination: Destination) -> Arrival:
    """Returns the first entry of a polyline into the goal's tolerance.

    Where a heading is wanted, it must be held there too; the heading between two points is interpolated.

    Args:
        tracks: stretches of one flight, in order: time since the start, north, east, heading (not wrapped).
        destination: judged with its own tolerance.
    """
    closest = inf
    for stretch in tracks:
        track = stretch if len(stretch) > 1 else np.repeat(stretch, 2, axis=0)
        begin, end = track[:-1], track[1:]
        inside = _shares_inside_goal(begin, end, destination)
        nearest = _distance_to_goal(begin, end, destination)
        entered = np.flatnonzero(inside[:, 0] <= inside[:, 1])
        if len(entered):
            place = entered[0]
            share = inside[place, 0]
            time = begin[place, 0] + share * (end[place, 0] - begin[place, 0])
            return Arrival(
                float(time), min(closest, destination.tolerance, float(nearest[: place + 1].min()))
            )
        closest = min(closest, float(nearest.min()))
    return Arrival(None, closest)


def _distance_to_goal(
    begin: Float[np.ndarray, "n 4"], end: Float[np.ndarray, "n 4"], destination: Destination
) -> Float[np.ndarray, "n"]:
    """Returns the distance between the goal and each piece of the track."""
    offset, way = begin[:, 1:3] - np.array(destination.position), end[:, 1:3] - begin[:, 1:3]
    length = (way**2).sum(axis=1)
    share = np.clip(-(offset * way).sum(axis=1) / np.where(length > 0, length, 1.0), 0.0, 1.0)
    distance: Float[np.ndarray, "n"] = np.linalg.norm(offset + share[:, None] * way, axis=1)
    return distance


def _shares_inside_goal(
    begin: Float[np.ndarray, "n 4"], end: Float[np.ndarray, "n 4"], destination: Destination
) -> Float[np.ndarray, "n 2"]:
    """Returns the shares of each piece at which it enters and leaves."""
    offset, way = begin[:, 1:3] - np.array(destination.position), end[:, 1:3] - begin[:, 1:3]
    # |offset + s way| = reach, a quadratic in s.
    a, b = (way**2).sum(axis=1), (offset * way).sum(axis=1)
    c = (offset**2).sum(axis=1) - destination.reach**2
    moving = a > 0
    root = np.sqrt(np.maximum(b**2 - a * c, 0.0))
    scale = np.where(moving, a, 1.0)
    meets = moving & (b**2 >= a * c)
    low = np.where(meets, (-b - root) / scale, np.where(~moving & (c <= 0), 0.0, inf))
    high = np.where(meets, (-b + root) / scale, np.where(~moving & (c <= 0), 1.0, -inf))
    if destination.heading is not None:
        low, high = _restrict_to_heading(low, high, begin[:, 3], end[:, 3], destination)
    return np.column_stack([np.maximum(low, 0.0), np.minimum(high, 1.0)])


def _restrict_to_heading(
    low: Float[np.ndarray, "n"],
    high: Float[np.ndarray, "n"],
    begin: Float[np.ndarray, "n"],
    end: Float[np.ndarray, "n"],
    destination: Destination,
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Restricts the shares to where the heading is inside its tolerance."""
    off = begin - (destination.heading or 0.0)
    off = off - 2 * np.pi * np.round(off / (2 * np.pi))
    turn = end - begin
    held = np.abs(off) <= destination.heading_reach
    scale = np.where(turn != 0, turn, 1.0)
    one = (-destination.heading_reach - off) / scale
    two = (destination.heading_reach - off) / scale
    turning = turn != 0
    first = np.where(turning, np.minimum(one, two), np.where(held, -inf, inf))
    last = np.where(turning, np.maximum(one, two), np.where(held, inf, -inf))
    return np.maximum(low, first), np.minimum(high, last)
