"""Library from kinematics: average accelerations, assumed durations and percent errors.

Thesis, 2.6.1 and 3.2.1: with T the duration, the heading changes by half the sum of both yaw rates times T,
and the displacement is that of a constant acceleration from the velocity left to the velocity reached, the
latter rotated by the heading change. An error is the difference of the same equations with and without the
assumed errors of velocities and duration.
"""

from math import cos, sin
from pathlib import Path

from pydantic import Field, FiniteFloat

from flight.automaton.conditions import Conditions
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.schema import FileModel, read_toml, refusing
from flight.se2 import SE2, Twist


def average_displacement(left: Twist, reached: Twist, duration: float) -> SE2:
    """Returns a maneuver's displacement in the body frame at entry."""
    turned = 0.5 * (left.yaw_rate + reached.yaw_rate) * duration
    # The thesis assumes zero side velocities; otherwise the velocity reached rotates as a vector.
    forward = reached.forward * cos(turned) - reached.side * sin(turned)
    side = reached.forward * sin(turned) + reached.side * cos(turned)
    half = 0.5 * duration
    return SE2(half * (left.forward + forward), half * (left.side + side), turned)


def kinematic_maneuver(
    number: int, left: Trim, reached: Trim, *, duration: float, duration_error: float
) -> Maneuver:
    """Returns the maneuver between two trims with its signed errors.

    Args:
        number: id of the maneuver.
        left: trim left, with its signed error.
        reached: trim reached, with its signed error.
        duration: seconds.
        duration_error: signed, seconds.
    """
    moved = average_displacement(left.velocity, reached.velocity, duration)
    off = average_displacement(left.at(1.0), reached.at(1.0), duration + duration_error)
    return Maneuver(
        id=number,
        from_trim=left.id,
        to_trim=reached.id,
        duration=duration,
        displacement=moved,
        error=ManeuverError(duration_error, off.x - moved.x, off.y - moved.y, off.heading - moved.heading),
    )


class _Percent(FileModel):
    forward: FiniteFloat = Field(default=0.0, ge=0)
    side: FiniteFloat = Field(default=0.0, ge=0)
    yaw_rate: FiniteFloat = Field(default=0.0, ge=0)


class _Trim(FileModel):
    id: int
    name: str
    forward: FiniteFloat
    side: FiniteFloat = 0.0
    yaw_rate: FiniteFloat = 0.0
    percent: _Percent = _Percent()


class _Maneuver(FileModel):
    id: int
    from_trim: int = Field(alias="from")
    to_trim: int = Field(alias="to")
    duration: FiniteFloat = Field(ge=0)
    error: FiniteFloat = 0.0


class _File(FileModel):
    name: str
    description: str = "By kinematics: average accelerations, assumed durations and percent errors"
    trims: list[_Trim] = Field(min_length=1)
    maneuvers: list[_Maneuver] = Field(default_factory=list)


def read_kinematic_library(path: Path) -> Library:
    """Reads trims, durations and percent errors; returns their library.

    Raises:
        BadFileError: the file is missing, is not TOML, or is inconsistent; the message names the place.
    """
    content = read_toml(path, _File)
    with refusing(path):
        return _build(content)


def _build(content: _File) -> Library:
    trims = {row.id: _trim(row) for row in content.trims}
    for row in content.maneuvers:
        for trim in (row.from_trim, row.to_trim):
            if trim not in trims:
                raise ValueError(f"maneuver {row.id}: no trim {trim}; there are {sorted(trims)}")
        if row.duration + row.error < 0:
            raise ValueError(
                f"maneuver {row.id}: expected duration + error >= 0 s, got {row.duration + row.error:g} s"
            )
    return Library(
        name=content.name,
        description=content.description,
        vehicle="planar kinematic model",
        trims=tuple(_trim(row) for row in content.trims),
        maneuvers=tuple(
            kinematic_maneuver(
                row.id,
                trims[row.from_trim],
                trims[row.to_trim],
                duration=row.duration,
                duration_error=row.error,
            )
            for row in content.maneuvers
        ),
        conditions=Conditions(trim_error_kind="assumed"),
        provenance={"method": "kinematics of the thesis, sections 2.6.1 and 3.2.1"},
    )


def _trim(row: _Trim) -> Trim:
    velocity = Twist(row.forward, row.side, row.yaw_rate)
    share = row.percent
    # Adding 0 changes -0.0 into 0.0.
    error = Twist(
        share.forward * row.forward / 100 + 0.0,
        share.side * row.side / 100 + 0.0,
        share.yaw_rate * row.yaw_rate / 100 + 0.0,
    )
    return Trim(row.id, row.name, velocity, error)
