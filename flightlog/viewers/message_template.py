"""Many protobuf messages of one layout as one block of bytes."""

import struct
from collections.abc import Mapping

import numpy as np
from google.protobuf.message import Message
from jaxtyping import Float, Int, UInt8

SECONDS, NANOSECONDS = 2**34 - 1, 2**29 - 1
"""Placeholders of the time in a template, encoded in five bytes each."""


def fill_template(
    template: Message, *, times: Int[np.ndarray, "n"], columns: Mapping[float, Float[np.ndarray, "n"]]
) -> UInt8[np.ndarray, "n size"]:
    """Returns one message a row, all of the template's size.

    Integers are padded to five bytes by continuation bytes of value zero, which every decoder accepts.

    Args:
        template: message with `SECONDS`, `NANOSECONDS` and the keys of `columns` as placeholders.
        times: nanoseconds.
        columns: values of the doubles by their placeholder in the template.
    """
    content = template.SerializeToString()
    messages = np.tile(np.frombuffer(content, np.uint8), (len(times), 1))
    for integer, values in ((SECONDS, times // 10**9), (NANOSECONDS, times % 10**9)):
        _replace(messages, content, _five_bytes(np.array([integer])).tobytes(), _five_bytes(values))
    for mark, column in columns.items():
        numbers = np.ascontiguousarray(column, "<f8").view(np.uint8).reshape(-1, 8)
        _replace(messages, content, struct.pack("<d", mark), numbers)
    return messages


def _replace(
    messages: UInt8[np.ndarray, "n size"], content: bytes, mark: bytes, values: UInt8[np.ndarray, "n width"]
) -> None:
    """Writes values at every placeholder in the template."""
    place = content.find(mark)
    assert place >= 0, mark
    while place >= 0:
        messages[:, place : place + len(mark)] = values
        place = content.find(mark, place + len(mark))


def _five_bytes(values: Int[np.ndarray, "n"]) -> UInt8[np.ndarray, "n 5"]:
    """Returns five-byte base-128 integers, least significant digit first."""
    digits = values[:, None] >> (7 * np.arange(5)) & 127
    digits[:, :4] |= 128
    return digits.astype(np.uint8)
