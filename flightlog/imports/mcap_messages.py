"""Decoding of MCAP messages and search for poses and velocities.

The names of the fields identify them; ROS 2, Foxglove and PX4 share most of these names:
`position` or `translation`, `orientation`, `rotation` or `q`, `linear` or `velocity`, `angular`.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any

from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import Message
from google.protobuf.message_factory import GetMessageClass
from mcap.records import Channel, Schema

from flight.errors import FlightError

from .bags.ros_bag import idl_decoder, ros1_decoder

Path = tuple[str, ...]
Decoder = Callable[[bytes], Any]

POSITION = ("position", "translation", "point")
ATTITUDE = ("orientation", "rotation", "q")
LINEAR = ("linear", "linear_velocity", "velocity", "vector")
ANGULAR = ("angular", "angular_velocity")

_MAX_DEPTH = 4
_XYZ, _WXYZ = ("x", "y", "z"), ("w", "x", "y", "z")


class UnknownEncodingError(FlightError):
    """Channel with an unsupported encoding."""

    def __init__(self, channel: Channel, schema: Schema | None) -> None:
        described = schema.encoding if schema is not None else "nothing"
        super().__init__(
            f"{channel.topic}: expected messages in CDR described by ros2msg or ros2idl, of ROS 1, in "
            "protobuf or in JSON, "
            f"got {channel.message_encoding or 'none'} described by {described or 'nothing'}"
        )


@dataclass(frozen=True, slots=True)
class VectorPath:
    """Path to a vector or quaternion in a message, and its axes."""

    path: Path
    axes: tuple[str, ...]
    listed: bool = False

    def numbers(self, message: Any) -> tuple[float, ...]:
        """Returns the components; not-a-numbers if the message has none."""
        value = message
        for name in self.path:
            value = _part(value, name)
        numbers = _vector(value, self.axes)
        return numbers if numbers is not None else (float("nan"),) * len(self.axes)


def decoder_of(channel: Channel, schema: Schema | None) -> Decoder:
    """Returns a decoder of a channel's messages.

    Raises:
        UnknownEncodingError: the encoding is not supported.
    """
    if channel.message_encoding == "json":
        return json.loads
    if schema is not None and (channel.message_encoding, schema.encoding) == ("protobuf", "protobuf"):
        pool = DescriptorPool()
        for file in FileDescriptorSet.FromString(schema.data).file:
            pool.Add(file)
        decode: Decoder = GetMessageClass(pool.FindMessageTypeByName(schema.name)).FromString
        return decode
    kind = (channel.message_encoding, schema.encoding) if schema is not None else ("", "")
    if schema is not None and kind == ("cdr", "ros2msg"):
        from mcap_ros2.decoder import DecoderFactory

        ros = DecoderFactory().decoder_for("cdr", schema)
        if ros is not None:
            return ros
    if schema is not None and kind in {("ros1", "ros1msg"), ("cdr", "ros2idl")}:
        try:
            text = schema.data.decode()
            return ros1_decoder(schema.name, text) if kind[0] == "ros1" else idl_decoder(schema.name, text)
        except FlightError:
            raise
        except Exception as error:
            reason = " ".join(str(error).split()) or type(error).__name__
            raise FlightError(f"{channel.topic}: schema {schema.name!r} cannot be read: {reason}") from None
    raise UnknownEncodingError(channel, schema)


def find_vector(message: Any, names: Sequence[str]) -> VectorPath | None:
    """Returns the path to a vector of given names, shallowest first."""
    return _find(message, names, _XYZ)


def find_quaternion(message: Any) -> VectorPath | None:
    """Returns the path to a quaternion; lists are w, x, y, z."""
    return _find(message, ATTITUDE, _WXYZ)


def stamp_of(message: Any) -> int | float | str | None:
    """Returns a message's stamp in nanoseconds or as it is, if any.

    A stamp of seconds and nanoseconds is an integer of nanoseconds in a `Nanoseconds`.
    """
    for owner in (_part(message, "header"), message):
        for name in ("stamp", "timestamp", "time"):
            stamp = _part(owner, name)
            seconds = _first_part(stamp, ("sec", "seconds", "secs"))
            if seconds is not None:
                whole = int(seconds) * 10**9 + int(
                    _first_part(stamp, ("nanosec", "nanos", "nsec", "nsecs")) or 0
                )
                return Nanoseconds(whole if 0 < whole < 2**63 else 0)
            if isinstance(stamp, int | float | str) and not isinstance(stamp, bool):
                return stamp
    return None


class Nanoseconds(int):
    """Stamp in nanoseconds."""


def child_frame_of(message: Any) -> str:
    """Returns the child or body frame of a message, or empty."""
    name = _first_part(message, ("child_frame_id", "body_frame_id"))
    return name.lstrip("/") if isinstance(name, str) else ""


def number_of(message: Any, name: str) -> float:
    """Returns a number of a message; not-a-number without it."""
    value = _part(message, name)
    return float(value) if isinstance(value, Real | bool) else float("nan")


def transforms_of(message: Any) -> Sequence[Any] | None:
    """Returns the transforms of a TFMessage; None for another message."""
    value = _part(message, "transforms")
    return value if isinstance(value, list | tuple) else None


def frame_of(message: Any) -> str:
    """Returns the frame name of a message; empty without one."""
    name = _part(_part(message, "header"), "frame_id") or _part(message, "frame_id")
    return name.lstrip("/") if isinstance(name, str) else ""


def _find(message: Any, names: Sequence[str], axes: tuple[str, ...]) -> VectorPath | None:
    level: list[tuple[Path, Any]] = [((), message)]
    for _ in range(_MAX_DEPTH):
        for name in names:
            for path, owner in level:
                part = _part(owner, name)
                if _vector(part, axes) is not None:
                    return VectorPath((*path, name), axes, listed=not _names(part))
        level = [((*path, name), _part(owner, name)) for path, owner in level for name in _names(owner)]
    return None


def _vector(value: Any, axes: tuple[str, ...]) -> tuple[float, ...] | None:
    """Returns the components of an object or list; None if neither."""
    parts: list[Any]
    if isinstance(value, str | bytes) or value is None:
        return None
    if _names(value):
        # A quaternion has x, y and z too; a vector has no w.
        parts = [_part(value, axis) for axis in axes]
        if axes == _XYZ and _part(value, "w") is not None:
            return None
    elif hasattr(value, "__len__") and hasattr(value, "__getitem__") and len(value) == len(axes):
        parts = list(value)
    else:
        return None
    if not all(isinstance(part, Real) for part in parts):
        return None
    return tuple(float(part) for part in parts)


def _first_part(value: Any, names: Sequence[str]) -> Any:
    return next((part for name in names if (part := _part(value, name)) is not None), None)


def _part(value: Any, name: str) -> Any:
    return value.get(name) if isinstance(value, dict) else getattr(value, name, None)


def _names(value: Any) -> tuple[str, ...]:
    """Returns the names of an object's parts, for any decoder."""
    if isinstance(value, dict):
        return tuple(value)
    if isinstance(value, Message):
        return tuple(value.DESCRIPTOR.fields_by_name)
    slots: tuple[str, ...] = getattr(value, "__slots__", ())
    return tuple(slots) or tuple(getattr(value, "__dict__", ()))
