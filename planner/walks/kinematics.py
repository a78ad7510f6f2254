"""Kinematics of a walk at an uncertainty level.

It is the flow of `flight.se2.SE2.exp` and the composition of poses; `tests.oracles` has a twin for symbols.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.se2 import SE2, Twist

from .walk import Walk


class NegativeDurationError(FlightError):
    """A maneuver's duration is negative at an uncertainty level."""

    def __init__(self, maneuver: int, duration: float, gamma: float) -> None:
        super().__init__(f"maneuver {maneuver}: duration must be >= 0 s, got {duration} s at gamma {gamma}")


class GammaError(FlightError):
    """The gamma to plan for is outside its range."""

    def __init__(self, gamma: float) -> None:
        super().__init__(f"gamma must be between 0 and 1, got {gamma}")


@dataclass(frozen=True, slots=True)
class WalkMotion:
    """Coefficients of a walk at one uncertainty level.

    Attributes:
        velocities: body velocity in each trim.
        displacements: of the maneuvers between them, in the body frame at entry.
        fixed_time: seconds spent in maneuvers.
    """

    velocities: tuple[Twist, ...]
    displacements: tuple[SE2, ...]
    fixed_time: float

    def end(self, start: SE2, coasting_times: Sequence[float]) -> SE2:
        """Returns the pose after the walk (thesis, eq. 8a and 8b).

        Args:
            start: pose at time 0.
            coasting_times: seconds, one for each trim.
        """
        pose = start @ SE2.exp(self.velocities[0], coasting_times[0])
        for displacement, velocity, time in zip(
            self.displacements, self.velocities[1:], coasting_times[1:], strict=True
        ):
            pose = pose @ displacement @ SE2.exp(velocity, time)
        return pose

    def cost(self, coasting_times: Sequence[float]) -> float:
        """Returns the seconds that the whole walk takes (thesis, eq. 6)."""
        return self.fixed_time + sum(coasting_times)


def walk_motion(library: Library, walk: Walk, gamma: float) -> WalkMotion:
    """Returns the coefficients of a walk at an uncertainty level.

    Raises:
        NoManeuverError: the library does not join two trims of the walk.
        NegativeDurationError: a maneuver would end before it begins.
    """
    outcomes = [maneuver.at(gamma) for maneuver in library.maneuvers_along(walk)]
    check_durations(library, gamma)
    return WalkMotion(
        velocities=tuple(library.trim(trim).at(gamma) for trim in walk),
        displacements=tuple(outcome.displacement for outcome in outcomes),
        fixed_time=sum(outcome.duration for outcome in outcomes),
    )


def check_durations(library: Library, gamma: float) -> None:
    """Raises `NegativeDurationError` for a negative duration at a level."""
    for maneuver in library.maneuvers:
        duration = maneuver.at(gamma).duration
        if duration < 0:
            raise NegativeDurationError(maneuver.id, duration, gamma)


def check_gamma(gamma: float) -> None:
    """Raises `GammaError` for a gamma outside [0, 1]."""
    if not 0 <= gamma <= 1:
        raise GammaError(gamma)
