"""What a vehicle says of itself when something is wrong: alarms, a topic of the flight log."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from .topic import Field, Series, Topic


class AlarmKind(IntEnum):
    """Values of `/alarm` `kind`: what was watched."""

    NO_NUMBER = 0
    TILT = 1
    HEIGHT = 2
    VELOCITY = 3
    DESCENT = 4
    YAW_RATE = 5
    FIXES_AMISS = 6
    HEADING_AMISS = 7
    ALTIMETER_AMISS = 8
    FIXES_SILENT = 9
    HEADING_SILENT = 10
    ALTIMETER_SILENT = 11
    GYRO_STUCK = 12
    ACCELEROMETER_STUCK = 13
    FIXES_STUCK = 14
    HEADING_STUCK = 15
    ALTIMETER_STUCK = 16
    POSITION_UNKNOWN = 17
    TURBULENCE = 18


ADVICE = frozenset({AlarmKind.TURBULENCE})
"""Alarms that do not end a mission: the vehicle is well, but outside what its library was identified in."""


MEANINGS: dict[AlarmKind, tuple[str, str]] = {
    AlarmKind.NO_NUMBER: ("the estimate is no number", "-"),
    AlarmKind.TILT: ("roll or pitch", "rad"),
    AlarmKind.HEIGHT: ("height off the one held", "m"),
    AlarmKind.VELOCITY: ("horizontal velocity off the one asked for, root mean square", "m/s"),
    AlarmKind.DESCENT: ("vertical velocity, root mean square", "m/s"),
    AlarmKind.YAW_RATE: ("yaw rate off the one asked for, root mean square", "rad/s"),
    AlarmKind.FIXES_AMISS: ("fixes off the estimate, mean in standard deviations", "-"),
    AlarmKind.HEADING_AMISS: ("heading read off the estimate, mean in standard deviations", "-"),
    AlarmKind.ALTIMETER_AMISS: ("height read off the estimate, mean in standard deviations", "-"),
    AlarmKind.FIXES_SILENT: ("no fix", "s"),
    AlarmKind.HEADING_SILENT: ("no heading read", "s"),
    AlarmKind.ALTIMETER_SILENT: ("no height read", "s"),
    AlarmKind.GYRO_STUCK: ("gyro reads the same to the bit", "s"),
    AlarmKind.ACCELEROMETER_STUCK: ("accelerometer reads the same to the bit", "s"),
    AlarmKind.FIXES_STUCK: ("fixes are the same to the bit", "s"),
    AlarmKind.HEADING_STUCK: ("heading reads the same to the bit", "s"),
    AlarmKind.ALTIMETER_STUCK: ("altimeter reads the same to the bit", "s"),
    AlarmKind.POSITION_UNKNOWN: ("standard deviation of the position, as the filter claims it", "m"),
    AlarmKind.TURBULENCE: ("wind at 20 ft, as the turbulence shows it", "m/s"),
}
"""What is watched, and its unit."""

ALARM = Topic(
    "/alarm",
    "maneuver.Alarm",
    "one message where the vehicle first finds something wrong with itself, of each kind; absent without one",
    (
        Field("kind", "-", "; ".join(f"{kind.value} {words}" for kind, (words, _) in MEANINGS.items())),
        Field("value", "as its kind", "what was found"),
        Field("limit", "as its kind", "what is allowed"),
    ),
)


@dataclass(frozen=True, slots=True)
class Alarm:
    """One alarm: seconds since the start, what is wrong, and by how much, beside what is allowed."""

    time: float
    kind: AlarmKind
    value: float
    limit: float

    @property
    def sentence(self) -> str:
        """What is wrong, for people."""
        words, unit = MEANINGS[self.kind]
        unit = f" {unit}".removesuffix(" -")
        return f"{words}: {self.value:.3g}{unit}, allowed {self.limit:g}{unit}"


def alarm_series(alarms: Sequence[Alarm]) -> Series:
    """Returns alarms as a topic's messages; they come in the order of their times."""
    rows = [(float(a.kind), a.value, a.limit) for a in alarms]
    values = np.array(rows, dtype=np.float64).reshape(len(rows), len(ALARM.fields))
    return Series(ALARM, np.array([a.time for a in alarms], dtype=np.float64), values)


def alarms_from_series(series: Series) -> tuple[Alarm, ...]:
    """Returns the alarms of a log's topic."""
    rows = zip(series.time.tolist(), series.values.tolist(), strict=True)
    return tuple(Alarm(time, AlarmKind(int(row[0])), row[1], row[2]) for time, row in rows)
