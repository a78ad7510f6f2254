"""Odometry of the circle in JSON, in MCAP files."""

import io
import json
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import zstandard
from mcap.writer import CompressionType, IndexType, Writer

from .flown_circle import HEIGHT, RADIUS, RATE, SPEED, TIME

START = 1_700_000_000
TURNED = RATE * TIME
NORTH, EAST = RADIUS * np.sin(TURNED), RADIUS * (1.0 - np.cos(TURNED))

Message = dict[str, Any]


def stamp(time: float) -> Message:
    """Returns a stamp of ROS."""
    return {"sec": START + int(time), "nanosec": round(time % 1.0 * 1e9)}


def odometry(row: int, *, child: str = "base_link") -> Message:
    """Returns odometry of ROS: axes east, north, up, velocities along the body."""
    half = 0.5 * (0.5 * np.pi - TURNED[row])
    pose = {
        "position": {"x": EAST[row], "y": NORTH[row], "z": HEIGHT},
        "orientation": {"x": 0.0, "y": 0.0, "z": np.sin(half), "w": np.cos(half)},
    }
    twist = {"linear": {"x": SPEED, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": -RATE}}
    header = {"stamp": stamp(TIME[row]), "frame_id": "odom"}
    return {"header": header, "child_frame_id": child, "pose": {"pose": pose}, "twist": {"twist": twist}}


def json_bag(
    messages: Iterable[tuple[float, Message]],
    *,
    schema: str = "nav_msgs/msg/Odometry",
    compressed: bool = False,
    repeated: bool = True,
) -> bytes:
    """Returns an MCAP file of messages in JSON, with their log times in seconds."""
    stream = io.BytesIO()
    options = (
        {} if repeated else {"repeat_channels": False, "repeat_schemas": False, "index_types": IndexType.NONE}
    )
    writer = Writer(stream, compression=CompressionType.ZSTD, **options)  # type: ignore[arg-type]
    writer.start()
    channel = writer.register_channel("/odom", "json", writer.register_schema(schema, "jsonschema", b"{}"))
    for time, message in messages:
        data = json.dumps(message).encode()
        logged = START * 10**9 + round(time * 1e9)
        writer.add_message(channel, logged, zstandard.compress(data) if compressed else data, logged)
    writer.finish()  # type: ignore[no-untyped-call]
    return stream.getvalue()


def messages_of(places: Sequence[int] | range = range(len(TIME))) -> list[tuple[float, Message]]:
    """Returns odometry with its log times, in the order of places."""
    return [(TIME[place] + 0.003, odometry(place)) for place in places]
