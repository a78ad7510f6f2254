"""Winds that a vehicle can hold, decided before take-off.

Wherever the vehicle heads, the wind may come from any side. The airspeed that it may need is the mean wind at
its height, the speed of its fastest trim and three standard deviations of the horizontal gusts. The airspeed
that it holds is the largest with an equilibrium in every direction, servos within their travel, and within
the controller's limit of attitude beyond that of hover.
"""

from dataclasses import dataclass
from functools import cache
from math import cos, hypot, pi, sin

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.se2 import Twist
from sim.control.gains import Gains
from sim.vehicle.equilibrium import Equilibrium, EquilibriumFinder, NoEquilibriumError
from sim.vehicle.parameters import Parameters, read_parameters

from .dryden import dryden
from .wind_class import WindClass, wind_class

# Standard deviations of the horizontal gusts to be held.
_GUST_DEVIATIONS = 3.0
# Directions of the airspeed that are tried.
_DIRECTIONS = 8
# Resolution and end of the search, m/s.
_RESOLUTION, _FASTEST = 0.25, 64.0


@dataclass(frozen=True, slots=True)
class NeededAirspeed:
    """Airspeed that a wind may need, by parts in m/s."""

    mean_wind: float
    gusts: float
    trim_speed: float

    @property
    def total(self) -> float:
        """Sum of the parts, m/s."""
        return self.mean_wind + self.gusts + self.trim_speed


class UnflyableWindError(FlightError):
    """Wind beyond what the vehicle can hold."""

    def __init__(self, wind: str, *, height: float, needed: NeededAirspeed, held: float) -> None:
        super().__init__(
            f"wind {wind} cannot be flown: expected at most {held:.1f} m/s of airspeed, the most that the "
            f"vehicle holds from every side, got {needed.total:.1f} m/s (mean wind {needed.mean_wind:.1f} at "
            f"{height:g} m, gusts {needed.gusts:.1f}, trim speed {needed.trim_speed:.1f})"
        )


def check_flyable(wind: str, library: Library, *, height: float) -> None:
    """Refuses a wind that the nominal vehicle cannot hold.

    Args:
        wind: wind class.
        library: trims to be flown.
        height: height above ground, m.

    Raises:
        UnknownWindError: the wind does not exist.
        UnflyableWindError: it cannot be held.
    """
    found = wind_class(wind)
    if not found.wind_at_20_ft:
        return
    needed, held = needed_airspeed(found, library, height=height), held_airspeed(read_parameters())
    if needed.total > held:
        raise UnflyableWindError(wind, height=height, needed=needed, held=held)


def needed_airspeed(wind: WindClass, library: Library, *, height: float) -> NeededAirspeed:
    """Returns the airspeed that a wind may need."""
    gusts = dryden(wind.wind_at_20_ft, height=height, span=1.0)
    return NeededAirspeed(
        mean_wind=wind.mean_wind(height),
        gusts=_GUST_DEVIATIONS * gusts.sigma_horizontal,
        trim_speed=max(hypot(trim.velocity.forward, trim.velocity.side) for trim in library.trims),
    )


@cache
def held_airspeed(parameters: Parameters) -> float:
    """Returns the largest airspeed held in every direction, m/s."""
    finder, low, high = EquilibriumFinder(parameters), 0.0, _FASTEST
    hover, limit = finder.find(Twist(0.0, 0.0, 0.0)), Gains().tilt_limit

    def holds(velocity: Twist) -> bool:
        try:
            found: Equilibrium = finder.find(velocity)
        except NoEquilibriumError:
            return False
        return max(abs(found.roll - hover.roll), abs(found.pitch - hover.pitch)) <= limit

    while high - low > _RESOLUTION:
        speed = 0.5 * (low + high)
        angles = [2.0 * pi * number / _DIRECTIONS for number in range(_DIRECTIONS)]
        if all(holds(Twist(speed * cos(angle), speed * sin(angle), 0.0)) for angle in angles):
            low = speed
        else:
            high = speed
    return low
