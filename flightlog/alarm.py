"""Alarms of the supervised vehicle, a topic of the flight log."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from .series import Field, Series, Topic


class AlarmKind(IntEnum):
    """Values of `/alarm` `kind`."""

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
"""Alarms that do not end a mission: no defect, but conditions outside those of the library's data."""


MEANINGS: dict[AlarmKind, tuple[str, str]] = {
    AlarmKind.NO_NUMBER: ("estimate not finite", "-"),
    AlarmKind.TILT: ("roll or pitch", "rad"),
    AlarmKind.HEIGHT: ("height error", "m"),
    AlarmKind.VELOCITY: ("horizontal velocity error, root mean square", "m/s"),
    AlarmKind.DESCENT: ("vertical velocity, root mean square", "m/s"),
    AlarmKind.YAW_RATE: ("yaw rate error, root mean square", "rad/s"),
    AlarmKind.FIXES_AMISS: ("innovation of the fixes, mean in standard deviations", "-"),
    AlarmKind.HEADING_AMISS: ("innovation of the heading, mean in standard deviations", "-"),
    AlarmKind.ALTIMETER_AMISS: ("innovation of the altimeter, mean in standard deviations", "-"),
    AlarmKind.FIXES_SILENT: ("time without a fix", "s"),
    AlarmKind.HEADING_SILENT: ("time without a heading reading", "s"),
    AlarmKind.ALTIMETER_SILENT: ("time without an altimeter reading", "s"),
    AlarmKind.GYRO_STUCK: ("gyro reading bitwise unchanged", "s"),
    AlarmKind.ACCELEROMETER_STUCK: ("accelerometer reading bitwise unchanged", "s"),
    AlarmKind.FIXES_STUCK: ("fixes bitwise unchanged", "s"),
    AlarmKind.HEADING_STUCK: ("heading reading bitwise unchanged", "s"),
    AlarmKind.ALTIMETER_STUCK: ("altimeter reading bitwise unchanged", "s"),
    AlarmKind.POSITION_UNKNOWN: ("claimed standard deviation of the position", "m"),
    AlarmKind.TURBULENCE: ("wind at 20 ft, estimated from turbulence", "m/s"),
}
"""Monitored quantity of each kind, and its unit."""

ALARM = Topic(
    "/alarm",
    "maneuver.Alarm",
    "one message at the first alarm of each kind; absent without alarms",
    (
        Field("kind", "-", "; ".join(f"{kind.value} {words}" for kind, (words, _) in MEANINGS.items())),
        Field("value", "as its kind", "monitored value"),
        Field("limit", "as its kind", "largest value allowed"),
    ),
)


@dataclass(frozen=True, slots=True)
class Alarm:
    """One alarm: time in seconds, kind, value and its limit."""

    time: float
    kind: AlarmKind
    value: float
    limit: float

    @property
    def sentence(self) -> str:
        """Monitored quantity, value and limit as text."""
        words, unit = MEANINGS[self.kind]
        unit = f" {unit}".removesuffix(" -")
        return f"{words}: {self.value:.3g}{unit}, limit {self.limit:g}{unit}"


def alarm_series(alarms: Sequence[Alarm]) -> Series:
    """Returns alarms, in the order of their times, as messages."""
    rows = [(float(a.kind), a.value, a.limit) for a in alarms]
    values = np.array(rows, dtype=np.float64).reshape(len(rows), len(ALARM.fields))
    return Series(ALARM, np.array([a.time for a in alarms], dtype=np.float64), values)


def alarms_from_series(series: Series) -> tuple[Alarm, ...]:
    """Returns the alarms of a log's topic."""
    rows = zip(series.time.tolist(), series.values.tolist(), strict=True)
    return tuple(Alarm(time, AlarmKind(int(row[0])), row[1], row[2]) for time, row in rows)
