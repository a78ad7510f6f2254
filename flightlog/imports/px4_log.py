"""Flight logs of PX4 (ULog) as flight logs of ours: what is not in them is absent, not zero."""

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
from flightlog.channels import ACTUATORS, COMMAND, ESTIMATE, MAX_ACTUATORS, TRUTH, WIND
from flightlog.log import FlightLog
from flightlog.topic import Series

from .imported_log import UNKNOWN, ExternalLog
from .measured_motion import Source, attitude_source, measured_states
from .ulog_recovery import HEADER, MAGIC, intact_messages

Messages = Mapping[str, np.ndarray[Any, Any]]
Column = Float[np.ndarray, "n"]

# Numbers of vehicle_local_position as sources call them, and what PX4 says of their validity.
_POSITION_TOPICS = {
    "x": ("north", "xy_valid"),
    "y": ("east", "xy_valid"),
    "z": ("down", "z_valid"),
    "vx": ("velocity_north", "v_xy_valid"),
    "vy": ("velocity_east", "v_xy_valid"),
    "vz": ("velocity_down", "v_z_valid"),
}
LEAST_VALID = 0.1
"""A number that PX4 calls valid for a smaller share of the log is taken as absent."""

_RATES = ("roll_rate", "pitch_rate", "body_yaw_rate")
_UNREADABLE = (
    *(TypeError, ValueError, KeyError, IndexError, AttributeError, EOFError, MemoryError),
    *(struct.error, OverflowError, RuntimeError),
)


def read_px4_log(path: Path) -> FlightLog:
    """Reads a ULog: what the autopilot believed, what a simulator knew, what was asked for, controls, wind.

    Of a damaged ULog the whole messages are read, and the outcome says how many bytes were not.

    Raises:
        BadFileError: the file is missing, no ULog, or without any motion.
        FlightError: the reader of ULogs is not installed.
    """
    file = ExternalLog.read(path)
    if not file.content.startswith(MAGIC):
        raise BadFileError(path, "expected a ULog of PX4, got something else")
    whole = intact_messages(file.content)
    try:
        topics, known, messages = _read(whole.content)
        series = series_of(topics)
    except FlightError as error:
        raise BadFileError(path, str(error)) from None
    except _UNREADABLE as error:
        raise BadFileError(path, f"is no ULog: {' '.join(str(error).split())}") from None
    outcome = "completed"
    if whole.lost:
        outcome = f"recovered with loss: {whole.lost} of {len(file.content)} bytes are no whole message"
    return file.log(
        series.values(),
        vehicle=known.get("ver_hw", UNKNOWN),
        outcome=outcome,
        provenance={"information": known},
        autopilot_messages=messages,
    )


def _read(content: bytes) -> tuple[dict[str, Messages], dict[str, str], list[AutopilotMessage]]:
    """Returns fields by topic, of the first of several alike, what the log says of itself, and messages."""
    try:
        from pyulog import ULog
        from pyulog.exceptions import ULogException
    except ImportError:
        raise FlightError("a ULog is read by pyulog, which is not installed: pip install pyulog") from None
    if len(content) <= HEADER:
        raise FlightError(f"is cut short after {len(content)} bytes; nothing whole is left")
    try:
        # What the reader has to say goes to the console otherwise.
        with redirect_stdout(io.StringIO()):
            log = ULog(_BoundedReader(content))
    except ULogException as error:
        raise FlightError(f"is no ULog: {' '.join(str(error).split())}") from None
    # On a clock of its own: microseconds of a date leave a double few digits.
    topics: dict[str, Messages] = {
        part.name: {**part.data, "timestamp": part.data["timestamp"].astype(np.int64) - log.start_timestamp}
        for part in log.data_list
        if part.multi_id == 0
    }
    known = {key: str(log.msg_info_dict[key]) for key in sorted(log.msg_info_dict)}
    messages = [
        AutopilotMessage(
            (one.timestamp - log.start_timestamp) * 1e-6, _level(one.log_level), " ".join(one.message.split())
        )
        for one in log.logged_messages
    ]
    return topics, known, messages


def _level(level: int) -> str:
    """Returns how serious a message is, of the digit that the kernel of Linux has for it."""
    return "ERROR" if level <= ord("3") else "WARNING" if level == ord("4") else "INFO"


class _BoundedReader:
    """A file in memory that ends a reader which goes in circles, as that of ULogs does in damaged ones."""

    def __init__(self, content: bytes) -> None:
        self._stream, self._left = io.BytesIO(content), 8 * len(content) + 10**6
        self.seek, self.tell, self.close = self._stream.seek, self._stream.tell, self._stream.close

    def read(self, size: int = -1) -> bytes:
        """Returns the next bytes.

        Raises:
            EOFError: more was read by far than there is.
        """
        part = self._stream.read(size)
        self._left -= len(part) + 16
        if self._left < 0:
            raise EOFError("its reader goes in circles")
        return part


def series_of(topics: Mapping[str, Messages]) -> dict[str, Series]:
    """Returns what PX4's topics hold of ours, on PX4's clock.

    Args:
        topics: fields by topic; `timestamp` in microseconds.

    Raises:
        FlightError: there is no motion at all.
    """
    estimate = measured_states(list(_sources(topics, "")), ESTIMATE)
    truth = measured_states(list(_sources(topics, "_groundtruth")), TRUTH)
    if estimate is None and truth is None:
        wanted = ["vehicle_local_position", "vehicle_attitude", "vehicle_angular_velocity"]
        raise FlightError(f"expected two messages or more of one of {wanted}, the log has {sorted(topics)}")
    command = None if estimate is None else _command(topics, estimate)
    found = (estimate, truth, command, _actuators(topics), _wind(topics))
    return {part.topic.name: part for part in found if part is not None}


def _sources(topics: Mapping[str, Messages], ending: str) -> Iterator[Source]:
    """Yields where the vehicle is, how it stands and how it turns, as far as the log knows."""
    place = topics.get(f"vehicle_local_position{ending}")
    if place is not None:
        valid = {flag: _flag(place, flag) for _, flag in _POSITION_TOPICS.values()}
        held = {
            name: flag for name, (_, flag) in _POSITION_TOPICS.items() if valid[flag].mean() >= LEAST_VALID
        }
        if held:
            rows = np.all([valid[flag] for flag in held.values()], axis=0)
            columns = {_POSITION_TOPICS[name][0]: _numbers(place, name)[rows] for name in held}
            yield Source(_seconds(place)[rows], columns)
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
    """Returns where PX4 calls something valid; everywhere where it does not say, as of a ground truth."""
    if name in messages:
        return np.asarray(messages[name], bool)
    return np.ones(len(messages["timestamp"]), bool)


def _command(topics: Mapping[str, Messages], estimate: Series) -> Series | None:
    """Returns the velocities, yaw rates and heights asked for, where all of them were."""
    asked = topics.get("vehicle_local_position_setpoint")
    if asked is None or not estimate.has_fields("heading"):
        return None
    time = _seconds(asked)
    heading = np.interp(time, estimate.time, estimate["heading"])
    c, s, north, east = np.cos(heading), np.sin(heading), _numbers(asked, "vx"), _numbers(asked, "vy")
    values = np.column_stack(
        [c * north + s * east, c * east - s * north, _numbers(asked, "yawspeed"), -_numbers(asked, "z")]
    )
    return _complete_rows(Series(COMMAND, time, values))


def _actuators(topics: Mapping[str, Messages]) -> Series | None:
    """Returns what the mixer was told, or the motors in newer logs; controls that never move are absent."""
    told = topics.get("actuator_motors", topics.get("actuator_controls_0"))
    if told is None:
        return None
    columns = {
        f"control_{number}": _numbers(told, f"control[{number - 1}]")
        for number in range(1, MAX_ACTUATORS + 1)
        if f"control[{number - 1}]" in told
    }
    moving = {name: column for name, column in columns.items() if np.isfinite(column).all() and column.any()}
    if not moving:
        return None
    values = np.column_stack([*moving.values()])
    return _complete_rows(Series(ACTUATORS.only(moving), _seconds(told), values))


def _wind(topics: Mapping[str, Messages]) -> Series | None:
    """Returns the wind that the autopilot estimated; what it says before it has a variance is no estimate."""
    told = topics.get("wind", topics.get("wind_estimate"))
    if told is None or "variance_north" not in told:
        return None
    known = np.asarray(told["variance_north"], np.float64) > 0.0
    values = np.column_stack([_numbers(told, f"windspeed_{name}") for name in ("north", "east")])
    return _complete_rows(Series(WIND.only(["north", "east"]), _seconds(told)[known], values[known]))


def _complete_rows(series: Series) -> Series | None:
    """Returns a series where all of it is known and its times rise; None where that is nowhere."""
    kept = np.isfinite(series.values).all(axis=1) & (np.diff(series.time, prepend=-np.inf) > 0)
    return Series(series.topic, series.time[kept], series.values[kept]) if kept.any() else None


def _numbers(messages: Messages, name: str) -> Column:
    return np.asarray(messages[name], np.float64)


def _seconds(messages: Messages) -> Column:
    return _numbers(messages, "timestamp") * 1e-6
