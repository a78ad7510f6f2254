"""Keeps what happens in a flight, and makes the flight log of it."""

from collections.abc import Mapping

import numpy as np

from flight.log import (
    COMMAND,
    CONTROLS,
    ESTIMATE,
    NAVIGATION,
    PRIMITIVE,
    TOPICS,
    TRUTH,
    WIND,
    FlightHeader,
    FlightLog,
    PrimitiveKind,
    Series,
    Topic,
)
from flight.trim import Trim

from .maneuver_generator import Reference
from .motion import Controls, Motion, Wind


class Recorder:
    """Collects rows, topic by topic.

    Args:
        height: that the controller holds, m.
    """

    def __init__(self, *, height: float) -> None:
        self._height = height
        # By name, because a topic's hash goes through all its fields.
        self._rows: dict[str, tuple[list[float], list[tuple[float, ...]]]] = {
            topic.name: ([], []) for topic in TOPICS
        }

    def _add(self, topic: Topic, time: float, row: tuple[float, ...]) -> None:
        times, rows = self._rows[topic.name]
        times.append(time)
        rows.append(row)

    def add_motion(self, time: float, *, truth: Motion, estimate: Motion, reference: Reference) -> None:
        """Notes the motion at a time, once."""
        times = self._rows[TRUTH.name][0]
        if times and times[-1] >= time:
            return
        self._add(TRUTH, time, truth)
        self._add(ESTIMATE, time, estimate)
        forward, side, yaw_rate = reference
        self._add(COMMAND, time, (forward.value, side.value, yaw_rate.value, self._height))

    def add_spread(self, time: float, sigmas: tuple[float, ...] | None) -> None:
        """Notes what the vehicle believes of its errors at a time; nothing where it knows of none."""
        if sigmas is not None:
            self._add(NAVIGATION, time, sigmas)

    def add_period(self, time: float, *, controls: Controls, servos: Controls, wind: Wind) -> None:
        """Notes what is held over the control period that begins."""
        row = (
            *(controls.collective, controls.longitudinal, controls.lateral, controls.pedal),
            *(servos.collective, servos.longitudinal, servos.lateral, servos.pedal),
        )
        self._add(CONTROLS, time, row)
        self._add(WIND, time, wind)

    def add_primitive(
        self, time: float, *, kind: PrimitiveKind, number: int, from_trim: int, to_trim: Trim, timed_out: bool
    ) -> None:
        """Notes the start of a coast or a maneuver."""
        target = to_trim.velocity
        self._add(
            PRIMITIVE,
            time,
            (kind, number, from_trim, to_trim.id, target.forward, target.side, target.yaw_rate, timed_out),
        )

    def log(self, header: FlightHeader, attachments: Mapping[str, bytes]) -> FlightLog:
        """Returns all that was noted as a flight log."""
        noted = (topic for topic in TOPICS if self._rows[topic.name][0])
        series = {topic.name: _series(topic, *self._rows[topic.name]) for topic in noted}
        return FlightLog(header, series, dict(attachments))


def _series(topic: Topic, times: list[float], rows: list[tuple[float, ...]]) -> Series:
    values = np.array(rows, dtype=np.float64).reshape(len(times), len(topic.fields))
    return Series(topic, np.array(times, dtype=np.float64), values)
