"""Import of ArduPilot's DataFlash logs; missing data are absent, not zero."""

import io
import os
import sys
from array import array
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from flight.errors import BadFileError, FlightError
from flightlog.autopilot_messages import AutopilotMessage
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ACTUATORS, COMMAND, ESTIMATE, MAX_ACTUATORS, TRUTH, WIND

from .axes import quaternions_from_euler
from .clock import order_by_time
from .imported_log import UNKNOWN, ExternalLog, LeftOut
from .measured_motion import Source, attitude_source, measured_states
from .motion.derived_fields import BODY_RATES
from .motion.geodetic import local_plane
from .motion.resets import jumps, merged

# Fields by message, in the order of ArduPilot's documentation of its log messages.
_FIELDS: Mapping[str, tuple[str, ...]] = {
    "XKF1": ("C", "PN", "PE", "PD", "VN", "VE", "VD"),
    "NKF1": ("C", "PN", "PE", "PD", "VN", "VE", "VD"),
    "XKF2": ("C", "VWN", "VWE"),
    "XKF4": ("C", "PI"),
    "XKQ": ("C", "Q1", "Q2", "Q3", "Q4"),
    "ATT": ("Roll", "Pitch", "Yaw"),
    "IMU": ("I", "GyrX", "GyrY", "GyrZ"),
    "GPS": ("I", "Status", "Lat", "Lng", "Alt", "Spd", "GCrs", "VZ"),
    "SIM": ("Roll", "Pitch", "Yaw", "Q1", "Q2", "Q3", "Q4"),
    "SIM2": ("PN", "PE", "PD", "VN", "VE", "VD"),
    "PSCN": ("TVN",),
    "PSCE": ("TVE",),
    "PSCD": ("TPD",),
    "RATE": ("YDes",),
    "RCOU": tuple(f"C{number}" for number in range(1, MAX_ACTUATORS + 1)),
}
_TIME = "TimeUS"
_FIX = 3
# Bytes that may be left at the end of a log that is written in pages.
_PADDING = 528
_QUATERNION = ("Q1", "Q2", "Q3", "Q4")
_POSITION, _VELOCITY = ("PN", "PE", "PD"), ("VN", "VE", "VD")

Column = Float[np.ndarray, "n"]
Fields = Mapping[str, Column]


@dataclass(slots=True, eq=False)
class _Logged:
    """Messages of a log by name, in columns."""

    columns: dict[str, dict[str, "array[float]"]] = field(default_factory=dict)
    messages: list[tuple[float, str]] = field(default_factory=list)
    version: str = UNKNOWN
    size: int = 0
    lost: int = 0


def read_dataflash_log(path: Path, *, part: int | None = None) -> FlightLog:
    """Reads a DataFlash log: estimate, truth, setpoints, servo outputs, wind.

    Args:
        path: file to read.
        part: number of the part, where the clock was set back or jumps.

    Raises:
        BadFileError: the file is no such log, or has no motion.
        FlightError: pymavlink is not installed.
    """
    try:
        logged = _read(path)
        topics, left_out = _in_order(logged, part)
        said: dict[str, str] = {}
        sources = _estimate(topics, said)
        estimate, truth = measured_states(sources, ESTIMATE), measured_states(_truth(topics), TRUTH)
        if estimate is None and truth is None:
            raise FlightError(
                f"expected a motion in XKF1, NKF1, ATT, IMU or GPS, the log has {sorted(topics)}"
            )
    except FlightError as error:
        raise BadFileError(path, str(error)) from None
    outcome = "completed"
    if logged.lost > _PADDING:
        outcome = f"recovered with loss: {logged.lost} of {logged.size} bytes are in no intact message"
    extra = (_command(topics, estimate), _actuators(topics), _wind(topics))
    return ExternalLog(path).log(
        [series for series in (estimate, truth, *extra) if series is not None],
        vehicle=logged.version,
        outcome=outcome,
        provenance=said,
        autopilot_messages=[AutopilotMessage(time, "INFO", text) for time, text in logged.messages],
        breaks=merged(jumps(sources)),
        left_out=left_out,
    )


def _read(path: Path) -> _Logged:
    """Returns the messages that are used, read one after another."""
    try:
        from pymavlink.DFReader import DFReader_binary
    except ImportError:
        raise FlightError("a DataFlash log needs the package pymavlink: pip install pymavlink") from None
    logged = _Logged()
    names = [*_FIELDS, "MSG", "VER"]
    # Made before it is opened, so that its file is closed where opening it fails.
    reader = DFReader_binary.__new__(DFReader_binary)
    try:
        with _silence():
            reader.__init__(str(path))
            while (message := reader.recv_match(type=names)) is not None:
                _take(logged, message)
        logged.size = reader.data_len
        logged.lost = logged.size - sum(
            len(reader.offsets[kind]) * layout.len for kind, layout in reader.formats.items()
        )
    except Exception as error:
        # A reader of damaged bytes may raise anything.
        reason = " ".join(str(error).split()) or type(error).__name__
        raise FlightError(f"is not a DataFlash log that can be read: {reason}") from None
    finally:
        for part in ("data_map", "filehandle"):
            if (opened := getattr(reader, part, None)) is not None:
                opened.close()
    return logged


@contextmanager
def _silence() -> Iterator[None]:
    """Discards what the reader prints; its compiled part knows only the descriptor."""
    sys.stderr.flush()
    kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def _take(logged: _Logged, message: Any) -> None:
    name, time = message.get_type(), getattr(message, _TIME, None)
    if not isinstance(time, int | float):
        return
    if name == "MSG":
        logged.messages.append((time * 1e-6, " ".join(str(message.Message).split())))
    elif name == "VER":
        logged.version = str(getattr(message, "FWS", UNKNOWN))
    else:
        columns = logged.columns.setdefault(name, {key: array("d") for key in (_TIME, *_FIELDS[name])})
        for key, column in columns.items():
            value = getattr(message, key, None)
            column.append(float(value) if isinstance(value, int | float) else np.nan)


def _in_order(logged: _Logged, part: int | None) -> tuple[dict[str, Fields], list[LeftOut]]:
    """Returns one instance's messages by name, in order of time."""
    topics: dict[str, Fields] = {}
    left_out: list[LeftOut] = []
    core = _primary(logged.columns.get("XKF4"))
    for name, columns in logged.columns.items():
        fields = {key: np.array(column) for key, column in columns.items()}
        instance = fields.get("C", fields.get("I"))
        if instance is not None and np.isfinite(instance).any():
            wanted = core if "C" in fields else float(np.nanmin(instance))
            fields = {key: column[instance == wanted] for key, column in fields.items()}
        if len(fields[_TIME]) < 2:
            continue
        kept = order_by_time(fields[_TIME] * 1e-6, sample=f"{name} message", part=part)
        topics[name] = {key: column[kept.rows] for key, column in fields.items() if np.isfinite(column).any()}
        left_out += LeftOut.of(f"{name} message", kept.total, kept.left_out)
    return topics, left_out


def _primary(health: Mapping[str, Sequence[float]] | None) -> float:
    """Returns the estimator's core that was used most."""
    used = Counter(value for value in (health or {}).get("PI", ()) if np.isfinite(value))
    return used.most_common(1)[0][0] if used else 0.0


def _time(fields: Fields) -> Column:
    return np.asarray(fields[_TIME] * 1e-6)


def _linear(fields: Fields | None) -> list[Source]:
    """Returns positions and velocities north, east, down."""
    sources = []
    for names, start in ((_POSITION, ""), (_VELOCITY, "velocity_")):
        if fields is not None and set(names) <= fields.keys():
            ours = (f"{start}north", f"{start}east", f"{start}down")
            columns = {mine: fields[name] for mine, name in zip(ours, names, strict=True)}
            sources.append(Source(_time(fields), columns))
    return sources


def _attitude(fields: Fields | None) -> list[Source]:
    """Returns attitudes of quaternions, or of angles in degrees."""
    if fields is None:
        return []
    if set(_QUATERNION) <= fields.keys():
        return [attitude_source(_time(fields), np.column_stack([fields[name] for name in _QUATERNION]))]
    if {"Roll", "Pitch", "Yaw"} <= fields.keys():
        angles = (np.radians(fields[name]) for name in ("Roll", "Pitch", "Yaw"))
        return [attitude_source(_time(fields), quaternions_from_euler(*angles))]
    return []


def _estimate(topics: Mapping[str, Fields], said: dict[str, str]) -> list[Source]:
    filtered = "XKF1" if "XKF1" in topics else "NKF1"
    sources = _linear(topics.get(filtered))
    said["place"] = f"{filtered}, from the origin of its filter"
    if not sources:
        sources = _receiver(topics.get("GPS"), said)
    attitude = "XKQ" if "XKQ" in topics else "ATT"
    sources += _attitude(topics.get(attitude))
    said["attitude"] = attitude
    gyroscopes = topics.get("IMU")
    if gyroscopes is not None and {"GyrX", "GyrY", "GyrZ"} <= gyroscopes.keys():
        columns = dict(zip(BODY_RATES, (gyroscopes[f"Gyr{axis}"] for axis in "XYZ"), strict=True))
        sources.append(Source(_time(gyroscopes), columns))
        said["body rates"] = "IMU, the gyroscopes as they are"
    return sources


def _receiver(fields: Fields | None, said: dict[str, str]) -> list[Source]:
    """Returns positions and velocities of the satellite receiver."""
    said.pop("place", None)
    if fields is None or not {"Status", "Lat", "Lng", "Alt"} <= fields.keys():
        return []
    fixed = fields["Status"] >= _FIX
    if fixed.sum() < 2:
        return []
    time = _time(fields)[fixed]
    place, said["place"] = local_plane(time, fields["Lat"][fixed], fields["Lng"][fixed], fields["Alt"][fixed])
    if not {"Spd", "GCrs", "VZ"} <= fields.keys():
        return [place]
    speed, course = fields["Spd"][fixed], np.radians(fields["GCrs"][fixed])
    columns = {"velocity_north": speed * np.cos(course), "velocity_east": speed * np.sin(course)}
    return [place, Source(time, {**columns, "velocity_down": fields["VZ"][fixed]})]


def _truth(topics: Mapping[str, Fields]) -> list[Source]:
    return [*_linear(topics.get("SIM2")), *_attitude(topics.get("SIM"))]


def _command(topics: Mapping[str, Fields], estimate: Series | None) -> Series | None:
    """Returns commanded velocities, yaw rates and heights, those logged."""
    if estimate is None or not {"PSCN", "PSCE"} <= topics.keys() or not estimate.has_fields("heading"):
        return None
    time = _time(topics["PSCN"])

    def at(name: str, wanted: str) -> Column:
        fields = topics[name]
        column = fields.get(wanted, np.full(len(fields[_TIME]), np.nan))
        return np.asarray(np.interp(time, _time(fields), column))

    known = np.isfinite(estimate["heading"])
    heading = np.interp(time, estimate.time[known], estimate["heading"][known])
    north, east, c, s = at("PSCN", "TVN"), at("PSCE", "TVE"), np.cos(heading), np.sin(heading)
    columns = {"forward": c * north + s * east, "side": c * east - s * north}
    if "RATE" in topics:
        columns["yaw_rate"] = np.radians(at("RATE", "YDes"))
    if "PSCD" in topics:
        columns["height"] = -at("PSCD", "TPD")
    topic = COMMAND.only(columns)
    return _complete(Series(topic, time, np.column_stack([columns[name] for name in topic.field_names])))


def _actuators(topics: Mapping[str, Fields]) -> Series | None:
    """Returns the servo outputs that ever moved, in microseconds."""
    fields = topics.get("RCOU", {})
    moving = [name for name in _FIELDS["RCOU"] if name in fields and np.ptp(fields[name])]
    if not moving:
        return None
    topic = ACTUATORS.only(f"control_{name[1:]}" for name in moving)
    return _complete(Series(topic, _time(fields), np.column_stack([fields[name] for name in moving])))


def _wind(topics: Mapping[str, Fields]) -> Series | None:
    """Returns the estimated wind, once it is not zero."""
    fields = topics.get("XKF2", {})
    if not {"VWN", "VWE"} <= fields.keys():
        return None
    values = np.column_stack([fields["VWN"], fields["VWE"]])
    values[~values.any(axis=1)] = np.nan
    return _complete(Series(WIND.only(["north", "east"]), _time(fields), values))


def _complete(series: Series) -> Series | None:
    rows = np.isfinite(series.values).all(axis=1)
    return Series(series.topic, series.time[rows], series.values[rows]) if rows.any() else None
