"""Import of PX4 ULog files; missing data are absent, not zero."""

import io
import struct
from collections.abc import Iterator, Mapping
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from flight.errors import BadFileError, FlightError
from flightlog.autopilot_messages import AutopilotMessage
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ACTUATORS, COMMAND, ESTIMATE, MAX_ACTUATORS, TRUTH, WIND

from .clock import check_clock
from .imported_log import UNKNOWN, ExternalLog
from .measured_motion import Source, attitude_source, measured_states
from .ulog_recovery import HEADER, MAGIC, intact_messages

Messages = Mapping[str, np.ndarray[Any, Any]]
Column = Float[np.ndarray, "n"]

# Fields of vehicle_local_position: name in a source, and PX4's validity flag.
_POSITION_TOPICS = {
    "x": ("north", "xy_valid"),
    "y": ("east", "xy_valid"),
    "z": ("down", "z_valid"),
    "vx": ("velocity_north", "v_xy_valid"),
    "vy": ("velocity_east", "v_xy_valid"),
    "vz": ("velocity_down", "v_z_valid"),
}
LEAST_VALID = 0.1
"""Smallest share of valid samples; fields below it are absent."""

_RATES = ("roll_rate", "pitch_rate", "body_yaw_rate")
_UNREADABLE = (
    *(TypeError, ValueError, KeyError, IndexError, AttributeError, EOFError, MemoryError),
    *(struct.error, OverflowError, RuntimeError),
)


def read_px4_log(path: Path) -> FlightLog:
    """Reads a ULog: estimate, ground truth, setpoints, controls and wind.

    Of a damaged ULog the intact messages are read; the outcome gives the number of lost bytes.

    Raises:
        BadFileError: the file is missing, not a ULog, or has no motion.
        FlightError: pyulog is not installed.
    """
    file = ExternalLog.read(path)
    if not file.content.startswith(MAGIC):
        raise BadFileError(path, "expected a ULog of PX4, got something else")
    whole = intact_messages(file.content)
    try:
        topics, known, messages = _read(whole.content)
        series = series_of(topics)
        for name in {ESTIMATE.name, TRUTH.name} & series.keys():
            check_clock(series[name].time, sample=f"{name} state")
    except FlightError as error:
        raise BadFileError(path, str(error)) from None
    except _UNREADABLE as error:
        raise BadFileError(path, f"is not a ULog: {' '.join(str(error).split())}") from None
    outcome = "completed"
    if whole.lost:
        outcome = f"recovered with loss: {whole.lost} of {len(file.content)} bytes are in no intact message"
    return file.log(
        series.values(),
        vehicle=known.get("ver_hw", UNKNOWN),
        outcome=outcome,
        provenance={"information": known},
        autopilot_messages=messages,
    )


def _read(content: bytes) -> tuple[dict[str, Messages], dict[str, str], list[AutopilotMessage]]:
    """Returns fields by topic, the log's information, and its messages."""
    try:
        from pyulog import ULog
        from pyulog.exceptions import ULogException
    except ImportError:
        raise FlightError("a ULog needs the package pyulog: pip install pyulog") from None
    if len(content) <= HEADER:
        raise FlightError(f"is truncated after {len(content)} bytes, without an intact message")
    try:
        # The reader prints to the console.
        with redirect_stdout(io.StringIO()):
            log = ULog(_BoundedReader(content))
    except ULogException as error:
        raise FlightError(f"is not a ULog: {' '.join(str(error).split())}") from None
    # Relative to the log's start: microseconds of a date leave a double few digits.
    topics: dict[str, Messages] = {
        part.name: {**part.data, "timestamp": part.data["timestamp"].astype(np.int64) - log.start_timestamp}
        for part in log.data_list
        if part.multi_id == 0
    }
    known = {key: str(log.msg_info_dict[key]) for key in sorted(log.msg_info_dict)}
    messages = [
        AutopilotMessage(
            (message.timestamp - log.start_timestamp) * 1e-6,
            _level(message.log_level),
            " ".join(message.message.split()),
        )
        for message in log.logged_messages
    ]
    return topics, known, messages


def _level(level: int) -> str:
    """Returns the severity of a Linux kernel log level digit."""
    return "ERROR" if level <= ord("3") else "WARNING" if level == ord("4") else "INFO"


class _BoundedReader:
    """In-memory file that stops a reader in an endless loop.

    The ULog reader can loop on damaged files.
    """

    def __init__(self, content: bytes) -> None:
        self._stream, self._left = io.BytesIO(content), 8 * len(content) + 10**6
        self.seek, self.tell, self.close = self._stream.seek, self._stream.tell, self._stream.close

    def read(self, size: int = -1) -> bytes:
        """Returns the next bytes.

        Raises:
            EOFError: far more was read than the file holds.
        """
        part = self._stream.read(size)
        self._left -= len(part) + 16
        if self._left < 0:
            raise EOFError("endless loop of the reader")
        return part


def series_of(topics: Mapping[str, Messages]) -> dict[str, Series]:
    """Returns flight-log series of PX4's topics, on PX4's clock.

    Args:
        topics: fields by topic; `timestamp` in microseconds.

    Raises:
        FlightError: the topics hold no motion.
    """
    estimate = measured_states(list(_sources(topics, "")), ESTIMATE)
    truth = measured_states(list(_sources(topics, "_groundtruth")), TRUTH)
    if estimate is None and truth is None:
        wanted = ["vehicle_local_position", "vehicle_attitude", "vehicle_angular_velocity"]
        raise FlightError(f"expected at least two messages of one of {wanted}, the log has {sorted(topics)}")
    command = None if estimate is None else _command(topics, estimate)
    found = (estimate, truth, command, _actuators(topics), _wind(topics))
    return {part.topic.name: part for part in found if part is not None}


def _sources(topics: Mapping[str, Messages], ending: str) -> Iterator[Source]:
    """Yields positions and velocities, attitudes and body rates, where logged."""
    position = topics.get(f"vehicle_local_position{ending}")
    if position is not None:
        valid = {flag: _flag(position, flag) for _, flag in _POSITION_TOPICS.values()}
        present = {
            name: flag for name, (_, flag) in _POSITION_TOPICS.items() if valid[flag].mean() >= LEAST_VALID
        }
        if present:
            rows = np.all([valid[flag] for flag in present.values()], axis=0)
            columns = {_POSITION_TOPICS[name][0]: _numbers(position, name)[rows] for name in present}
            yield Source(_seconds(position)[rows], columns)
    attitude = topics.get(f"vehicle_attitude{ending}")
    if attitude is not None:
        quaternions = np.column_stack([_numbers(attitude, f"q[{place}]") for place in range(4)])
        yield attitude_source(_seconds(attitude), quaternions)
    spin = topics.get(f"vehicle_angular_velocity{ending}")
    if spin is not None:
        yield Source(
            _seconds(spin), {name: _numbers(spin, f"xyz[{axis}]") for axis, name in enumerate(_RATES)}
        )


def _flag(messages: Messages, name: str) -> Bool[np.ndarray, "n"]:
    """Returns a PX4 validity flag; all true if not logged."""
    if name in messages:
        return np.asarray(messages[name], bool)
    return np.ones(len(messages["timestamp"]), bool)


def _command(topics: Mapping[str, Messages], estimate: Series) -> Series | None:
    """Returns commanded velocities, yaw rates and heights, where complete."""
    setpoint = topics.get("vehicle_local_position_setpoint")
    if setpoint is None or not estimate.has_fields("heading"):
        return None
    time = _seconds(setpoint)
    heading = np.interp(time, estimate.time, estimate["heading"])
    c, s, north, east = np.cos(heading), np.sin(heading), _numbers(setpoint, "vx"), _numbers(setpoint, "vy")
    values = np.column_stack(
        [c * north + s * east, c * east - s * north, _numbers(setpoint, "yawspeed"), -_numbers(setpoint, "z")]
    )
    return _complete_rows(Series(COMMAND, time, values))


def _actuators(topics: Mapping[str, Messages]) -> Series | None:
    """Returns mixer inputs, or motors in newer logs, if ever moved."""
    actuators = topics.get("actuator_motors", topics.get("actuator_controls_0"))
    if actuators is None:
        return None
    columns = {
        f"control_{number}": _numbers(actuators, f"control[{number - 1}]")
        for number in range(1, MAX_ACTUATORS + 1)
        if f"control[{number - 1}]" in actuators
    }
    moving = {name: column for name, column in columns.items() if np.isfinite(column).all() and column.any()}
    if not moving:
        return None
    values = np.column_stack([*moving.values()])
    return _complete_rows(Series(ACTUATORS.only(moving), _seconds(actuators), values))


def _wind(topics: Mapping[str, Messages]) -> Series | None:
    """Returns the autopilot's wind estimate, from its first variance on."""
    wind = topics.get("wind", topics.get("wind_estimate"))
    if wind is None or "variance_north" not in wind:
        return None
    known = np.asarray(wind["variance_north"], np.float64) > 0.0
    values = np.column_stack([_numbers(wind, f"windspeed_{name}") for name in ("north", "east")])
    return _complete_rows(Series(WIND.only(["north", "east"]), _seconds(wind)[known], values[known]))


def _complete_rows(series: Series) -> Series | None:
    """Returns finite rows with increasing times; None if there are none."""
    valid = np.isfinite(series.values).all(axis=1) & (np.diff(series.time, prepend=-np.inf) > 0)
    return Series(series.topic, series.time[valid], series.values[valid]) if valid.any() else None


def _numbers(messages: Messages, name: str) -> Column:
    return np.asarray(messages[name], np.float64)


def _seconds(messages: Messages) -> Column:
    return _numbers(messages, "timestamp") * 1e-6
