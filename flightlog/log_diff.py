"""In what two flight logs differ, in words: attachments, the header, and topics from a time on."""

from collections.abc import Iterator
from dataclasses import asdict

import numpy as np

from .log import FlightLog
from .topic import Series


def differences(expected: FlightLog, got: FlightLog) -> tuple[str, ...]:
    """Returns each thing in which a log differs from another; empty where a reader sees none."""
    return tuple(_header(expected, got)) + tuple(_attachments(expected, got)) + tuple(_topics(expected, got))


def count_differing_bytes(one: bytes, other: bytes) -> int:
    """Returns how many bytes differ, place by place; those that only one has differ too."""
    shared = min(len(one), len(other))
    first, second = (np.frombuffer(content, np.uint8, shared) for content in (one, other))
    return int((first != second).sum()) + abs(len(one) - len(other))


def _header(expected: FlightLog, got: FlightLog) -> Iterator[str]:
    other = asdict(got.header)
    for name, value in asdict(expected.header).items():
        if value != other[name]:
            yield f"{name} is {other[name]}, was {value}"


def _attachments(expected: FlightLog, got: FlightLog) -> Iterator[str]:
    for name in sorted(expected.attachments.keys() | got.attachments.keys()):
        if expected.attachments.get(name) != got.attachments.get(name):
            yield f"{name} differs"


def _topics(expected: FlightLog, got: FlightLog) -> Iterator[str]:
    for name in sorted(expected.series.keys() | got.series.keys()):
        if name not in expected.series or name not in got.series:
            yield f"only one has {name}"
        elif told := _first_difference(expected.series[name], got.series[name]):
            yield f"{name} {told}"


def _first_difference(expected: Series, got: Series) -> str:
    shared = min(len(expected), len(got))
    # Bits, not numbers: -0.0 is another number than 0.0, and a broken one equals itself.
    bits = [series.values[:shared].view(np.uint64) for series in (expected, got)]
    rows = (bits[0] != bits[1]).any(axis=1) | (_nanoseconds(expected)[:shared] != _nanoseconds(got)[:shared])
    if rows.any():
        largest = np.abs(expected.values[:shared] - got.values[:shared]).max()
        return f"differs from {expected.time[:shared][rows][0]:.2f} s on, by {largest:.3g} at most"
    return f"has {len(got)} messages, had {len(expected)}" if len(expected) != len(got) else ""


def _nanoseconds(series: Series) -> np.ndarray:
    """Returns times as files hold them."""
    return np.rint(series.time * 1e9)
