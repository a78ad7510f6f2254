"""Protocol of vehicles that fly primitives: model, simulator, autopilot."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from jaxtyping import Float

from flight.se2 import SE2

from .maneuver import Maneuver


@dataclass(frozen=True, slots=True, eq=False)
class Leg:
    """Coast or maneuver as flown: true motion, estimate, alarm.

    Attributes:
        duration: seconds.
        settled: True if the primitive ended by its rule (a coast always does), not by time-out.
        track: true motion including both ends: time since the start in seconds, north and east in metres,
            heading in radians (not wrapped).
        estimated_track: the same as estimated by the vehicle; None if that is the truth.
        standard_deviation: largest standard deviation of the estimated position in metres, as the vehicle
            claims it: the root of the summed variances of north and east.
        heading_deviation: largest standard deviation of the estimated heading in radians, likewise.
        turbulence: estimated wind at 20 ft at the end (MIL-F-8785C), in m/s;
            None if unknown.
        alarm: alarm that ended the leg early; empty without one.
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
    """Vehicle that holds trims, performs maneuvers and estimates its pose."""

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
