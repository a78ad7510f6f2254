"""Trim: a body velocity that the vehicle can hold indefinitely."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from flight.file_value import FileValue, Omittable
from flight.se2 import Twist

from .statistics import AveragedError, InterpolationClaim, Statistics


@dataclass(frozen=True, slots=True)
class Trim(FileValue):
    """A vertex of the maneuver automaton (thesis, 2.4.1).

    Attributes:
        id: the number by which maneuvers, missions and plans name it.
        name: a few words for people.
        velocity: the nominal body velocity.
        error: the signed error of the velocity; gamma scales it.
        statistics: samples behind the error, if it was measured.
        averaged: errors averaged over a coast, by its duration, where they were measured.
        interpolated: claim of the error, if it was interpolated between flown trims.
    """

    id: int
    name: str
    velocity: Twist
    error: Annotated[Twist, Field(description="signed; gamma scales it")]
    statistics: Statistics | None = None
    averaged: Annotated[
        Omittable[tuple[AveragedError, ...]],
        Field(description="errors averaged over a coast, by its duration"),
    ] = ()
    interpolated: InterpolationClaim | None = None

    def at(self, gamma: float) -> Twist:
        """Returns the body velocity under an uncertainty level gamma (thesis, eq. 8a)."""
        return self.velocity.scaled_error(self.error, gamma)
