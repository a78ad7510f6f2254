"""Blocks of equally sized MCAP messages as NumPy arrays."""

from typing import Any

import numpy as np
from mcap.opcode import Opcode

from flightlog.series import Topic

_HEAD = [
    ("opcode", "u1"),
    ("length", "<u8"),
    ("channel", "<u2"),
    ("sequence", "<u4"),
    ("log_time", "<u8"),
    ("publish_time", "<u8"),
]


def topic_type(topic: Topic) -> np.dtype[Any]:
    """Returns the array type of a topic's messages: tag bytes and doubles."""
    payload = [part for number in topic.numbers for part in ((f"t{number}", "u1"), (f"v{number}", "<f8"))]
    return np.dtype([*_HEAD, *payload])


def bytes_type(size: int) -> np.dtype[Any]:
    """Returns the array type of messages with payloads of one size."""
    return np.dtype([*_HEAD, ("payload", "u1", (size,))])


def empty_messages(kind: np.dtype[Any], count: int) -> np.ndarray[Any, Any]:
    """Returns messages with their constant fields set."""
    messages = np.zeros(count, kind)
    messages["opcode"] = Opcode.MESSAGE
    messages["length"] = kind.itemsize - 9
    for name in filter(_is_tag, kind.names or ()):
        messages[name] = int(name[1:]) << 3 | 1
    return messages


def constant_fields(kind: np.dtype[Any]) -> tuple[str, ...]:
    """Returns the fields that are equal in all messages."""
    return ("opcode", "length", *(name for name in kind.names or () if _is_tag(name)))


def _is_tag(name: str) -> bool:
    return name.startswith("t") and name[1:].isdigit()


def view_at_every_byte(content: np.ndarray[Any, Any], kind: np.dtype[Any]) -> np.ndarray[Any, Any]:
    """Returns a view of bytes with one message for each start byte."""
    count = max(len(content) - kind.itemsize + 1, 0)
    return np.ndarray((count,), np.dtype((np.void, kind.itemsize)), content.data, strides=(1,))
