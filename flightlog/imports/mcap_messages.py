"""Messages of other programs: decoded by whatever encoding, and searched for what says where a vehicle is.

What a message means is told by the names of its fields, which ROS 2, Foxglove and PX4 largely share:
`position` or `translation`, `orientation`, `rotation` or `q`, `linear` or `velocity`, `angular`.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass
from mcap.records import Channel, Schema

from flight.errors import FlightError

Path = tuple[str, ...]
Decoder = Callable[[bytes], Any]

POSITION = ("position", "translation", "point")
ATTITUDE = ("orientation", "rotation", "q")
LINEAR = ("linear", "linear_velocity", "velocity", "vector")
ANGULAR = ("angular", "angular_velocity")

_MAX_DEPTH = 4
_XYZ, _WXYZ = ("x", "y", "z"), ("w", "x", "y", "z")


class UnknownEncodingError(FlightError):
    """A channel is encoded in a way that is not read here."""

    def __init__(self, channel: Channel, schema: Schema | None) -> None:
        described = schema.encoding if schema is not None else "nothing"
        super().__init__(
            f"{channel.topic}: expected messages in CDR described by ros2msg, in protobuf or in JSON, "
            f"got {channel.message_encoding or 'none'} described by {described or 'nothing'}"
        )


@dataclass(frozen=True, slots=True)
class VectorPath:
    """Where a vector or quaternion stands in the messages of a topic, and its numbers' order."""

    path: Path
    axes: tuple[str, ...]

    def numbers(self, message: Any) -> tuple[float, ...]:
        """Returns its numbers; not-a-numbers where this message has none."""
        value = message
        for name in self.path:
            value = _part(value, name)
        numbers = _vector(value, self.axes)
        return numbers if numbers is not None else (float("nan"),) * len(self.axes)


def decoder_of(channel: Channel, schema: Schema | None) -> Decoder:
    """Returns what makes an object of a channel's bytes.

    Raises:
        ForeignEncodingError: the encoding is not read here.
    """
    if channel.message_encoding == "json":
        return json.loads
    if schema is not None and (channel.message_encoding, schema.encoding) == ("protobuf", "protobuf"):
        pool = DescriptorPool()
        for file in FileDescriptorSet.FromString(schema.data).file:
            pool.Add(file)
        decode: Decoder = GetMessageClass(pool.FindMessageTypeByName(schema.name)).FromString
        return decode
    if schema is not None and (channel.message_encoding, schema.encoding) == ("cdr", "ros2msg"):
        from mcap_ros2.decoder import DecoderFactory

        ros = DecoderFactory().decoder_for("cdr", schema)
        if ros is not None:
            return ros
    raise UnknownEncodingError(channel, schema)


def find_vector(message: Any, names: Sequence[str]) -> VectorPath | None:
    """Returns where a vector of one of these names stands, the least deep first."""
    return _find(message, names, _XYZ)


def find_quaternion(message: Any) -> VectorPath | None:
    """Returns where a quaternion stands; a bare list is meant as w, x, y, z, as PX4 has it."""
    return _find(message, ATTITUDE, _WXYZ)


def stamp_of(message: Any) -> int:
    """Returns the time that a message carries, nanoseconds; 0 where it carries none."""
    for owner in (_part(message, "header"), message):
        for name in ("stamp", "timestamp"):
            stamp = _part(owner, name)
            seconds = _first_part(stamp, ("sec", "seconds", "secs"))
            if seconds is not None:
                return int(seconds) * 10**9 + int(_first_part(stamp, ("nanosec", "nanos", "nsec")) or 0)
    return 0


def frame_of(message: Any) -> str:
    """Returns the name of the frame that a message says it is meant in; empty where it says none."""
    name = _part(_part(message, "header"), "frame_id") or _part(message, "frame_id")
    return name if isinstance(name, str) else ""


def _find(message: Any, names: Sequence[str], axes: tuple[str, ...]) -> VectorPath | None:
    level: list[tuple[Path, Any]] = [((), message)]
    for _ in range(_MAX_DEPTH):
        for name in names:
            for path, owner in level:
                if _vector(_part(owner, name), axes) is not None:
                    return VectorPath((*path, name), axes)
        level = [((*path, name), _part(owner, name)) for path, owner in level for name in _names(owner)]
    return None


def _vector(value: Any, axes: tuple[str, ...]) -> tuple[float, ...] | None:
    """Returns the numbers of a vector, be it an object with axes or a list; None where it is neither."""
    parts: list[Any]
    if isinstance(value, str | bytes) or value is None:
        return None
    if _names(value):
        # Of a quaternion's axes a vector has three; but then it has no w.
        parts = [_part(value, axis) for axis in axes]
        if axes == _XYZ and _part(value, "w") is not None:
            return None
    elif hasattr(value, "__len__") and hasattr(value, "__getitem__") and len(value) == len(axes):
        parts = list(value)
    else:
        return None
    if not all(isinstance(part, int | float) for part in parts):
        return None
    return tuple(float(part) for part in parts)


def _first_part(value: Any, names: Sequence[str]) -> Any:
    return next((part for name in names if (part := _part(value, name)) is not None), None)


def _part(value: Any, name: str) -> Any:
    return value.get(name) if isinstance(value, dict) else getattr(value, name, None)


def _names(value: Any) -> tuple[str, ...]:
    """Returns the names of the parts of an object, whatever decoded it."""
    if isinstance(value, dict):
        return tuple(value)
    if isinstance(value, Message):
        return tuple(value.DESCRIPTOR.fields_by_name)
    slots: tuple[str, ...] = getattr(value, "__slots__", ())
    return tuple(slots) or tuple(getattr(value, "__dict__", ()))
