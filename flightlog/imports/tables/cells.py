"""Cells of a table as numbers, read in pieces."""

import re
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jaxtyping import Float

from flight.errors import FlightError

from .dialect import Dialect

_ROWS = 50_000
_DAY = 86_400.0
_CLOCK = re.compile(r"\d{1,3}:\d\d:\d\d([.,]\d*)?")
_SKIPPED = re.compile(r"Skipping line", re.IGNORECASE)
_MOST_BAD = 0.01

Column = Float[np.ndarray, "n"]


class Cells:
    """Chosen columns of a table.

    Attributes:
        numbers: columns as numbers; not-a-number where a cell holds none.
        clock: True where times are hours, minutes and seconds, or dates.
        texts: column of texts, if asked for.
        count: number of rows.
        left_out: rows with more cells than any other.
    """

    def __init__(
        self, path: Path, dialect: Dialect, chosen: Sequence[int], *, time: int | None, text: int | None
    ) -> None:
        """Reads the columns.

        Args:
            path: table to read.
            dialect: form of the table.
            chosen: places of the columns of numbers, from 0.
            time: place of the column of times; None without one.
            text: place of a column of texts.

        Raises:
            FlightError: a column does not exist or does not hold numbers.
        """
        self._dialect = dialect
        names = sorted({*chosen, *([] if text is None else [text])})
        if not names:
            raise FlightError("expected --columns NAME=COLUMN, got no column that is used")
        if names[-1] >= dialect.width:
            raise FlightError(f"no column #{names[-1] + 1}; it has {dialect.width}")
        parts: dict[int, list[Column]] = {place: [] for place in chosen}
        texts: list[np.ndarray[Any, Any]] = []
        self.clock, self.count, self.left_out = False, 0, 0
        bad: dict[int, list[str]] = {place: [] for place in parts}
        for table in self._tables(path, names):
            self.count += len(table)
            for place, pieces in parts.items():
                column = self._moments(table[place]) if place == time else self._plain(table[place])
                wrong = table[place][np.isnan(column) & table[place].notna().to_numpy()]
                bad[place] += [str(cell) for cell in wrong[: _ROWS // 10]]
                pieces.append(column)
            if text is not None:
                texts.append(table[text].astype(str).to_numpy())
        self.numbers = {place: np.concatenate([np.empty(0), *pieces]) for place, pieces in parts.items()}
        self.texts = np.concatenate(texts) if texts else None
        for place, cells in bad.items():
            if len(cells) > max(_MOST_BAD * self.count, 1):
                heading = dialect.headings[place] if place < len(dialect.headings) else f"#{place + 1}"
                raise FlightError(f"column {heading!r}: expected numbers, got {cells[0][:40]!r}")
        if self.clock and time is not None:
            self.numbers[time] = _over_midnight(self.numbers[time])

    def _tables(self, path: Path, names: list[int]) -> Iterator[pd.DataFrame]:
        dialect = self._dialect
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            try:
                yield from pd.read_csv(
                    path,
                    sep=r"\s+" if dialect.separator == " " else dialect.separator,
                    header=None,
                    names=range(dialect.width),
                    usecols=names,
                    index_col=False,
                    skiprows=dialect.skipped,
                    skipinitialspace=True,
                    decimal=dialect.decimal,
                    comment=dialect.comment or None,
                    encoding=dialect.encoding,
                    encoding_errors="replace",
                    float_precision="round_trip",
                    on_bad_lines="warn",
                    chunksize=_ROWS,
                )
            except (ValueError, UnicodeError, pd.errors.ParserError) as error:
                raise FlightError(f"is not a table: {' '.join(str(error).split())[:200]}") from None
        self.left_out = sum(len(_SKIPPED.findall(str(each.message))) for each in said)

    def _plain(self, column: "pd.Series[Any]") -> Column:
        if column.dtype.kind in "bO" or pd.api.types.is_string_dtype(column.dtype):
            texts = column.astype(str).str.strip()
            if self._dialect.decimal == ",":
                texts = texts.str.replace(",", ".", regex=False)
            return np.asarray(pd.to_numeric(texts, errors="coerce"), np.float64)
        return np.asarray(column, np.float64)

    def _moments(self, column: "pd.Series[Any]") -> Column:
        """Returns times in their unit; dates and H:M:S in seconds."""
        numbers = self._plain(column)
        if np.isfinite(numbers).any() or not column.notna().any():
            return numbers
        texts = column.astype(str).str.strip().str.replace(",", ".", regex=False)
        first = next((text for text in texts if text not in {"", "nan"}), "")
        if _CLOCK.fullmatch(first):
            spans = pd.to_timedelta(texts.where(texts.str.contains(":"), None), errors="coerce")
            seconds = spans.dt.total_seconds()
        else:
            dates = pd.to_datetime(texts, utc=True, format="ISO8601", errors="coerce")
            seconds = (dates - pd.Timestamp(0, tz="UTC")).dt.total_seconds()
        self.clock = self.clock or bool(seconds.notna().any())
        return np.asarray(seconds, np.float64)


def _over_midnight(time: Column) -> Column:
    """Returns hours of the day that go on after midnight."""
    known = np.flatnonzero(np.isfinite(time))
    steps = np.diff(time[known])
    days = np.cumsum(np.where(steps < -0.9 * _DAY, 1.0, 0.0) - np.where(steps > 0.9 * _DAY, 1.0, 0.0))
    unwrapped = time.copy()
    # A date never wraps; its seconds since 1970 are many days.
    if len(known) and np.nanmax(time[known]) <= _DAY:
        unwrapped[known[1:]] += _DAY * days
    return unwrapped
