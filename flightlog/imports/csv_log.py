"""Import of text tables as flight logs."""

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float

from flight.errors import BadFileError, FlightError
from flightlog.log import FlightLog
from flightlog.series import Series, Topic
from flightlog.topics import ACTUATORS

from .axes import quaternions_from_euler
from .clock import MOST_REPEATED, check_unit, order_by_time
from .commands import command_series, level_series
from .imported_log import ExternalLog, LeftOut
from .measured_motion import Source, attitude_source, differentiate_position, measured_states
from .motion.derived_fields import BODY_RATES
from .motion.frames import Frames, check_frames, velocity_source
from .motion.geodetic import local_plane
from .motion.resets import jumps, merged
from .motion.units import check_angles, check_rates, check_speeds, course_of
from .tables.headings import (
    ANGLE_NAMES,
    CONTROLS,
    GEODETIC,
    POSITION,
    QUATERNION,
    RATE_NAMES,
    VELOCITY,
    guesses,
)
from .tables.table import Table, TableSettings, of_one_vehicle, read_table, seconds_of

Column = Float[np.ndarray, "n"]


def read_external_csv(path: Path, settings: TableSettings, *, topic: Topic) -> FlightLog:
    """Reads a table with a row of headings, in any usual form.

    Args:
        path: file to read.
        settings: columns, units and axes.
        topic: topic of the motion: estimate or truth.

    Raises:
        BadFileError: the file is not such a table, holds no motion, or its numbers contradict what is stated.
    """
    file = ExternalLog(path)
    try:
        table = of_one_vehicle(read_table(path, settings), settings.vehicle)
        repeated = _repeated(table)
        _check_time_unit(table, repeated)
        part = order_by_time(seconds_of(table), sample="row", part=settings.part, repeated=repeated)
        time, table = part.time - part.time[0], table.rows(part.rows)
        if not settings.unchecked:
            _check_units(time, table)
        place, plane = _position(time, table.numbers, settings.frames)

        def build(frames: Frames) -> list[Source]:
            return _sources(time, table.numbers, frames, place)

        if not settings.unchecked:
            check_frames(build, settings.frames)
        sources = build(settings.frames)
        states = measured_states(sources, topic)
        if states is None:
            raise FlightError(f"expected at least two usable rows, got none of {part.total}")
    except FlightError as error:
        raise BadFileError(path, str(error)) from None
    velocity = "columns" if set(VELOCITY[:2]) <= table.numbers.keys() else "absent"
    if velocity == "absent" and any("velocity_north" in source.columns for source in sources):
        velocity = "the slope of the position"
    provenance = {
        "columns": ", ".join(f"{name}: {heading}" for name, heading in table.described.items()),
        "velocity": velocity,
        "world axes": settings.frames.world,
        "body axes": settings.frames.body,
        **({"place": plane} if plane else {}),
        **({"not used": ", ".join(guesses(table.unused))[:2000]} if table.unused else {}),
    }
    lost = dict(part.left_out)
    if table.left_out:
        lost["with too many cells"] = table.left_out
    controls = _controls(time, table.numbers)
    command = command_series(time, table.commands)
    levels = None if command is None else level_series(command, states)
    if command is not None:
        provenance["commands"] = ", ".join(
            f"input_{place}: {name}" for place, name in enumerate(table.commands, 1)
        )
    if levels is not None:
        provenance["levels"] = "; ".join(levels[1])[:2000]
    extra = (controls, command, levels[0] if levels else None)
    return file.log(
        [states, *(series for series in extra if series is not None)],
        provenance=provenance,
        breaks=merged(jumps(sources)),
        left_out=LeftOut.of("row", part.total + table.left_out, lost),
    )


def _repeated(table: Table) -> Bool[np.ndarray, "n"]:
    """Returns rows that are a copy of the one before."""
    columns = [*table.numbers.values(), *table.commands.values()]
    same = np.ones(len(columns[0]), bool)
    same[:1] = False
    for column in columns:
        same[1:] &= column[1:] == column[:-1]
    return same


def _check_time_unit(table: Table, repeated: Bool[np.ndarray, "n"]) -> None:
    """Refuses times that cannot be in their unit, unless coarse."""
    stamps = table.numbers["time"][~repeated]
    if (np.diff(stamps) == 0.0).sum() <= MOST_REPEATED * len(stamps):
        check_unit(stamps, table.units.get("time"))  # type: ignore[arg-type]


def _matrix(numbers: Mapping[str, Column], names: tuple[str, ...]) -> Float[np.ndarray, "n k"] | None:
    return np.column_stack([numbers[name] for name in names]) if set(names) <= numbers.keys() else None


def _check_units(time: Column, table: Table) -> None:
    """Refuses numbers that cannot be in the units assumed."""
    numbers, stated = table.numbers, frozenset(table.units)
    position, velocity = _matrix(numbers, POSITION[:2]), _matrix(numbers, VELOCITY[:2])
    if position is not None and velocity is not None:
        check_speeds(time, position, velocity, stated=stated)
    if "angle" not in stated:
        angles = {name: numbers[name] for name in ANGLE_NAMES if name in numbers}
        check_angles(angles, course_of(time, velocity, position))
    if "rate" not in stated and {"yaw", "wz"} <= numbers.keys():
        check_rates(numbers["yaw"], numbers["wz"], time)


def _position(time: Column, numbers: Mapping[str, Column], frames: Frames) -> tuple[list[Source], str]:
    """Returns the sources of the position, and its plane in words."""
    if set(GEODETIC[:2]) <= numbers.keys():
        source, plane = local_plane(time, numbers["lat"], numbers["lon"], numbers.get("alt"))
        return [source], plane
    if not set(POSITION[:2]) <= numbers.keys():
        return [], ""
    columns = [numbers["x"], numbers["y"], numbers.get("z", np.zeros(len(time)))]
    north, east, down = frames.axes.in_world(np.column_stack(columns)).T
    plane_only = Source(time, {"north": north, "east": east})
    return [plane_only, *([Source(time, {"down": down})] if "z" in numbers else [])], ""


def _sources(
    time: Column, numbers: Mapping[str, Column], frames: Frames, place: list[Source]
) -> list[Source]:
    """Returns the measured sources in given axes.

    Raises:
        FlightError: there is none.
    """
    if not set(GEODETIC[:2]) <= numbers.keys():
        place, _ = _position(time, numbers, frames)
    sources = [*place]
    if set(VELOCITY[:2]) <= numbers.keys():
        columns = [numbers["vx"], numbers["vy"], numbers.get("vz", np.zeros(len(time)))]
        velocity = velocity_source(time, np.column_stack(columns), frames)
        sources += _split_height(velocity, "vz" in numbers)
    elif place:
        sources += [differentiate_position(source) for source in place]
    sources += _attitude(time, numbers, frames)
    rates = _matrix(numbers, RATE_NAMES)
    if rates is not None:
        sources.append(Source(time, dict(zip(BODY_RATES, frames.axes.in_body(rates).T, strict=True))))
    elif "wz" in numbers:
        down = numbers["wz"] if frames.body == "frd" else -numbers["wz"]
        sources.append(Source(time, {"body_yaw_rate": down}))
    if not sources:
        sets = (POSITION, VELOCITY, QUATERNION, ANGLE_NAMES, RATE_NAMES, GEODETIC)
        raise FlightError(f"expected --columns for one of {', '.join(' '.join(names) for names in sets)}")
    return sources


def _split_height(velocity: Source, high: bool) -> Iterator[Source]:
    """Yields horizontal and vertical velocities; those along a body stay together."""
    if "body_down" in velocity.columns:
        kept = {name: column for name, column in velocity.columns.items() if high or name != "body_down"}
        yield Source(velocity.time, kept)
        return
    for names in (("velocity_north", "velocity_east"), ("velocity_down",) if high else ()):
        if names:
            yield Source(velocity.time, {name: velocity.columns[name] for name in names})


def _attitude(time: Column, numbers: Mapping[str, Column], frames: Frames) -> Iterator[Source]:
    quaternions, angles = _matrix(numbers, QUATERNION), _matrix(numbers, ANGLE_NAMES)
    if quaternions is None and angles is not None:
        quaternions = quaternions_from_euler(*angles.T)
    if quaternions is not None:
        yield attitude_source(time, frames.axes.in_ned_frd(quaternions))
    elif "yaw" in numbers:
        level = quaternions_from_euler(np.zeros(len(time)), np.zeros(len(time)), numbers["yaw"])
        turned = attitude_source(time, frames.axes.in_ned_frd(level))
        yield Source(turned.time, {"heading": turned.columns["heading"]})


def _controls(time: Column, numbers: Mapping[str, Column]) -> Series | None:
    present = [name for name in CONTROLS if name in numbers]
    if not present:
        return None
    values = np.column_stack([numbers[name] for name in present])
    valid = np.isfinite(values).all(axis=1)
    names = [f"control_{name[1:]}" for name in present]
    return Series(ACTUATORS.only(names), time[valid], values[valid]) if valid.any() else None
