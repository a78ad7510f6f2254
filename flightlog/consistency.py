"""Consistency checks of a flight log beyond its checksums."""

from dataclasses import asdict

import numpy as np

from .log import FlightLog
from .primitives import PrimitiveKind
from .series import Series
from .topics import PRIMITIVE, TRUTH

LONGEST_NAME = 200
"""Characters of a name in the header."""

LONGEST_LIST = 4000
"""Characters of the header's list of drawn differences."""

LARGEST_VALUE = 1e9
"""Largest magnitude of a plausible value, in metres, radians or their rates."""

IMPORT = "import"
"""Kind of an imported log, whose fields may be not-a-number where they are not known."""

_ROUNDING = 1e-6


def check_log_consistency(log: FlightLog) -> None:
    """Refuses a log whose series cannot come from a flight.

    Raises:
        ValueError: times decrease or are not finite, a value is not finite (not-a-number is a hole of an
            import), a topic has no message, a primitive has an unknown kind, or a header field is not
            printable.
    """
    for name, value in asdict(log.header).items():
        text, longest = str(value), LONGEST_LIST if name == "drawn" else LONGEST_NAME
        if len(text) > longest or not text.isprintable():
            raise ValueError(
                f"header {name}: expected at most {longest} printable characters, got {text[:40]!r}"
            )
    for series in log.series.values():
        _check_values(series, holes=log.header.kind == IMPORT)
    if PRIMITIVE.name in log.series:
        _check_primitive_kinds(log[PRIMITIVE])
        if TRUTH.name in log.series:
            _check_primitives_have_truth(log[PRIMITIVE], log[TRUTH])


def _check_values(series: Series, *, holes: bool) -> None:
    name = series.topic.name
    if not len(series):
        raise ValueError(f"{name}: expected at least one message, got none")
    impossible = ~(np.abs(series.values) < LARGEST_VALUE)
    if holes:
        # Not-a-number: not known at this time.
        impossible &= ~np.isnan(series.values)
    if impossible.any():
        row, column = np.argwhere(impossible)[0]
        raise ValueError(
            f"{name} {series.topic.fields[column].name} at {series.time[row]:.2f} s: expected a magnitude "
            f"below {LARGEST_VALUE:g}, got {series.values[row, column]}"
        )
    back = np.flatnonzero(np.diff(series.time) < 0)
    if len(back):
        raise ValueError(
            f"{name}: expected increasing times, got a step back after {series.time[back[0]]:.2f} s"
        )


def _check_primitive_kinds(series: Series) -> None:
    kinds = np.array([kind.value for kind in PrimitiveKind], dtype=float)
    if not np.isin(series["kind"], kinds).all():
        raise ValueError(f"{series.topic.name} kind: expected one of {kinds.astype(int).tolist()}")
    for field in ("id", "from_trim", "to_trim"):
        if not (series[field] == np.rint(series[field])).all():
            raise ValueError(f"{series.topic.name} {field}: expected whole numbers")


def _check_primitives_have_truth(primitives: Series, truth: Series) -> None:
    """Refuses primitives without any true state."""
    begins = primitives.time
    ends = np.append(begins[1:], max(truth.time[-1], begins[-1]))
    first = np.searchsorted(truth.time, begins - _ROUNDING)
    last = np.searchsorted(truth.time, ends + _ROUNDING)
    empty = np.flatnonzero(first == last)
    if len(empty):
        raise ValueError(
            f"{truth.topic.name}: expected a state in the primitive at {begins[empty[0]]:.2f} s, "
            f"got states from {truth.time[0]:.2f} to {truth.time[-1]:.2f} s only"
        )
