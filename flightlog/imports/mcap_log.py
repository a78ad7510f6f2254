"""Import of MCAP files as flight logs."""

import io
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import zstandard
from google.protobuf.message import DecodeError
from jaxtyping import Float, Int
from mcap.exceptions import McapError
from mcap.reader import McapReader, make_reader

from flight.errors import BadFileError, FlightError
from flightlog.file.writer import LARGEST_LOG
from flightlog.log import FlightLog
from flightlog.series import Topic

from .axes import Axes, BodyAxes, WorldAxes
from .clock import ClockError, check_clock
from .imported_log import ExternalLog
from .mcap_messages import (
    ANGULAR,
    LINEAR,
    POSITION,
    Decoder,
    VectorPath,
    decoder_of,
    find_quaternion,
    find_vector,
    frame_of,
    stamp_of,
)
from .measured_motion import (
    BODY_RATES,
    WORLD_RATES,
    Source,
    attitude_source,
    differentiate_position,
    measured_states,
)

VelocityAxes = Literal["world", "body"]

_MOST_LISTED = 12
_UNREADABLE = (
    *(McapError, DecodeError, ValueError, KeyError, TypeError, AttributeError, EOFError, IndexError),
    *(struct.error, zstandard.ZstdError, MemoryError, OverflowError, RuntimeError),
)
# Package of PX4's ROS 2 messages, which use PX4's axes.
_PX4 = "px4_msgs/"
_IN_BODY = ("Odometry",)


@dataclass(frozen=True, slots=True)
class McapImportSettings:
    """Topics and axes of an import; None for those of the messages.

    Attributes:
        pose: topic of positions and attitudes.
        velocity: topic of velocities; if None those of the pose topic, or the derivative of the position.
        world: axes of the world.
        body: axes of the body.
        velocity_in: axes of the velocities: world or body.
    """

    pose: str
    velocity: str | None = None
    world: WorldAxes | None = None
    body: BodyAxes | None = None
    velocity_in: VelocityAxes | None = None


@dataclass(frozen=True, slots=True, eq=False)
class _Table:
    """Messages of a topic with schema, frame, and times in nanoseconds."""

    schema: str
    frame: str
    logged: Int[np.ndarray, "n"]
    stamped: Int[np.ndarray, "n"]
    messages: Sequence[Any]

    def vectors(self, found: VectorPath) -> Float[np.ndarray, "n k"]:
        return np.array([found.numbers(message) for message in self.messages])


def read_external_mcap(path: Path, settings: McapImportSettings, *, topic: Topic) -> FlightLog:
    """Reads pose and velocity topics in ROS 2, protobuf or JSON.

    Times are the stamps of the messages, or the log times if a topic has no stamps or they jump. Without
    velocities the position is differentiated. The attachment records these choices.

    Args:
        path: file to read.
        settings: topics and axes.
        topic: topic of the motion: estimate or truth.

    Raises:
        BadFileError: the file is damaged, lacks the topics, or they hold no motion.
    """
    file = ExternalLog.read(path)
    if len(file.content) > LARGEST_LOG:
        raise BadFileError(path, f"expected at most {LARGEST_LOG} bytes, got {len(file.content)}")
    names = [settings.pose, *([settings.velocity] if settings.velocity else [])]
    try:
        tables = _tables(file.content, names)
        sources, provenance = _sources(tables, settings)
        states = measured_states(sources, topic)
    except FlightError as error:
        raise BadFileError(path, str(error)) from None
    except _UNREADABLE as error:
        text = " ".join(str(error).split()) or type(error).__name__
        raise BadFileError(
            path, f"cannot be read: {text}; `maneuver recover` saves the undamaged part"
        ) from None
    if states is None:
        raise BadFileError(path, f"expected a motion in {names}, got fewer than two usable messages")
    return file.log([states], provenance=provenance)


def _tables(content: bytes, names: Sequence[str]) -> dict[str, _Table]:
    reader = make_reader(io.BytesIO(content), validate_crcs=True)
    _check_topics_exist(reader, names)
    schemas: dict[str, str] = {}
    decoders: dict[int, Decoder] = {}
    rows: dict[str, list[tuple[int, Any]]] = {name: [] for name in names}
    for schema, channel, message in reader.iter_messages(topics=list(names)):
        if channel.id not in decoders:
            decoders[channel.id] = decoder_of(channel, schema)
            schemas[channel.topic] = schema.name if schema is not None else ""
        rows[channel.topic].append((message.log_time, decoders[channel.id](message.data)))
    empty = [name for name, part in rows.items() if not part]
    if empty:
        raise FlightError(f"expected messages in {empty}, got none")
    return {
        name: _Table(
            schema=schemas[name],
            frame=frame_of(part[0][1]),
            logged=np.array([time for time, _ in part], np.int64),
            stamped=np.array([stamp_of(message) for _, message in part], np.int64),
            messages=[message for _, message in part],
        )
        for name, part in rows.items()
    }


def _check_topics_exist(reader: McapReader, names: Sequence[str]) -> None:
    """Refuses topics that the file does not have, and lists its own."""
    summary = reader.get_summary()
    if summary is None:
        raise ValueError("it has no summary of its topics")
    found = {
        channel.topic: summary.schemas[channel.schema_id].name
        if channel.schema_id in summary.schemas
        else channel.message_encoding
        for channel in summary.channels.values()
    }
    absent = [name for name in names if name not in found]
    if absent:
        listed = [f"{topic} ({schema})" for topic, schema in sorted(found.items())]
        more = f" and {len(listed) - _MOST_LISTED} more" if len(listed) > _MOST_LISTED else ""
        raise FlightError(f"no topic {absent[0]}; it has {', '.join(listed[:_MOST_LISTED]) or 'none'}{more}")


def _sources(
    tables: Mapping[str, _Table], settings: McapImportSettings
) -> tuple[list[Source], dict[str, object]]:
    """Returns the measured sources and their provenance."""
    stamped = all(_has_clock(table) for table in tables.values())
    start = min((table.stamped if stamped else table.logged).min() for table in tables.values())
    pose = tables[settings.pose]
    moving = tables[settings.velocity] if settings.velocity else pose
    px4 = pose.schema.startswith(_PX4)
    axes = Axes(settings.world or ("ned" if px4 else "enu"), settings.body or ("frd" if px4 else "flu"))
    velocity_in = settings.velocity_in or ("world" if px4 else _velocity_axes(pose, moving))

    def clock(table: _Table) -> Float[np.ndarray, "n"]:
        return np.asarray(((table.stamped if stamped else table.logged) - start) * 1e-9)

    for name, table in tables.items():
        check_clock(clock(table), sample=f"{name} message")
    sources = list(_pose_sources(pose, clock(pose), axes))
    if not sources:
        raise FlightError(f"{settings.pose} ({pose.schema}): expected a position or orientation, got none")
    velocities = list(_velocity_sources(moving, clock(moving), axes, velocity_in))
    taken = f"{settings.velocity or settings.pose}, along the axes of the {velocity_in}"
    if not any({"velocity_north", "body_forward"} & set(part.columns) for part in velocities):
        if settings.velocity:
            raise FlightError(f"{settings.velocity} ({moving.schema}): expected a velocity, got none")
        taken = "absent"
        if "north" in sources[0].columns:
            velocities.append(differentiate_position(sources[0]))
            taken = "the slope of the position"
    provenance: dict[str, object] = {
        "pose": f"{settings.pose} ({pose.schema})",
        "velocity": taken,
        "world axes": axes.world,
        "body axes": axes.body,
        "times": "of the messages" if stamped else "of logging",
    }
    return [*sources, *velocities], provenance


def _has_clock(table: _Table) -> bool:
    """Returns True if all messages have stamps, of one clock."""
    if not (table.stamped > 0).all():
        return False
    try:
        check_clock(table.stamped * 1e-9, sample="message")
    except ClockError:
        return False
    return True


def _velocity_axes(pose: _Table, moving: _Table) -> VelocityAxes:
    """Returns the axes of a velocity: body for odometry, else by frame."""
    if moving.schema.endswith(_IN_BODY):
        return "body"
    return "world" if moving.frame == pose.frame else "body"


def _pose_sources(table: _Table, time: Float[np.ndarray, "n"], axes: Axes) -> Iterator[Source]:
    first = table.messages[0]
    place, attitude = find_vector(first, POSITION), find_quaternion(first)
    if place is not None:
        north, east, down = axes.in_world(table.vectors(place)).T
        yield Source(time, {"north": north, "east": east, "down": down})
    if attitude is not None:
        yield attitude_source(time, axes.in_ned_frd(table.vectors(attitude)))


def _velocity_sources(
    table: _Table, time: Float[np.ndarray, "n"], axes: Axes, velocity_in: VelocityAxes
) -> Iterator[Source]:
    first = table.messages[0]
    linear, angular = find_vector(first, LINEAR), find_vector(first, ANGULAR)
    if linear is not None and velocity_in == "world":
        north, east, down = axes.in_world(table.vectors(linear)).T
        yield Source(time, {"velocity_north": north, "velocity_east": east, "velocity_down": down})
    elif linear is not None:
        forward, right, down = axes.in_body(table.vectors(linear)).T
        yield Source(time, {"body_forward": forward, "body_right": right, "body_down": down})
    if angular is not None:
        # Both parts of a twist share their axes; a field `angular_velocity` is in body axes.
        twist_in_world = angular.path[-1] == "angular" and velocity_in == "world"
        turning = table.vectors(angular)
        about = axes.in_world(turning) if twist_in_world else axes.in_body(turning)
        yield Source(time, dict(zip(WORLD_RATES if twist_in_world else BODY_RATES, about.T, strict=True)))
