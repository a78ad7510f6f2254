"""Maneuver: a fixed transition between two trims."""

from dataclasses import dataclass, fields
from math import isfinite
from typing import Annotated, Self

from pydantic import Field, NonNegativeFloat

from flight.file_value import FileValue, Omittable
from flight.se2 import SE2

from .statistics import InterpolationClaim, Statistics


@dataclass(frozen=True, slots=True)
class ManeuverError(FileValue):
    """Signed errors of a maneuver: s, m forward, m right, rad."""

    duration: float
    forward: float
    side: float
    heading_change: float

    def __post_init__(self) -> None:
        """Refuses non-finite components."""
        if not all(
            isfinite(value) for value in (self.duration, self.forward, self.side, self.heading_change)
        ):
            raise ValueError(f"maneuver errors must be finite, got {self}")


@dataclass(frozen=True, slots=True)
class ManeuverOutcome:
    """Duration and displacement of a maneuver at one gamma."""

    duration: float
    displacement: SE2


@dataclass(frozen=True, slots=True)
class Maneuver:
    """An edge of the maneuver automaton (thesis, 2.4.2).

    Attributes:
        id: its number in the library.
        from_trim: id of the trim it leaves.
        to_trim: id of the trim it leads to.
        duration: seconds.
        displacement: forward, to the right, heading change, in the body frame at entry, so that
            `pose_exit = pose_entry @ displacement` (thesis, eq. 3b with the rotation it leaves out).
        error: signed errors; gamma scales them.
        statistics: samples behind the errors, if they were measured.
        notes: remarks, such as a suspect row of a printed table.
        interpolated: claim of the errors, if they were interpolated between flown maneuvers.
    """

    id: int
    from_trim: int
    to_trim: int
    duration: float
    displacement: SE2
    error: ManeuverError
    statistics: Statistics | None = None
    notes: str = ""
    interpolated: InterpolationClaim | None = None

    def __post_init__(self) -> None:
        """Refuses a duration that is not a time."""
        if not (isfinite(self.duration) and self.duration >= 0):
            raise ValueError(f"maneuver {self.id}: duration must be >= 0 s, got {self.duration} s")

    def at(self, gamma: float) -> ManeuverOutcome:
        """Returns duration and displacement at an uncertainty level gamma (thesis, eq. 8b)."""
        return ManeuverOutcome(
            self.duration + gamma * self.error.duration,
            SE2(
                self.displacement.x + gamma * self.error.forward,
                self.displacement.y + gamma * self.error.side,
                self.displacement.heading + gamma * self.error.heading_change,
            ),
        )


@dataclass(frozen=True, slots=True)
class DisplacementRow(FileValue):
    """End position of a maneuver in the body frame at entry."""

    forward: Annotated[float, Field(description="metres, along the heading at entry")]
    side: Annotated[float, Field(description="metres, to the right of the heading at entry")]


@dataclass(frozen=True, slots=True)
class ManeuverRow(FileValue):
    """A maneuver as in files."""

    id: int
    from_trim: Annotated[int, Field(alias="from")]
    to_trim: Annotated[int, Field(alias="to")]
    duration: Annotated[NonNegativeFloat, Field(description="seconds")]
    displacement: DisplacementRow
    heading_change: Annotated[float, Field(description="radians, clockwise positive")]
    error: Annotated[ManeuverError, Field(description="signed; gamma scales it")]
    statistics: Statistics | None = None
    notes: Omittable[str] = ""
    interpolated: InterpolationClaim | None = None

    @classmethod
    def of(cls, maneuver: Maneuver) -> Self:
        """Returns the row of a maneuver."""
        moved = maneuver.displacement
        shared = {name: getattr(maneuver, name) for name in _SHARED}
        return cls(displacement=DisplacementRow(moved.x, moved.y), heading_change=moved.heading, **shared)

    def maneuver(self) -> Maneuver:
        """Returns the maneuver."""
        moved = SE2(self.displacement.forward, self.displacement.side, self.heading_change)
        return Maneuver(displacement=moved, **{name: getattr(self, name) for name in _SHARED})


_SHARED = tuple(field.name for field in fields(Maneuver) if field.name != "displacement")
