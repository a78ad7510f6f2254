"""Recorder of a flight, and its flight log."""

from collections.abc import Mapping
from math import hypot

import numpy as np
from jaxtyping import Float

from flight.automaton.trim import Trim
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.primitives import PrimitiveKind
from flightlog.series import Series, Topic
from flightlog.topics import COMMAND, CONTROLS, ESTIMATE, NAVIGATION, PRIMITIVE, TRUTH, WIND
from sim.loop.bound_function import Array, memory_view
from sim.loop.motion import Controls, Motion
from sim.loop.signals import Signals
from sim.loop.specification import CONTROL_RATE

# Motion is logged every second control period, standard deviations every tenth.
PERIODS_PER_SAMPLE, PERIODS_PER_NAVIGATION_SAMPLE = 2, 10
# Initial capacity in rows.
_ROWS = 4096
_HEADING = Motion._fields.index("heading")
_HEADING_SIGMA = NAVIGATION.field_names.index("heading")
# Columns of `Signals.motion` and `Signals.period` in the order of the topics.
_MOTION = len(Motion._fields)
_COMMAND_COLUMNS = [2 * _MOTION, 2 * _MOTION + 3, 2 * _MOTION + 6]
_LOGGED = [Controls._fields.index(name) for name in ("collective", "longitudinal", "lateral", "pedal")]
_CONTROLS = len(Controls._fields)
_CONTROLS_COLUMNS = [*_LOGGED, *(_CONTROLS + place for place in _LOGGED)]


class Recorder:
    """Recorder of one row for each control period.

    Args:
        signals: signals to record.
        height: height held by the controller, m.
    """

    def __init__(self, signals: Signals, *, height: float) -> None:
        self._height = height
        self._motion, self._period = _Rows(signals.motion), _Rows(signals.period)
        self._primitives: list[tuple[float, ...]] = []
        self._sigmas: list[tuple[float, ...]] = []
        # Control periods at the starts of primitives.
        self._starts: list[int] = []
        self.add_motion, self.add_period = self._motion.add, self._period.add

    def add_primitive(
        self, *, kind: PrimitiveKind, number: int, from_trim: int, to_trim: Trim, timed_out: bool
    ) -> None:
        """Records the start of a coast or maneuver."""
        target = to_trim.velocity
        self._starts.append(len(self._motion) - 1)
        self._primitives.append(
            (kind, number, from_trim, to_trim.id, target.forward, target.side, target.yaw_rate, timed_out)
        )

    def add_standard_deviation(self, sigmas: tuple[float, ...] | None) -> None:
        """Records standard deviations of the estimate, if known."""
        if sigmas is not None:
            self._sigmas.append(sigmas)

    def tracks(self, first: int, last: int) -> tuple[Float[np.ndarray, "n 4"], Float[np.ndarray, "n 4"]]:
        """Returns true and estimated track: time, north, east, heading.

        One row for every second control period, and the last.
        """
        periods = np.append(np.arange(first, last, PERIODS_PER_SAMPLE), last)
        truth, estimate = np.split(self._motion.values()[periods][:, : 2 * _MOTION], 2, axis=1)
        times = periods / CONTROL_RATE
        true, estimated = (
            np.column_stack([times, motion[:, :2], motion[:, _HEADING]]) for motion in (truth, estimate)
        )
        return true, estimated

    def standard_deviations(self, first: int, last: int) -> tuple[float, float]:
        """Returns the largest claimed horizontal (m) and heading (rad) deviations."""
        rows = self._sigmas[
            first // PERIODS_PER_NAVIGATION_SAMPLE : last // PERIODS_PER_NAVIGATION_SAMPLE + 1
        ]
        position = max((hypot(north, east) for north, east, *_ in rows), default=0.0)
        return position, max((row[_HEADING_SIGMA] for row in rows), default=0.0)

    def log(self, header: FlightHeader, attachments: Mapping[str, bytes]) -> FlightLog:
        """Returns the recorded flight as a log."""
        motion, period = self._motion.values(), self._period.values()
        last = len(motion) - 1
        sampled = np.array(sorted({*range(0, last, PERIODS_PER_SAMPLE), *self._starts, last}))
        instants, motion = sampled / CONTROL_RATE, motion[sampled]
        command = np.column_stack([motion[:, _COMMAND_COLUMNS], np.full(len(motion), self._height)])
        starts = np.array(self._starts, dtype=np.int64) / CONTROL_RATE
        times = np.arange(len(period)) / CONTROL_RATE
        sigma_times = PERIODS_PER_NAVIGATION_SAMPLE * np.arange(len(self._sigmas)) / CONTROL_RATE
        series = (
            Series(COMMAND, instants, command),
            Series(ESTIMATE, instants, motion[:, _MOTION : 2 * _MOTION]),
            Series(TRUTH, instants, motion[:, :_MOTION]),
            Series(WIND, times, period[:, 2 * _CONTROLS :]),
            Series(CONTROLS, times, period[:, _CONTROLS_COLUMNS]),
            Series(PRIMITIVE, starts, _rows(PRIMITIVE, self._primitives)),
            Series(NAVIGATION, sigma_times, _rows(NAVIGATION, self._sigmas)),
        )
        recorded = {part.topic.name: part for part in series if len(part)}
        return FlightLog(header, recorded, dict(attachments))


class _Rows:
    """Growing table of copies of an array."""

    def __init__(self, source: Array) -> None:
        self._source, self._width = memory_view(source), len(source)
        self._memory = np.empty(_ROWS * self._width)
        self._view, self._end = memory_view(self._memory), 0

    def __len__(self) -> int:
        return self._end // self._width

    def add(self) -> None:
        """Appends a copy of the array."""
        if self._end == len(self._memory):
            # Doubled, so that each row is copied once on average.
            self._memory = np.concatenate([self._memory, np.empty_like(self._memory)])
            self._view = memory_view(self._memory)
        end = self._end + self._width
        self._view[self._end : end] = self._source
        self._end = end

    def values(self) -> Float[np.ndarray, "n width"]:
        """Returns all rows, as a view."""
        return self._memory[: self._end].reshape(-1, self._width)


def _rows(topic: Topic, rows: list[tuple[float, ...]]) -> Float[np.ndarray, "n fields"]:
    return np.array(rows, dtype=np.float64).reshape(len(rows), len(topic.fields))
