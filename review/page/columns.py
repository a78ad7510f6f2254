"""Numeric columns of a page: shared time axes, decimated, base64-packed."""

import base64
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from .decimation import decimate

MOST_POINTS = 16000
"""Largest number of points of a curve; half an hour keeps the extremes of every 0.2 s."""

Column = Float[np.ndarray, "n"]


@dataclass(slots=True, eq=False)
class _TimeBase:
    time: Column
    columns: list[Column] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class PageColumns:
    """Collection of columns; equal time axes are stored once."""

    _bases: list[_TimeBase] = field(default_factory=list)

    def add(self, time: Column, values: Column) -> tuple[int, int]:
        """Adds a column; returns the indices of its time axis and column."""
        for number, base in enumerate(self._bases):
            if np.array_equal(base.time, time):
                base.columns.append(values)
                return number, len(base.columns) - 1
        self._bases.append(_TimeBase(time, [values]))
        return len(self._bases) - 1, 0

    @property
    def samples_a_point(self) -> float:
        """Largest number of samples per point of a curve."""
        return max((len(base.time) / min(len(base.time), MOST_POINTS) for base in self._bases), default=1.0)

    def content(self) -> list[dict[str, object]]:
        """Returns times and columns as base64 of little-endian 32-bit floats."""
        content: list[dict[str, object]] = []
        for base in self._bases:
            time, columns = decimate(base.time, np.stack(base.columns, axis=1), most=MOST_POINTS)
            content.append(
                {"time": pack_floats(time), "columns": [pack_floats(column) for column in columns.T]}
            )
        return content


def pack_floats(values: Float[np.ndarray, "..."]) -> str:
    """Packs numbers as base64 of little-endian 32-bit floats."""
    return base64.b64encode(np.ascontiguousarray(values, "<f4").tobytes()).decode()
