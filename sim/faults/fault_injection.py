"""Fault injection into the flight loop, with logged effects."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from flight.mission.fault import SENSORS, SERVOS, Fault
from flightlog.attachment_names import FAULTS_ATTACHMENT
from flightlog.fault_record import faults_text
from flightlog.log import FlightLog
from flightlog.series import Series, Topic
from flightlog.topics import FAULT, FAULT_EFFECT
from sim.loop.signals import Signals
from sim.loop.specification import CONTROL_PERIOD
from sim.navigation.navigation import Navigation, Navigator
from sim.vehicle.helicopter import Helicopter
from sim.vehicle.parameters import Parameters

from .delayed_computer import DelayedComputer
from .fault_schedule import FaultSchedule, FaultTarget
from .gust_fault import GustInjector
from .sensor_faults import FaultySensors
from .vehicle_faults import FaultyVehicle

_SIZES = 3
Parts = tuple[Callable[[], None], ...]
"""Parts of the loop in the order of their run, each for one control period."""


class FaultInjector:
    """Injector of a flight's faults into the loop's parts.

    Args:
        faults: faults of the flight, numbered from 1; the flight is at time 0.
        signals: signals of the loop.
        helicopter: helicopter flown.
        parameters: vehicle without faults.
        navigation: navigation; its sensors can fail.
        parts: one period each of maneuver generator, controller and wind.

    Attributes:
        parts: the same parts with faults.
    """

    def __init__(
        self,
        faults: Sequence[Fault],
        *,
        signals: Signals,
        helicopter: Helicopter,
        parameters: Parameters,
        navigation: Navigator,
        parts: Parts,
    ) -> None:
        generate, control, blow = parts
        air, vehicle = GustInjector(blow, signals.wind), FaultyVehicle(helicopter, parameters)
        computer = DelayedComputer((generate, control), signals.controls, step=CONTROL_PERIOD)
        self.parts: Parts = (computer.run, air.run)
        places: dict[str, FaultTarget] = {"wind": air, "controller": computer, "vehicle": vehicle}
        places |= dict.fromkeys(SERVOS, vehicle)
        if isinstance(navigation, Navigation):
            sensors = FaultySensors(navigation.sensors, step=CONTROL_PERIOD)
            navigation.sensors = sensors
            places |= dict.fromkeys(SENSORS, sensors)
        self._faults = dict(enumerate(faults, start=1))
        self._schedule = FaultSchedule(self._faults, places)
        self._period = 0
        self._events: list[tuple[float, ...]] = []
        self._effects: list[tuple[float, ...]] = []

    def begin(self) -> None:
        """Starts and ends the faults due at a control period."""
        for number, begun in self._schedule.begin(self._period):
            size = self._faults[number].size
            padded = (*size, *(0.0,) * (_SIZES - len(size)))
            self._events.append((self._period * CONTROL_PERIOD, number, float(begun), *padded))

    def note(self) -> None:
        """Records the effects over the control period flown."""
        time = self._period * CONTROL_PERIOD
        self._effects += [(time, number, effect()) for number, effect in self._schedule.active.items()]
        self._period += 1

    def add_to(self, log: FlightLog) -> FlightLog:
        """Returns the log with the faults and their effects."""
        series = {
            topic.name: _series(topic, rows)
            for topic, rows in ((FAULT, self._events), (FAULT_EFFECT, self._effects))
        }
        text = faults_text(tuple(self._faults.values()))
        return replace(
            log, series={**log.series, **series}, attachments={**log.attachments, FAULTS_ATTACHMENT: text}
        )


def _series(topic: Topic, rows: list[tuple[float, ...]]) -> Series:
    table = np.array(rows, dtype=np.float64).reshape(len(rows), 1 + len(topic.fields))
    return Series(topic, table[:, 0], table[:, 1:])
