"""Import of PX4 ULog files; missing data are absent, not zero."""

import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from flight.errors import BadFileError, FlightError
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ACTUATORS, COMMAND, ESTIMATE, MAX_ACTUATORS, TRUTH, WIND

from .clock import order_by_time
from .imported_log import UNKNOWN, ExternalLog, LeftOut
from .measured_motion import Source, attitude_source, measured_states
from .motion.geodetic import local_plane
from .motion.local_position import local_position_sources
from .motion.resets import Break, counter_breaks, jumps, merged
from .ulog_reader import Messages, read_ulog
from .ulog_recovery import MAGIC, intact_messages

Column = Float[np.ndarray, "n"]

_RATES = ("roll_rate", "pitch_rate", "body_yaw_rate")
# Body rates in vehicle_attitude, of logs before PX4 1.11.
_OLD_RATES = ("rollspeed", "pitchspeed", "yawspeed")
_USED = frozenset(
    {
        *(
            f"vehicle_{name}{ending}"
            for name in ("local_position", "attitude", "angular_velocity")
            for ending in ("", "_groundtruth")
        ),
        *(
            "vehicle_local_position_setpoint",
            "actuator_motors",
            "actuator_controls_0",
            "wind",
            "wind_estimate",
        ),
        *("vehicle_gps_position", "sensor_gps"),
    }
)
# Least fix of a receiver: three-dimensional.
_FIX = 3
_GPS = (("lat", "lon", "alt", 1e-7, 1e-3), ("latitude_deg", "longitude_deg", "altitude_msl_m", 1.0, 1.0))
_UNREADABLE = (
    *(TypeError, ValueError, KeyError, IndexError, AttributeError, EOFError, MemoryError),
    *(struct.error, OverflowError, RuntimeError),
)


def read_px4_log(path: Path, *, part: int | None = None) -> FlightLog:
    """Reads a ULog: estimate, ground truth, setpoints, controls and wind.

    Of a damaged ULog the intact messages are read; the outcome gives the number of lost bytes.

    Args:
        path: file to read.
        part: number of the part, where the clock was set back or jumps.

    Raises:
        BadFileError: the file is missing, not a ULog, or has no motion.
        FlightError: pyulog is not installed.
    """
    file = ExternalLog(path)
    content = file.content()
    if not content.startswith(MAGIC):
        raise BadFileError(path, "expected a ULog of PX4, got something else")
    whole, size = intact_messages(content), len(content)
    del content
    try:
        logged, known, messages = read_ulog(whole.content)
        topics, left_out = in_order(logged, part)
        found = motion_of(topics, sorted(logged))
    except FlightError as error:
        raise BadFileError(path, str(error)) from None
    except _UNREADABLE as error:
        raise BadFileError(path, f"is not a ULog: {' '.join(str(error).split())}") from None
    outcome = "completed"
    if whole.lost:
        outcome = f"recovered with loss: {whole.lost} of {size} bytes are in no intact message"
    return file.log(
        found.series.values(),
        vehicle=known.get("ver_hw", UNKNOWN),
        outcome=outcome,
        provenance={**found.said, "information": known},
        autopilot_messages=messages,
        breaks=found.breaks,
        left_out=left_out,
    )


def in_order(topics: Mapping[str, Messages], part: int | None) -> tuple[dict[str, Messages], list[LeftOut]]:
    """Returns the used topics' messages in order, and those left out."""
    ordered: dict[str, Messages] = {}
    left_out: list[LeftOut] = []
    for name, messages in topics.items():
        if name not in _USED or len(messages["timestamp"]) < 2:
            continue
        sample = f"{name} message"
        kept = order_by_time(_seconds(messages), sample=sample, part=part)
        ordered[name] = {field: column[kept.rows] for field, column in messages.items()}
        left_out += LeftOut.of(sample, kept.total, kept.left_out)
    return ordered, left_out


@dataclass(frozen=True, slots=True, eq=False)
class Px4Motion:
    """Series of PX4's topics, its resets, and remarks on them."""

    series: dict[str, Series]
    breaks: list[Break]
    said: dict[str, str]


def series_of(topics: Mapping[str, Messages]) -> dict[str, Series]:
    """Returns flight-log series of PX4's topics, on PX4's clock.

    Args:
        topics: fields by topic, in order of their times; `timestamp` in microseconds.

    Raises:
        FlightError: the topics hold no motion.
    """
    return motion_of(topics, sorted(topics)).series


def motion_of(topics: Mapping[str, Messages], logged: Sequence[str]) -> Px4Motion:
    """Returns the series of PX4's topics, with resets and remarks.

    Args:
        topics: fields by topic, in order of their times; `timestamp` in microseconds.
        logged: names of all topics of the log.

    Raises:
        FlightError: the topics hold no motion.
    """
    said: dict[str, str] = {}
    sources = _sources(topics, "")
    if not any("north" in source.columns for source in sources):
        sources = [*_gps_sources(topics, said), *sources]
    estimate = measured_states(sources, ESTIMATE)
    truth = measured_states(_sources(topics, "_groundtruth"), TRUTH)
    if estimate is None and truth is None:
        wanted = ["vehicle_local_position", "vehicle_attitude", "vehicle_angular_velocity"]
        raise FlightError(f"expected at least two messages of one of {wanted}, the log has {list(logged)}")
    command = None if estimate is None else _command(topics, estimate)
    found = (estimate, truth, command, _actuators(topics), _wind(topics))
    breaks = merged([*_resets(topics), *jumps(sources)])
    return Px4Motion({part.topic.name: part for part in found if part is not None}, breaks, said)


def _sources(topics: Mapping[str, Messages], ending: str) -> list[Source]:
    """Returns positions and velocities, attitudes and body rates, where logged."""
    sources = []
    position, attitude = (topics.get(f"vehicle_{name}{ending}") for name in ("local_position", "attitude"))
    if position is not None:
        fields = {name: column for name, column in position.items() if name != "heading" or attitude is None}
        sources += local_position_sources(_seconds(position), fields)
    if attitude is not None:
        quaternions = np.column_stack([_numbers(attitude, f"q[{place}]") for place in range(4)])
        sources.append(attitude_source(_seconds(attitude), quaternions))
    spin = topics.get(f"vehicle_angular_velocity{ending}")
    if spin is not None:
        rates = {name: _numbers(spin, f"xyz[{axis}]") for axis, name in enumerate(_RATES)}
        sources.append(Source(_seconds(spin), rates))
    elif attitude is not None and set(_OLD_RATES) <= attitude.keys():
        rates = {ours: _numbers(attitude, name) for ours, name in zip(_RATES, _OLD_RATES, strict=True)}
        sources.append(Source(_seconds(attitude), rates))
    return sources


def _gps_sources(topics: Mapping[str, Messages], said: dict[str, str]) -> list[Source]:
    """Returns positions and velocities of the satellite receiver."""
    gps = topics.get("vehicle_gps_position", topics.get("sensor_gps"))
    if gps is None:
        return []
    time = _seconds(gps)
    fixed = _numbers(gps, "fix_type") >= _FIX if "fix_type" in gps else np.ones(len(time), bool)
    for latitude, longitude, height, degrees, metres in _GPS:
        if not {latitude, longitude, height} <= gps.keys() or fixed.sum() < 2:
            continue
        place, said["place"] = local_plane(
            time[fixed],
            degrees * _numbers(gps, latitude)[fixed],
            degrees * _numbers(gps, longitude)[fixed],
            metres * _numbers(gps, height)[fixed],
        )
        names = ("north", "east", "down")
        moving = {f"velocity_{name}": f"vel_{name[0]}_m_s" for name in names}
        if not set(moving.values()) <= gps.keys():
            return [place]
        return [
            place,
            Source(time[fixed], {ours: _numbers(gps, name)[fixed] for ours, name in moving.items()}),
        ]
    return []


def _resets(topics: Mapping[str, Messages]) -> Iterator[Break]:
    for topic in ("vehicle_local_position", "vehicle_attitude"):
        messages = topics.get(topic, {})
        counters = [(name, column) for name, column in messages.items() if name.endswith("reset_counter")]
        if counters:
            named = [
                (name.removesuffix("_reset_counter"), np.asarray(column, float)) for name, column in counters
            ]
            yield from counter_breaks(_seconds(messages), named)


def _command(topics: Mapping[str, Messages], estimate: Series) -> Series | None:
    """Returns commanded velocities, yaw rates and heights, where complete."""
    setpoint = topics.get("vehicle_local_position_setpoint")
    if setpoint is None or not estimate.has_fields("heading"):
        return None
    time = _seconds(setpoint)
    known = np.isfinite(estimate["heading"])
    heading = np.interp(time, estimate.time[known], estimate["heading"][known])
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
    # Motors are not-a-number until they are armed.
    moving = {
        name: column
        for name, column in columns.items()
        if np.isfinite(column).any() and np.nan_to_num(column).any()
    }
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
    with np.errstate(invalid="ignore"):
        return np.asarray(messages[name], np.float64)


def _seconds(messages: Messages) -> Column:
    return _numbers(messages, "timestamp") * 1e-6
