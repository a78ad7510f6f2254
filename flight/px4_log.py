"""Flight logs of PX4 (ULog) as flight logs of ours: what is not in them is absent, not zero."""

import hashlib
import io
import json
import struct
from collections.abc import Mapping
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from .errors import BadFileError, FlightError
from .log import COMMAND, ESTIMATE, IMPORT_ATTACHMENT, TRUTH, FlightHeader, FlightLog
from .series import Series
from .version import VERSION

Messages = Mapping[str, np.ndarray[Any, Any]]
Column = Float[np.ndarray, "n"]

NOT_KNOWN = "not known"
_NEEDED = ("vehicle_local_position", "vehicle_attitude", "vehicle_angular_velocity")
_VALID = ("xy_valid", "z_valid", "v_xy_valid", "v_z_valid")
_UNREADABLE = (
    *(TypeError, ValueError, KeyError, IndexError, AttributeError, EOFError, MemoryError),
    *(struct.error, OverflowError, RuntimeError),
)


class _Patience:
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


def read_px4_log(path: Path) -> FlightLog:
    """Reads a ULog: the estimate, the truth where a simulator logged it, the velocities asked for.

    Raises:
        BadFileError: the file is missing, no ULog, or without a position and an attitude.
        FlightError: the reader of ULogs is not installed.
    """
    try:
        from pyulog import ULog
        from pyulog.exceptions import ULogException
    except ImportError:
        raise FlightError("a ULog is read by pyulog, which is not installed: pip install pyulog") from None
    try:
        content = path.read_bytes()
        # What the reader has to say goes to the console otherwise.
        with redirect_stdout(io.StringIO()):
            log = ULog(_Patience(content))
        topics = {part.name: part.data for part in log.data_list if part.multi_id == 0}
        known = {key: str(log.msg_info_dict[key]) for key in sorted(log.msg_info_dict)}
    except OSError as error:
        raise BadFileError(path, f"cannot be read: {error.strerror or error}") from None
    except (ULogException, *_UNREADABLE) as error:
        raise BadFileError(path, f"is no ULog: {' '.join(str(error).split())}") from None
    if log.file_corruption:
        raise BadFileError(path, "is damaged: its reader lost its place in it")
    source = {"file": path.name, "sha256": hashlib.sha256(content).hexdigest(), "information": known}
    try:
        series = series_of(topics)
    except FlightError as error:
        raise BadFileError(path, str(error)) from None
    header = FlightHeader(
        kind="import",
        name=path.stem,
        vehicle=known.get("ver_hw", NOT_KNOWN),
        model_hash=NOT_KNOWN,
        seed=0,
        wind=NOT_KNOWN,
        code_version=VERSION,
        backend=NOT_KNOWN,
    )
    return FlightLog(header, series, {IMPORT_ATTACHMENT: json.dumps(source, indent=1).encode()})


def series_of(topics: Mapping[str, Messages]) -> dict[str, Series]:
    """Returns what PX4's topics hold of ours, from the first valid position on.

    Args:
        topics: fields by topic; `timestamp` in microseconds.

    Raises:
        FlightError: there is no position or no attitude.
    """
    lacking = [name for name in _NEEDED if name not in topics]
    if lacking:
        raise FlightError(f"expected {list(_NEEDED)}, the log lacks {lacking}")
    estimate = _states(topics, "")
    if estimate is None:
        count = len(topics["vehicle_local_position"]["timestamp"])
        raise FlightError(f"expected positions and velocities that PX4 calls valid, got none in {count}")
    start = estimate[0][0]
    found = {ESTIMATE: estimate, TRUTH: _states(topics, "_groundtruth"), COMMAND: _command(topics, estimate)}
    series = {}
    for topic, part in found.items():
        if part is not None:
            time, values = part
            inside = time >= start
            if inside.any():
                series[topic.name] = Series(topic, time[inside] - start, values[inside])
    return series


def _states(topics: Mapping[str, Messages], ending: str) -> tuple[Column, Float[np.ndarray, "n 13"]] | None:
    """Returns times and states at the times of the positions; attitude and rates between their samples."""
    place, attitude = (topics.get(f"vehicle_{name}{ending}") for name in ("local_position", "attitude"))
    if place is None or attitude is None or len(attitude["timestamp"]) < 2:
        return None
    time = _seconds(place)
    valid = np.ones(len(time), bool)
    for name in _VALID:
        if name in place:
            valid &= np.asarray(place[name], bool)
    numbers = np.column_stack([place[name] for name in ("x", "y", "z", "vx", "vy", "vz")]).astype(np.float64)
    within = (time >= _seconds(attitude)[0]) & (time <= _seconds(attitude)[-1])
    kept = valid & within & np.isfinite(numbers).all(axis=1) & (np.diff(time, prepend=-np.inf) > 0)
    if kept.sum() < 2:
        return None
    time, (x, y, z, vx, vy, vz) = time[kept], numbers[kept].T
    roll, pitch, heading = (np.interp(time, _seconds(attitude), angle) for angle in _angles(attitude))
    spin = topics.get("vehicle_angular_velocity" if not ending else f"vehicle_angular_velocity{ending}")
    if spin is None:
        return None
    p, q, r = (np.interp(time, _seconds(spin), spin[f"xyz[{axis}]"]) for axis in range(3))
    yaw_rate = (q * np.sin(roll) + r * np.cos(roll)) / np.cos(pitch)
    forward, side = _level(vx, vy, heading)
    return time, np.column_stack([x, y, z, forward, side, vz, roll, pitch, heading, p, q, r, yaw_rate])


def _command(
    topics: Mapping[str, Messages], estimate: tuple[Column, Float[np.ndarray, "n 13"]]
) -> tuple[Column, Float[np.ndarray, "n 4"]] | None:
    """Returns the velocities, yaw rates and heights asked for, where all of them were."""
    asked = topics.get("vehicle_local_position_setpoint")
    if asked is None:
        return None
    time = _seconds(asked)
    heading = np.interp(time, estimate[0], estimate[1][:, ESTIMATE.field_names.index("heading")])
    forward, side = _level(asked["vx"], asked["vy"], heading)
    values = np.column_stack([forward, side, asked["yawspeed"], -np.asarray(asked["z"], np.float64)])
    kept = np.isfinite(values).all(axis=1) & (np.diff(time, prepend=-np.inf) > 0)
    kept &= (time >= estimate[0][0]) & (time <= estimate[0][-1])
    return (time[kept], values[kept]) if kept.any() else None


def _angles(attitude: Messages) -> tuple[Column, Column, Column]:
    """Returns roll, pitch and heading, not wrapped, of quaternions w, x, y, z from body to world."""
    w, x, y, z = (np.asarray(attitude[f"q[{place}]"], np.float64) for place in range(4))
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    heading = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return roll, pitch, np.unwrap(heading)


def _level(north: Column, east: Column, heading: Column) -> tuple[Column, Column]:
    c, s = np.cos(heading), np.sin(heading)
    return c * north + s * east, c * east - s * north


def _seconds(messages: Messages) -> Column:
    return np.asarray(messages["timestamp"], np.float64) * 1e-6
