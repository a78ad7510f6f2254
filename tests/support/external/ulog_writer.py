"""ULog of PX4, written from its specification."""

import struct
from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

_LETTERS = {"uint64_t": "Q", "float": "f", "bool": "B", "uint8_t": "B"}

Columns = Mapping[str, tuple[str, Float[np.ndarray, "n"]]]
"""Fields of a topic by name: their type and their values; `timestamp` in microseconds."""


def ulog(topics: Mapping[str, Columns]) -> bytes:
    """Returns a log with messages in the order of their times."""
    parts = [b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0)]
    messages: list[tuple[int, bytes]] = []
    for name, columns in topics.items():
        fields = "".join(f"{kind} {field};" for field, (kind, _) in columns.items())
        parts.append(_message("F", f"{name}:{fields}".encode()))
    for number, (name, columns) in enumerate(topics.items()):
        parts.append(_message("A", struct.pack("<BH", 0, number) + name.encode()))
        layout = struct.Struct("<H" + "".join(_LETTERS[kind] for kind, _ in columns.values()))
        whole = {field: kind != "float" for field, (kind, _) in columns.items()}
        for row in range(len(columns["timestamp"][1])):
            values = [
                int(column[row]) if whole[field] else float(column[row])
                for field, (_, column) in columns.items()
            ]
            content = layout.pack(number, *values)
            messages.append((int(columns["timestamp"][1][row]), _message("D", content)))
    parts += [content for _, content in sorted(messages, key=lambda message: message[0])]
    return b"".join(parts)


def _message(kind: str, content: bytes) -> bytes:
    return struct.pack("<HB", len(content), ord(kind)) + content
