"""Import of CSV tables as flight logs."""

import io
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from jaxtyping import Float

from flight.errors import BadFileError, FlightError
from flightlog.log import FlightLog
from flightlog.series import Series, Topic
from flightlog.topics import ACTUATORS, MAX_ACTUATORS

from .axes import Axes, quaternions_from_euler
from .clock import SECONDS, TimeUnit, check_clock, check_unit
from .imported_log import ExternalLog
from .measured_motion import BODY_RATES, Source, attitude_source, differentiate_position, measured_states

POSITION, VELOCITY, RATES = ("x", "y", "z"), ("vx", "vy", "vz"), ("wx", "wy", "wz")
QUATERNION, ANGLES = ("qw", "qx", "qy", "qz"), ("roll", "pitch", "yaw")
CONTROLS = tuple(f"u{number}" for number in range(1, MAX_ACTUATORS + 1))
NAMES = ("time", *POSITION, *VELOCITY, *QUATERNION, *ANGLES, *RATES, *CONTROLS)
"""Names of columns: position and velocity in world axes in SI units (z and vz optional), quaternion or angles
(about z, y, x in radians; yaw may be alone) from body to world, body rates in rad/s, controls."""

_MOST_LISTED, _LONGEST_LIST = 40, 600


def read_external_csv(
    path: Path, columns: Mapping[str, str], *, axes: Axes, time_unit: TimeUnit | None, topic: Topic
) -> FlightLog:
    """Reads a table with a row of headings.

    Args:
        path: file to read.
        columns: headings by the names of `NAMES`; not needed for headings that are such names.
        axes: axes of world and body.
        time_unit: unit of the times; seconds where None, if they can be.
        topic: topic of the motion: estimate or truth.

    Raises:
        BadFileError: the file is not such a table, or holds no motion.
    """
    file = ExternalLog.read(path)
    try:
        table = pd.read_csv(io.BytesIO(file.content))
    except (ValueError, UnicodeDecodeError, pd.errors.ParserError) as error:
        raise BadFileError(path, f"is not a table: {' '.join(str(error).split())}") from None
    if len(table) < 2:
        raise BadFileError(path, f"expected at least two rows below the headings, got {len(table)}")
    try:
        chosen = _select_columns(table, columns)
        numbers = {name: _numbers(table, heading) for name, heading in chosen.items()}
        if not np.isfinite(numbers["time"]).any():
            raise FlightError(f"column {chosen['time']!r}: expected times, got no finite number")
        numbers["time"] = np.where(np.isfinite(numbers["time"]), numbers["time"], np.nan)
        numbers = _in_ascending_order(numbers)
        check_unit(numbers["time"], time_unit)
        time = SECONDS[time_unit or "s"] * numbers["time"]
        check_clock(time, sample="row")
        sources, velocity = _sources(numbers, time - np.nanmin(time), axes)
        states = measured_states(sources, topic)
    except FlightError as error:
        raise BadFileError(path, str(error)) from None
    if states is None:
        raise BadFileError(path, f"expected at least two usable rows, got none of {len(table)}")
    provenance = {"columns": chosen, "velocity": velocity, "world axes": axes.world, "body axes": axes.body}
    controls = _controls(numbers, time - np.nanmin(time))
    return file.log([states, *([controls] if controls is not None else [])], provenance=provenance)


def _select_columns(table: pd.DataFrame, columns: Mapping[str, str]) -> dict[str, str]:
    """Returns headings by our names, stated or equal."""
    headings = [str(heading) for heading in table.columns]
    for name, heading in columns.items():
        if name not in NAMES:
            raise FlightError(f"unknown column name {name!r}; expected one of {', '.join(NAMES)}")
        if heading not in headings:
            raise FlightError(f"no column {heading!r}; it has {_heading_list(headings)}")
    chosen = {**{name: name for name in NAMES if name in headings}, **columns}
    if "time" not in chosen:
        raise FlightError(f"expected --columns time=COLUMN; it has {_heading_list(headings)}")
    return chosen


def _heading_list(headings: Sequence[str]) -> str:
    """Returns headings as one line of limited length."""
    return " ".join(", ".join(headings[:_MOST_LISTED]).split())[:_LONGEST_LIST] or "none"


def _numbers(table: pd.DataFrame, heading: str) -> Float[np.ndarray, "n"]:
    try:
        return np.asarray(pd.to_numeric(table[heading]), np.float64)
    except (ValueError, TypeError) as error:
        raise FlightError(f"column {heading!r}: expected numbers: {' '.join(str(error).split())}") from None


def _in_ascending_order(numbers: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Returns the rows of a descending table in reverse."""
    steps = np.diff(numbers["time"])
    descending = bool((steps <= 0.0).all() and (steps < 0.0).any())
    return {name: column[::-1] for name, column in numbers.items()} if descending else numbers


def _sources(
    numbers: Mapping[str, np.ndarray], time: Float[np.ndarray, "n"], axes: Axes
) -> tuple[list[Source], str]:
    """Returns the measured sources and the origin of the velocity."""

    def vectors(names: tuple[str, ...]) -> Float[np.ndarray, "n k"] | None:
        return np.column_stack([numbers[name] for name in names]) if set(names) <= numbers.keys() else None

    sources = list(_linear_sources(numbers, time, axes))
    velocity = "columns" if set(VELOCITY[:2]) <= numbers.keys() else "absent"
    if velocity == "absent" and sources:
        sources.append(differentiate_position(sources[0]))
        velocity = "the slope of the position"
    quaternions, angles = vectors(QUATERNION), vectors(ANGLES)
    if quaternions is None and angles is not None:
        quaternions = quaternions_from_euler(*angles.T)
    if quaternions is not None:
        sources.append(attitude_source(time, axes.in_ned_frd(quaternions)))
    elif "yaw" in numbers:
        level = quaternions_from_euler(np.zeros(len(time)), np.zeros(len(time)), numbers["yaw"])
        turned = attitude_source(time, axes.in_ned_frd(level))
        sources.append(Source(turned.time, {"heading": turned.columns["heading"]}))
    rates = vectors(RATES)
    if rates is not None:
        sources.append(Source(time, dict(zip(BODY_RATES, axes.in_body(rates).T, strict=True))))
    if not sources:
        sets = (POSITION, VELOCITY, QUATERNION, ANGLES, RATES)
        raise FlightError(f"expected --columns for one of {', '.join(' '.join(names) for names in sets)}")
    return sources, velocity


def _linear_sources(
    numbers: Mapping[str, np.ndarray], time: Float[np.ndarray, "n"], axes: Axes
) -> Iterator[Source]:
    """Yields positions and velocities; a two-column map has no heights."""
    for names, start in ((POSITION, ""), (VELOCITY, "velocity_")):
        if set(names[:2]) <= numbers.keys():
            high = names[2] in numbers
            columns = [*(numbers[name] for name in names[:2]), numbers.get(names[2], np.zeros(len(time)))]
            north, east, down = axes.in_world(np.column_stack(columns)).T
            known = {f"{start}north": north, f"{start}east": east}
            yield Source(time, known | {f"{start}down": down} if high else known)


def _controls(numbers: Mapping[str, np.ndarray], time: Float[np.ndarray, "n"]) -> Series | None:
    present = [name for name in CONTROLS if name in numbers]
    if not present:
        return None
    values = np.column_stack([numbers[name] for name in present])
    valid = np.isfinite(values).all(axis=1) & (np.diff(time, prepend=-np.inf) > 0)
    names = [f"control_{name[1:]}" for name in present]
    return Series(ACTUATORS.only(names), time[valid], values[valid])
