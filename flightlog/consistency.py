"""What a flight log may not say: contradictions that no checksum finds, because another writer meant them."""

from dataclasses import asdict

import numpy as np

from .channels import PRIMITIVE, TRUTH
from .log import FlightLog
from .primitives import PrimitiveKind
from .topic import Series

LONGEST_NAME = 200
"""Characters of a name in the header."""

LARGEST_VALUE = 1e9
"""Metres, radians and their rates: no flight comes near it."""

_ROUNDING = 1e-6


def check_log_consistency(log: FlightLog) -> None:
    """Refuses a log whose series cannot be a flight's.

    Raises:
        ValueError: a time goes back or is not finite, a value is not finite, a topic has no message, a
            primitive is of no known kind, or a name in the header is no name; says which.
    """
    for name, words in asdict(log.header).items():
        text = str(words)
        if len(text) > LONGEST_NAME or not text.isprintable():
            raise ValueError(
                f"{name} in its header: expected at most {LONGEST_NAME} printable characters, "
                f"got {text[:40]!r}"
            )
    for series in log.series.values():
        _check_values(series)
    if PRIMITIVE.name in log.series:
        _check_primitive_kinds(log[PRIMITIVE])
        if TRUTH.name in log.series:
            _check_primitives_have_truth(log[PRIMITIVE], log[TRUTH])


def _check_values(series: Series) -> None:
    name = series.topic.name
    if not len(series):
        raise ValueError(f"{name} is announced but has no message")
    impossible = ~(np.abs(series.values) < LARGEST_VALUE)
    if impossible.any():
        row, column = np.argwhere(impossible)[0]
        raise ValueError(
            f"{name} {series.topic.fields[column].name} at {series.time[row]:.2f} s: expected a number below "
            f"{LARGEST_VALUE:g} in size, got {series.values[row, column]}"
        )
    back = np.flatnonzero(np.diff(series.time) < 0)
    if len(back):
        raise ValueError(f"{name}: time goes back after {series.time[back[0]]:.2f} s")


def _check_primitive_kinds(series: Series) -> None:
    kinds = np.array([kind.value for kind in PrimitiveKind], dtype=float)
    if not np.isin(series["kind"], kinds).all():
        raise ValueError(f"{series.topic.name} kind: expected one of {kinds.astype(int).tolist()}")
    for field in ("id", "from_trim", "to_trim"):
        if not (series[field] == np.rint(series[field])).all():
            raise ValueError(f"{series.topic.name} {field}: expected whole numbers")


def _check_primitives_have_truth(primitives: Series, truth: Series) -> None:
    """Refuses primitives in which there is no true state: nothing could be said of them."""
    begins = primitives.time
    ends = np.append(begins[1:], max(truth.time[-1], begins[-1]))
    first = np.searchsorted(truth.time, begins - _ROUNDING)
    last = np.searchsorted(truth.time, ends + _ROUNDING)
    unseen = np.flatnonzero(first == last)
    if len(unseen):
        raise ValueError(
            f"{truth.topic.name} has no state in the primitive at {begins[unseen[0]]:.2f} s; "
            f"it lasts from {truth.time[0]:.2f} to {truth.time[-1]:.2f} s"
        )
