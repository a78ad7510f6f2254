"""Supervisor of the flight: alarms from readings, estimate and reference.

Injected faults and the truth are unknown to it. Each monitored value has a limit; beyond it an alarm is
raised, once a flight for each kind. Rejected innovations count as innovations at the filter's gate, so both
rejected and accepted wrong readings raise alarms.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import exp, hypot, inf, isfinite, isnan, sqrt
from types import MappingProxyType

from flight.automaton.library import Library
from flightlog.alarm import ADVICE, ALARM, Alarm, AlarmKind, alarm_series
from flightlog.log import FlightLog
from sim.loop.signals import Signals
from sim.loop.specification import CONTROL_PERIOD
from sim.navigation.filter import GATE
from sim.navigation.navigation import Navigation, Navigator
from sim.navigation.sensor_errors import sensor_errors
from sim.wind.turbulence_meter import AVERAGING_TIME, TurbulenceMeter
from sim.wind.wind_class import known_wind_class

PERIODS_PER_CHECK = 10
"""Control periods between two checks, equal to those between two fixes."""

_CHECK_INTERVAL = PERIODS_PER_CHECK * CONTROL_PERIOD
# Decay of running means over a check; their time constant is one second.
_DECAY = exp(-_CHECK_INTERVAL)

LIMITS: Mapping[AlarmKind, float] = MappingProxyType(
    {
        AlarmKind.NO_NUMBER: 0.0,
        AlarmKind.TILT: 0.55,
        AlarmKind.HEIGHT: 2.5,
        AlarmKind.VELOCITY: 0.9,
        AlarmKind.DESCENT: 1.0,
        AlarmKind.YAW_RATE: 0.4,
        AlarmKind.FIXES_AMISS: 2.5,
        AlarmKind.HEADING_AMISS: 3.5,
        AlarmKind.ALTIMETER_AMISS: 2.0,
        AlarmKind.FIXES_SILENT: 3.0,
        AlarmKind.HEADING_SILENT: 5.0,
        AlarmKind.ALTIMETER_SILENT: 5.0,
        AlarmKind.GYRO_STUCK: 0.15,
        AlarmKind.ACCELEROMETER_STUCK: 0.15,
        AlarmKind.FIXES_STUCK: 0.35,
        AlarmKind.HEADING_STUCK: 0.35,
        AlarmKind.ALTIMETER_STUCK: 0.35,
        AlarmKind.POSITION_UNKNOWN: 0.25,
        AlarmKind.TURBULENCE: inf,
    }
)
"""Limits by kind.

At most one flight in 200 of a fleet in wind class `gtmax` exceeds one without a fault, as printed by
`benchmarks.flight.alarm_limits`. Limits of missing and stuck readings are chosen: the filter bridges such
times. The limits of turbulence and of the unknown position depend on library and sensors (`alarm_limits`).
"""

TURBULENCE_FACTOR = 3.0
"""Turbulence limit over the wind of the library's wind class.

In 400 missions of a fleet the largest mean over ten seconds was 2.6 times that wind.
"""

FIXES_LIMITS: Mapping[str, float] = MappingProxyType({"gps": 4.0})
"""Limits of the fixes' innovations by sensor class, where not that of `LIMITS`.

The wander of `gps` is most of an innovation, so that its mean over a second is as wide as a single one.
"""

POSITION_FACTOR = 5.0
"""Limit of the claimed position error over that of one fix of the sensor class."""

_INNOVATIONS = frozenset({AlarmKind.FIXES_AMISS, AlarmKind.HEADING_AMISS, AlarmKind.ALTIMETER_AMISS})


def alarm_limits(library: Library, sensors: str = "rtk") -> Mapping[AlarmKind, float]:
    """Returns the limits for a library and a sensor class."""
    known = known_wind_class(library.conditions.wind)
    beyond = inf if known is None or not known.wind_at_20_ft else TURBULENCE_FACTOR * known.wind_at_20_ft
    errors, _ = sensor_errors(sensors)
    unknown = POSITION_FACTOR * hypot(errors.position_sigma, errors.position_sigma)
    return {
        **LIMITS,
        AlarmKind.TURBULENCE: beyond,
        AlarmKind.POSITION_UNKNOWN: unknown,
        AlarmKind.FIXES_AMISS: FIXES_LIMITS.get(sensors, LIMITS[AlarmKind.FIXES_AMISS]),
    }


class Supervisor:
    """Supervisor that checks a flight ten times a second.

    Args:
        signals: signals of the loop; truth and wind are not used.
        navigation: navigation with readings and innovations; ideal navigation has none.
        height: height held by the controller, m.
        limits: limits by kind.

    Attributes:
        alarms: alarms raised so far.
        largest: largest monitored values so far, by kind.
    """

    def __init__(
        self,
        signals: Signals,
        navigation: Navigator,
        *,
        height: float,
        limits: Mapping[AlarmKind, float] = LIMITS,
    ) -> None:
        self._estimate, self._reference = signals.estimate, signals.reference
        self._height, self._limits = height, limits
        self._squares = dict.fromkeys((AlarmKind.VELOCITY, AlarmKind.DESCENT, AlarmKind.YAW_RATE), 0.0)
        self._readings = _ReadingMonitor(navigation) if isinstance(navigation, Navigation) else None
        self._meter = TurbulenceMeter(_CHECK_INTERVAL)
        self._periods = 0
        self.alarms: list[Alarm] = []
        self.largest: dict[AlarmKind, float] = {}

    def run(self) -> None:
        """Checks a control period that has been flown."""
        self._periods += 1
        if self._readings is not None:
            self._readings.note()
        if self._periods % PERIODS_PER_CHECK == 0:
            self._check_limits()

    @property
    def turbulence(self) -> float | None:
        """Estimated wind at 20 ft in m/s; None if unknown."""
        if any(alarm.kind in _INNOVATIONS for alarm in self.alarms):
            return None
        return self._meter.wind_at_20_ft

    def first_alarm(self, *, after: float) -> Alarm | None:
        """Returns the first mission-ending alarm if raised after a time."""
        first = next((alarm for alarm in self.alarms if alarm.kind not in ADVICE), None)
        return first if first is not None and first.time > after else None

    def add_to(self, log: FlightLog) -> FlightLog:
        """Returns the log with the alarms, if any."""
        if not self.alarms:
            return log
        return replace(log, series={**log.series, ALARM.name: alarm_series(self.alarms)})

    def _check_limits(self) -> None:
        known = {alarm.kind for alarm in self.alarms}
        for kind, value in self._monitored_values():
            self.largest[kind] = max(value, self.largest.get(kind, 0.0))
            limit = self._limits[kind]
            # Also false for not-a-number.
            if not value <= limit and kind not in known:
                self.alarms.append(Alarm(self._periods * CONTROL_PERIOD, kind, value, limit))

    def _monitored_values(self) -> Iterator[tuple[AlarmKind, float]]:
        motion = self._estimate.tolist()
        if not all(map(isfinite, motion)):
            yield AlarmKind.NO_NUMBER, 1.0
            return
        _, _, down, forward, side, descent, roll, pitch, *_, yaw_rate = motion
        reference = self._reference.tolist()
        yield AlarmKind.TILT, max(abs(roll), abs(pitch))
        yield AlarmKind.HEIGHT, abs(-down - self._height)
        off = {
            AlarmKind.VELOCITY: hypot(forward - reference[0], side - reference[3]),
            AlarmKind.DESCENT: descent,
            AlarmKind.YAW_RATE: yaw_rate - reference[6],
        }
        for kind, error in off.items():
            mean = _DECAY * self._squares[kind] + (1.0 - _DECAY) * error**2
            self._squares[kind] = mean
            yield kind, sqrt(mean)
        self._meter.update(descent, yaw_rate=reference[6])
        # Earlier means are of too few gusts to blame the wind.
        averaged = self._periods * CONTROL_PERIOD >= AVERAGING_TIME
        if averaged and (turbulence := self.turbulence) is not None:
            yield AlarmKind.TURBULENCE, turbulence
        if self._readings is not None:
            yield from self._readings.monitored_values()


class _ReadingMonitor:
    """Monitor of sensor readings and filter innovations."""

    def __init__(self, navigation: Navigation) -> None:
        self._navigation = navigation
        self._fixed = self._seen = False
        self._means = [0.0] * (len(navigation.fix_tests) + len(navigation.slow_tests))
        sensors = navigation.sensors
        self._inertial = {AlarmKind.GYRO_STUCK: slice(3, 6), AlarmKind.ACCELEROMETER_STUCK: slice(0, 3)}
        self._last: dict[AlarmKind, object] = {
            kind: sensors.inertial[part].tobytes() for kind, part in self._inertial.items()
        }
        self._stuck: dict[AlarmKind, float] = {}
        self._silent: dict[AlarmKind, float] = {}

    def note(self) -> None:
        """Records which readings a control period brought."""
        sensors = self._navigation.sensors
        self._fixed |= sensors.has_fix
        self._seen |= sensors.has_heading_and_height

    def monitored_values(self) -> Iterator[tuple[AlarmKind, float]]:
        """Yields the monitored values since the last check."""
        sensors = self._navigation.sensors
        for kind, part in self._inertial.items():
            yield kind, self._unchanged(kind, sensors.inertial[part].tobytes())
        heading, height = sensors.heading_and_height.tolist()
        fresh = (
            (AlarmKind.FIXES_SILENT, AlarmKind.FIXES_STUCK, self._fixed, sensors.fix.tobytes()),
            (
                AlarmKind.HEADING_SILENT,
                AlarmKind.HEADING_STUCK,
                self._seen and not isnan(heading),
                heading,
            ),
            (
                AlarmKind.ALTIMETER_SILENT,
                AlarmKind.ALTIMETER_STUCK,
                self._seen and not isnan(height),
                height,
            ),
        )
        for silent, stuck, arrived, reading in fresh:
            self._silent[silent] = 0.0 if arrived else self._silent.get(silent, 0.0) + _CHECK_INTERVAL
            yield silent, self._silent[silent]
            if arrived:
                yield stuck, self._unchanged(stuck, reading)
        yield from self._innovations()
        self._fixed = self._seen = False
        north, east, *_ = self._navigation.standard_deviation()
        yield AlarmKind.POSITION_UNKNOWN, hypot(north, east)

    def _unchanged(self, kind: AlarmKind, reading: object) -> float:
        """Returns the time of bitwise unchanged readings, seconds."""
        same = reading == self._last.get(kind)
        self._stuck[kind] = self._stuck.get(kind, 0.0) + _CHECK_INTERVAL if same else 0.0
        self._last[kind] = reading
        return self._stuck[kind]

    def _innovations(self) -> Iterator[tuple[AlarmKind, float]]:
        """Yields the running means of innovations, in standard deviations."""
        fix = self._navigation.fix_tests.tolist() if self._fixed else ()
        slow = self._navigation.slow_tests.tolist() if self._seen else ()
        count = len(self._navigation.fix_tests)
        for place, test in (*enumerate(fix), *enumerate(slow, start=count)):
            if not isnan(test):
                self._means[place] = _DECAY * self._means[place] + (1.0 - _DECAY) * max(
                    -GATE, min(GATE, test)
                )
        *fixes, heading, height = map(abs, self._means)
        yield AlarmKind.FIXES_AMISS, max(fixes)
        yield AlarmKind.HEADING_AMISS, heading
        yield AlarmKind.ALTIMETER_AMISS, height
