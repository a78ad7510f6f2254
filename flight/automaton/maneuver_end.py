"""Maneuver-end rule, one for identification and execution.

The body velocity and yaw rate are inside the next trim's band, without leaving it, for a dwell time; the end
is the end of the dwell. A maneuver that does not end before the time-out is counted as timed out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from math import isfinite
from typing import Annotated

from pydantic import Field, NonNegativeFloat, PositiveFloat

from flight.file_value import FileValue, InForm
from flight.se2 import Twist


@dataclass(frozen=True, slots=True)
class Band:
    """Half widths around a trim's velocity: m/s, m/s, rad/s."""

    forward: float
    side: float
    yaw_rate: float

    def __post_init__(self) -> None:
        """Refuses a band that nothing can be inside of."""
        if not all(isfinite(width) and width > 0 for width in (self.forward, self.side, self.yaw_rate)):
            raise ValueError(f"half widths of a band must be > 0, got {self}")

    def contains(self, velocity: Twist, target: Twist) -> bool:
        """Returns True where a velocity is inside the band around a target."""
        return (
            abs(velocity.forward - target.forward) <= self.forward
            and abs(velocity.side - target.side) <= self.side
            and abs(velocity.yaw_rate - target.yaw_rate) <= self.yaw_rate
        )


@dataclass(frozen=True, slots=True)
class BandRow(FileValue):
    """Half widths around one trim's velocity."""

    trim: int
    forward: Annotated[PositiveFloat, Field(description="metres per second")]
    side: Annotated[PositiveFloat, Field(description="metres per second")]
    yaw_rate: Annotated[PositiveFloat, Field(description="radians per second")]


def _by_trim(rows: Sequence[BandRow]) -> dict[int, Band]:
    bands = {row.trim: Band(row.forward, row.side, row.yaw_rate) for row in rows}
    if len(bands) != len(rows):
        raise ValueError(f"expected one for each trim, got {sorted(row.trim for row in rows)}")
    return bands


def _rows(bands: Mapping[int, Band]) -> tuple[BandRow, ...]:
    return tuple(
        BandRow(trim, band.forward, band.side, band.yaw_rate) for trim, band in sorted(bands.items())
    )


@dataclass(frozen=True)
class ManeuverEnd(FileValue):
    """Numbers of the maneuver-end rule: bands, dwell and time-out in seconds."""

    bands: Annotated[
        Mapping[int, Band],
        InForm(Annotated[tuple[BandRow, ...], Field(min_length=1)], _by_trim, _rows),
        Field(alias="band"),
    ]
    dwell: NonNegativeFloat
    timeout: PositiveFloat

    def __post_init__(self) -> None:
        """Refuses times that order wrongly."""
        if not 0 <= self.dwell < self.timeout:
            raise ValueError(
                f"dwell and timeout must satisfy 0 <= dwell < timeout, got {self.dwell} s, {self.timeout} s"
            )


class ManeuverStatus(Enum):
    """Status of a maneuver after a sample."""

    UNDER_WAY = "under way"
    ENDED = "ended"
    TIMED_OUT = "timed out"


class ManeuverEndDetector:
    """Applies the rule to one maneuver, sample by sample.

    Args:
        rule: dwell and time-out.
        to_trim: id of the trim that the maneuver leads to; its band is used.
        target: nominal velocity of that trim.
        entry_time: time of the command change in seconds.
    """

    def __init__(self, rule: ManeuverEnd, *, to_trim: int, target: Twist, entry_time: float) -> None:
        self._band = rule.bands[to_trim]
        self._target = target
        # Half a microsecond of slack: sample times are sums of steps, the dwell a decimal number.
        self._dwell = rule.dwell - 5e-7
        self._deadline = entry_time + rule.timeout - 5e-7
        self._inside_since: float | None = None

    def update(self, time: float, velocity: Twist) -> ManeuverStatus:
        """Takes a body velocity and returns the maneuver's status; times never decrease."""
        if not self._band.contains(velocity, self._target):
            self._inside_since = None
        elif self._inside_since is None:
            self._inside_since = time
        if self._inside_since is not None and time - self._inside_since >= self._dwell:
            return ManeuverStatus.ENDED
        return ManeuverStatus.TIMED_OUT if time >= self._deadline else ManeuverStatus.UNDER_WAY
