"""Sensor faults: readings changed before the filter."""

from collections import deque
from collections.abc import Callable
from typing import Protocol

import numpy as np

from flight.mission.fault import SENSORS, Fault
from flight.se2 import SE2
from sim.navigation.sensors import SensorReadings, Values

_INERTIAL = ("gyro", "accelerometer")


class _SensorFault(Protocol):
    """Fault of one sensor."""

    effect: float

    def apply(self, values: Values, *, fresh: bool) -> bool:
        """Changes a reading in place; returns True if it is new.

        Args:
            values: the reading.
            fresh: whether it is a new reading.
        """


class _Dropout:
    def __init__(self) -> None:
        self.effect = 0.0

    def apply(self, values: Values, *, fresh: bool) -> bool:
        self.effect += fresh
        return False


class _Stuck:
    def __init__(self, held: Values | None) -> None:
        self._held, self.effect = held, 0.0

    def apply(self, values: Values, *, fresh: bool) -> bool:
        if fresh:
            if self._held is None:
                self._held = values.copy()
            self.effect = _reading_distance(values, self._held)
            values[:] = self._held
        return fresh


class _Bias:
    def __init__(self, size: tuple[float, ...]) -> None:
        self._size, self.effect = size, 0.0

    def apply(self, values: Values, *, fresh: bool) -> bool:
        if fresh:
            values[: len(self._size)] += self._size
            self.effect = float(np.linalg.norm(self._size))
        return fresh


class _Delay:
    def __init__(self, periods: int) -> None:
        self._periods, self._now, self.effect = periods, 0, 0.0
        self._sound: Values | None = None
        self._on_its_way: deque[tuple[int, Values]] = deque()

    def apply(self, values: Values, *, fresh: bool) -> bool:
        self._now += 1
        if fresh:
            self._sound = values.copy()
            self._on_its_way.append((self._now + self._periods, self._sound))
        if not (self._on_its_way and self._on_its_way[0][0] <= self._now):
            return False
        values[:] = self._on_its_way.popleft()[1]
        if self._sound is not None:
            self.effect = _reading_distance(values, self._sound)
        return True


def _reading_distance(values: Values, sound: Values) -> float:
    """Returns the distance of two readings; of positions for fixes."""
    return float(np.linalg.norm((values - sound)[:3]))


class FaultySensors:
    """Sensors with faults.

    Args:
        sensors: sensors without faults; their readings are changed in place.
        step: control period, s.
    """

    def __init__(self, sensors: SensorReadings, *, step: float) -> None:
        self._sensors, self._step = sensors, step
        self.inertial, self.fix = sensors.inertial, sensors.fix
        self.heading_and_height = sensors.heading_and_height
        self.has_fix = self.has_heading_and_height = False
        parts = (
            *(self.inertial[3:], self.inertial[:3], self.fix),
            *(self.heading_and_height[:1], self.heading_and_height[1:]),
        )
        self._values = dict(zip(SENSORS, parts, strict=True))
        # The inertial unit's registers hold values from the start.
        self._last = {sensor: self._values[sensor].copy() for sensor in _INERTIAL}
        self._failures: dict[str, dict[int, _SensorFault]] = {sensor: {} for sensor in SENSORS}

    @property
    def biases(self) -> Values:
        """Biases of accelerometers and gyros."""
        return self._sensors.biases

    def move_world(self, displacement: SE2) -> None:
        """Applies a displacement of the whole world."""
        self._sensors.move_world(displacement)

    def begin(self, number: int, fault: Fault) -> Callable[[], float]:
        """Starts a fault at the next reading; returns its effect function."""
        failure = self._sensor_fault(fault)
        self._failures[fault.where][number] = failure
        return lambda: failure.effect

    def end(self, number: int, fault: Fault) -> None:
        """Ends one fault of a sensor."""
        del self._failures[fault.where][number]

    def _sensor_fault(self, fault: Fault) -> _SensorFault:
        match fault.what:
            case "dropout":
                return _Dropout()
            case "stuck":
                return _Stuck(self._last.get(fault.where))
            case "bias":
                return _Bias(fault.size)
            case _:
                return _Delay(round(fault.size[0] / self._step))

    def run(self) -> None:
        """Reads the sensors at the end of a control period."""
        self._sensors.run()
        fix, slow = self._sensors.has_fix, self._sensors.has_heading_and_height
        fresh = dict(zip(SENSORS, (True, True, fix, slow, slow), strict=True))
        for sensor, values in self._values.items():
            for failure in self._failures[sensor].values():
                fresh[sensor] = failure.apply(values, fresh=fresh[sensor])
            if fresh[sensor]:
                self._last[sensor] = values.copy()
            elif sensor in _INERTIAL:
                values[:] = self._last[sensor]
            elif sensor != "gps":
                # The filter rejects not-a-number.
                values[:] = np.nan
        self.has_fix = fresh["gps"]
        self.has_heading_and_height = fresh["magnetometer"] or fresh["altimeter"]
