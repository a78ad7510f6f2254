"""A mission: from where, in which trim, to where, how exactly."""

from dataclasses import dataclass
from functools import partial
from math import isfinite, pi
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, Field, FiniteFloat, PositiveInt, model_validator

from flight.file_value import FileValue
from flight.schema import FileModel, read_toml, refusing, schema_named
from flight.se2 import SE2

from .destination import Destination, slack_of

SCHEMA = "maneuver-mission/1"
"""Schema name that a file may state; without one it is of this version."""

MAX_COORDINATE = 1e6
"""Metres north or east of the origin that a file may say: a plan's end is checked to 1e-6 m, and numbers of
this size are 1e-10 m apart."""

MAX_HEADING = 1e3
"""Radians that a heading in a file may say: numbers of this size are 1e-13 rad apart, which is 1e-7 m at the
end of the farthest way; those of 1e17 are no headings at all."""

MAX_TRIMS = 8
"""Trims in a sequence that may be asked for: of more there are more walks than can be searched in minutes."""


@dataclass(frozen=True, slots=True)
class Mission(FileValue):
    """A motion-planning task in the plane.

    Attributes:
        name: short name.
        start: pose at time 0, metres and radians.
        start_trim: id of the trim held at time 0.
        goal: north and east in metres.
        tolerance: radius around the goal in metres; 0 means equality.
        goal_heading: heading wanted at the goal in radians; None leaves it free.
        heading_tolerance: half width around that heading in radians.
        goal_trim: id of the trim wanted at the end; None leaves it free.
        max_trims: depth of the search, in trims.
    """

    name: str
    start: SE2
    start_trim: int
    goal: tuple[float, float]
    tolerance: float = 0.0
    goal_heading: float | None = None
    heading_tolerance: float = pi
    goal_trim: int | None = None
    max_trims: int = 4

    def __post_init__(self) -> None:
        """Refuses a task that cannot be stated."""
        if not all(isfinite(value) for value in self.goal):
            raise ValueError(f"goal must be finite, got {self.goal}")
        if not (isfinite(self.tolerance) and self.tolerance >= 0):
            raise ValueError(f"tolerance must be >= 0 m, got {self.tolerance} m")
        if not self.heading_tolerance >= 0:
            raise ValueError(f"heading_tolerance must be >= 0 rad, got {self.heading_tolerance} rad")
        if self.max_trims < 1:
            raise ValueError(f"max_trims must be >= 1, got {self.max_trims}")

    @property
    def destination(self) -> Destination:
        """Goal of the mission without the trim wanted there."""
        slack = slack_of(*self.start.position, *self.goal, self.tolerance)
        return Destination(self.goal, self.tolerance, self.goal_heading, self.heading_tolerance, slack)


def _check_magnitude(value: float, most: float, unit: str) -> float:
    if not abs(value) <= most:
        raise ValueError(f"expected a number from {-most:g} to {most:g} {unit}, got {value:g} {unit}")
    return value


Place = Annotated[FiniteFloat, AfterValidator(partial(_check_magnitude, most=MAX_COORDINATE, unit="m"))]
"""North or east in a file, metres."""

Heading = Annotated[FiniteFloat, AfterValidator(partial(_check_magnitude, most=MAX_HEADING, unit="rad"))]
"""A heading in a file, radians."""


def check_file_limits(mission: Mission) -> None:
    """Checks that a mission is within the limits of files.

    Raises:
        ValueError: it is not; names the part.
    """
    for value in (*mission.start.position, *mission.goal, mission.tolerance):
        _check_magnitude(value, MAX_COORDINATE, "m")
    for heading in (mission.start.heading, mission.goal_heading or 0.0):
        _check_magnitude(heading, MAX_HEADING, "rad")
    if mission.max_trims > MAX_TRIMS:
        raise ValueError(f"max_trims: expected at most {MAX_TRIMS}, got {mission.max_trims}")


class _Start(FileModel):
    position: tuple[Place, Place]
    heading: Heading
    trim: int


class _Goal(FileModel):
    position: tuple[Place, Place]
    tolerance: FiniteFloat = Field(ge=0, le=MAX_COORDINATE)
    heading: Heading | None = None
    heading_tolerance: FiniteFloat | None = Field(default=None, ge=0)
    trim: int | None = None

    @model_validator(mode="after")
    def _heading_with_tolerance(self) -> "_Goal":
        if (self.heading is None) != (self.heading_tolerance is None):
            raise ValueError("heading and heading_tolerance: expected both or none, got one")
        return self


class _Planner(FileModel):
    max_trims: PositiveInt = Field(default=4, le=MAX_TRIMS)


class _MissionFile(FileModel):
    schema_name: Annotated[str, schema_named(SCHEMA)] = Field(default=SCHEMA, alias="schema")
    name: str
    start: _Start
    goal: _Goal
    planner: _Planner = _Planner()


def read_mission(path: Path) -> Mission:
    """Reads `missions/NAME.toml`.

    Raises:
        BadFileError: the file is missing, is no TOML, or lacks or misnames a part.
    """
    content = read_toml(path, _MissionFile)
    tolerance = content.goal.heading_tolerance
    with refusing(path):
        return Mission(
            name=content.name,
            start=SE2(*content.start.position, content.start.heading),
            start_trim=content.start.trim,
            goal=content.goal.position,
            tolerance=content.goal.tolerance,
            goal_heading=content.goal.heading,
            heading_tolerance=pi if tolerance is None else tolerance,
            goal_trim=content.goal.trim,
            max_trims=content.planner.max_trims,
        )
