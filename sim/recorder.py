"""Keeps what happens in a flight, and makes the flight log of it."""

from collections.abc import Mapping
from math import hypot

import numpy as np
from jaxtyping import Float

from flight.automaton.trim import Trim
from flightlog.channels import COMMAND, CONTROLS, ESTIMATE, NAVIGATION, PRIMITIVE, TRUTH, WIND
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveKind
from flightlog.topic import Series, Topic
from sim.loop.bound_function import Array, memory_view
from sim.loop.motion import Controls, Motion
from sim.loop.signals import Signals
from sim.loop.specification import CONTROL_RATE

# Motion is logged at every second control period, what the vehicle believes of its errors at every tenth.
PERIODS_PER_SAMPLE, PERIODS_PER_NAVIGATION_SAMPLE = 2, 10
# Rows of memory that are taken at first.
_ROWS = 4096
_HEADING = Motion._fields.index("heading")
# Columns of `Signals.motion` and `Signals.period` in the order of the topics.
_MOTION = len(Motion._fields)
_COMMAND_COLUMNS = [2 * _MOTION, 2 * _MOTION + 3, 2 * _MOTION + 6]
_LOGGED = [Controls._fields.index(name) for name in ("collective", "longitudinal", "lateral", "pedal")]
_CONTROLS = len(Controls._fields)
_CONTROLS_COLUMNS = [*_LOGGED, *(_CONTROLS + place for place in _LOGGED)]


class Recorder:
    """Collects a row every control period.

    Args:
        signals: what is kept.
        height: that the controller holds, m.
    """

    def __init__(self, signals: Signals, *, height: float) -> None:
        self._height = height
        self._motion, self._period = _Rows(signals.motion), _Rows(signals.period)
        self._primitives: list[tuple[float, ...]] = []
        self._spreads: list[tuple[float, ...]] = []
        # Control periods at which a primitive begins.
        self._beginnings: list[int] = []
        self.add_motion, self.add_period = self._motion.add, self._period.add

    def add_primitive(
        self, *, kind: PrimitiveKind, number: int, from_trim: int, to_trim: Trim, timed_out: bool
    ) -> None:
        """Notes that a coast or a maneuver starts now."""
        target = to_trim.velocity
        self._beginnings.append(len(self._motion) - 1)
        self._primitives.append(
            (kind, number, from_trim, to_trim.id, target.forward, target.side, target.yaw_rate, timed_out)
        )

    def add_standard_deviation(self, sigmas: tuple[float, ...] | None) -> None:
        """Notes what the vehicle believes of its errors now; nothing where it knows of none."""
        if sigmas is not None:
            self._spreads.append(sigmas)

    def tracks(self, first: int, last: int) -> tuple[Float[np.ndarray, "n 4"], Float[np.ndarray, "n 4"]]:
        """Returns time, north, east and heading, true and believed.

        A row for every second control period, and the last.
        """
        periods = np.append(np.arange(first, last, PERIODS_PER_SAMPLE), last)
        truth, estimate = np.split(self._motion.values()[periods][:, : 2 * _MOTION], 2, axis=1)
        times = periods / CONTROL_RATE
        true, believed = (
            np.column_stack([times, motion[:, :2], motion[:, _HEADING]]) for motion in (truth, estimate)
        )
        return true, believed

    def standard_deviation(self, first: int, last: int) -> float:
        """Returns the largest standard deviation of the horizontal position that was claimed, in metres."""
        rows = self._spreads[
            first // PERIODS_PER_NAVIGATION_SAMPLE : last // PERIODS_PER_NAVIGATION_SAMPLE + 1
        ]
        return max((hypot(north, east) for north, east, *_ in rows), default=0.0)

    def log(self, header: FlightHeader, attachments: Mapping[str, bytes]) -> FlightLog:
        """Returns all that was noted as a flight log."""
        motion, period = self._motion.values(), self._period.values()
        last = len(motion) - 1
        sampled = np.array(sorted({*range(0, last, PERIODS_PER_SAMPLE), *self._beginnings, last}))
        moments, motion = sampled / CONTROL_RATE, motion[sampled]
        command = np.column_stack([motion[:, _COMMAND_COLUMNS], np.full(len(motion), self._height)])
        beginnings = np.array(self._beginnings, dtype=np.int64) / CONTROL_RATE
        times = np.arange(len(period)) / CONTROL_RATE
        spreads = PERIODS_PER_NAVIGATION_SAMPLE * np.arange(len(self._spreads)) / CONTROL_RATE
        series = (
            Series(COMMAND, moments, command),
            Series(ESTIMATE, moments, motion[:, _MOTION : 2 * _MOTION]),
            Series(TRUTH, moments, motion[:, :_MOTION]),
            Series(WIND, times, period[:, 2 * _CONTROLS :]),
            Series(CONTROLS, times, period[:, _CONTROLS_COLUMNS]),
            Series(PRIMITIVE, beginnings, _rows(PRIMITIVE, self._primitives)),
            Series(NAVIGATION, spreads, _rows(NAVIGATION, self._spreads)),
        )
        noted = {each.topic.name: each for each in series if len(each)}
        return FlightLog(header, noted, dict(attachments))


class _Rows:
    """Copies of an array that changes, one below the other."""

    def __init__(self, source: Array) -> None:
        self._source, self._width = memory_view(source), len(source)
        self._memory = np.empty(_ROWS * self._width)
        self._view, self._end = memory_view(self._memory), 0

    def __len__(self) -> int:
        return self._end // self._width

    def add(self) -> None:
        """Copies the array as it is now."""
        if self._end == len(self._memory):
            # Twice as much, so that a row is copied once on the average, however long the flight.
            self._memory = np.concatenate([self._memory, np.empty_like(self._memory)])
            self._view = memory_view(self._memory)
        end = self._end + self._width
        self._view[self._end : end] = self._source
        self._end = end

    def values(self) -> Float[np.ndarray, "n width"]:
        """Returns all copies, not to be written to."""
        return self._memory[: self._end].reshape(-1, self._width)


def _rows(topic: Topic, rows: list[tuple[float, ...]]) -> Float[np.ndarray, "n fields"]:
    return np.array(rows, dtype=np.float64).reshape(len(rows), len(topic.fields))
