"""Differences of two flight logs in words."""

from collections.abc import Iterator
from dataclasses import asdict

import numpy as np

from flightlog.log import FlightLog
from flightlog.series import Series


def differences(expected: FlightLog, got: FlightLog) -> tuple[str, ...]:
    """Returns the differences of two logs; empty if none."""
    return tuple(_header(expected, got)) + tuple(_attachments(expected, got)) + tuple(_topics(expected, got))


def count_differing_bytes(one: bytes, other: bytes) -> int:
    """Returns the number of differing bytes, extra ones included."""
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
            yield f"only one log has {name}"
        elif difference := _first_difference(expected.series[name], got.series[name]):
            yield f"{name} {difference}"


def _first_difference(expected: Series, got: Series) -> str:
    shared = min(len(expected), len(got))
    # Bits, not numbers: -0.0 differs from 0.0, and not-a-number equals itself.
    bits = [series.values[:shared].view(np.uint64) for series in (expected, got)]
    rows = (bits[0] != bits[1]).any(axis=1) | (_nanoseconds(expected)[:shared] != _nanoseconds(got)[:shared])
    if rows.any():
        largest = np.abs(expected.values[:shared] - got.values[:shared]).max()
        return f"differs from {expected.time[:shared][rows][0]:.2f} s on, by {largest:.3g} at most"
    return f"has {len(got)} messages, had {len(expected)}" if len(expected) != len(got) else ""


def _nanoseconds(series: Series) -> np.ndarray:
    """Returns times as stored in files."""
    return np.rint(series.time * 1e9)
