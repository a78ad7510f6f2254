"""Protocol of vehicles that fly primitives: model, simulator, autopilot."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from jaxtyping import Float

from flight.se2 import SE2

from .maneuver import Maneuver


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """A stretch of flight, as it truly happened.

    Attributes:
        duration: seconds.
        settled: whether the primitive ended by its rule (a coast always does), not by time-out.
        track: true motion including both ends: time since the start in seconds, north and east in metres,
            heading in radians (not wrapped).
        estimated_track: the same as the vehicle believes it; None where that is the truth.
        standard_deviation: of the believed position in metres, the largest on the way, as the vehicle
            claims it: the root of the summed variances of north and east.
        heading_deviation: standard deviation of the believed heading in radians, likewise.
        turbulence: how hard the vehicle takes it to blow at the end: the standard's wind at 20 ft, in m/s;
            None where it does not know.
        alarm: what the vehicle found wrong with itself, and broke the leg off for; empty where nothing.
    """

    duration: float
    settled: bool
    track: Float[np.ndarray, "n 4"]
    estimated_track: Float[np.ndarray, "n 4"] | None = None
    standard_deviation: float = 0.0
    heading_deviation: float = 0.0
    turbulence: float | None = None
    alarm: str = ""


class Vehicle(Protocol):
    """Something that holds trims and performs maneuvers, and believes to be somewhere."""

    @property
    def time(self) -> float:
        """Seconds since the start."""

    @property
    def trim(self) -> int:
        """Id of the trim held now."""

    @property
    def pose(self) -> SE2:
        """Believed pose in the world."""

    def coast(self, duration: float) -> Leg:
        """Holds the trim for a time in seconds.

        Raises:
            FlightLostError: the flight ended in the ground or diverged.
        """

    def perform(self, maneuver: Maneuver) -> Leg:
        """Performs a maneuver from the present trim, to its end or time-out.

        Raises:
            FlightLostError: the flight ended in the ground or diverged.
        """
