"""Form of a text table: encoding, separator, decimal mark, headings."""

import codecs
import csv
import io
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from flight.errors import FlightError

from .headings import is_unit

_HEAD = 1 << 18
_MOST_LINES = 400
_COMMENTS = ("#", "%", "//")
_SEPARATORS = (",", ";", "\t", "|", " ")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?|[+-]?(nan|inf|infinity)", re.IGNORECASE)
_MOMENT = re.compile(r"(\d{4}[-/]\d\d?[-/]\d\d?([T ].*)?|\d{1,3}:\d\d(:\d\d([.,]\d*)?)?)")

Decimal = Literal[".", ","]


@dataclass(frozen=True, slots=True)
class Dialect:
    """Form of a text table.

    Attributes:
        encoding: of the text.
        separator: between cells; a blank stands for any number of blanks and tabs.
        decimal: decimal mark.
        comment: character that begins a comment line; empty without such lines.
        headings: names of the columns.
        units: units of the columns, if a row states them.
        skipped: lines before the first row of numbers.
        width: most cells of a row.
        longer: first row with filled cells beyond the headings, if most are so.
    """

    encoding: str
    separator: str
    decimal: Decimal
    comment: str
    headings: tuple[str, ...]
    units: tuple[str, ...]
    skipped: int
    width: int
    longer: tuple[str, ...]


def dialect_of(path: Path) -> Dialect:
    """Returns the form of a table by its first lines.

    Raises:
        FlightError: it has no row of headings above rows of numbers.
    """
    with path.open("rb") as stream:
        head = stream.read(_HEAD)
    encoding = _encoding(head)
    text = codecs.getincrementaldecoder(encoding)(errors="replace").decode(head)
    lines = text.splitlines()
    if len(head) == _HEAD:
        lines = lines[:-1]
    lines = lines[:_MOST_LINES]
    separator, decimal = _marks([line for line in lines if line.strip() and not _is_comment(line)])
    cells = [[] if not line.strip() or _is_comment(line) else _split(line, separator) for line in lines]
    first = next((place for place, row in enumerate(cells) if _is_data(row, decimal)), None)
    if first is None:
        raise FlightError("is not a table: expected rows of numbers below a row of headings, got none")
    headings, units = _headings(lines[:first], cells[:first], separator)
    rows = [row for row in cells[first:] if row]
    comment = next((line.lstrip()[0] for line in lines[first:] if _is_comment(line)), "")
    longer = [row for row in rows if any(row[len(headings) :])]
    width = max(len(headings), *(len(row) for row in rows))
    return Dialect(
        encoding,
        separator,
        decimal,
        comment,
        headings,
        units,
        first,
        width,
        tuple(longer[0]) if 2 * len(longer) > len(rows) else (),
    )


def _encoding(head: bytes) -> str:
    for mark, name in (
        (codecs.BOM_UTF8, "utf-8-sig"),
        (codecs.BOM_UTF16_LE, "utf-16"),
        (codecs.BOM_UTF16_BE, "utf-16"),
    ):
        if head.startswith(mark):
            return name
    for start, name in ((1, "utf-16-le"), (0, "utf-16-be")):
        if len(head) > 8 and head[start::2].count(0) > 0.4 * len(head):
            return name
    try:
        codecs.getincrementaldecoder("utf-8")().decode(head)
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8"


def _is_comment(line: str) -> bool:
    return line.lstrip().startswith(_COMMENTS)


def _split(line: str, separator: str) -> list[str]:
    if separator == " ":
        return line.split()
    try:
        row = next(csv.reader(io.StringIO(line), delimiter=separator, skipinitialspace=True), [])
    except csv.Error:
        return []
    return [cell.strip() for cell in row]


def _is_number(cell: str, decimal: Decimal) -> bool:
    if decimal == ",":
        cell = "x" if "." in cell else cell.replace(",", ".")
    return _NUMBER.fullmatch(cell) is not None


def _is_data(row: Sequence[str], decimal: Decimal) -> bool:
    filled = [cell for cell in row if cell]
    numbers = sum(_is_number(cell, decimal) or _MOMENT.fullmatch(cell) is not None for cell in filled)
    return bool(filled) and 2 * numbers > len(filled)


def _marks(lines: Sequence[str]) -> tuple[str, Decimal]:
    """Returns the separator and decimal mark with most numbers in columns."""
    best: tuple[float, str, Decimal] = (-1.0, ",", ".")
    decimals: tuple[Decimal, ...] = (".", ",")
    for separator in _SEPARATORS:
        rows = [row for line in lines if (row := _split(line, separator))]
        width, count = Counter(map(len, rows)).most_common(1)[0] if rows else (0, 0)
        if width < 2:
            continue
        for decimal in decimals[: 1 if separator == "," else 2]:
            filled = [cell for row in rows for cell in row if cell]
            good = sum(_is_number(cell, decimal) or _MOMENT.fullmatch(cell) is not None for cell in filled)
            score = good / max(len(filled), 1) * count / len(rows)
            if score > best[0] + 1e-9:
                best = (score, separator, decimal)
    return best[1], best[2]


def _headings(
    lines: Sequence[str], cells: Sequence[Sequence[str]], separator: str
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Returns the headings and units above the first row of numbers."""
    written = [row for row in cells if row]
    if not written:
        # Tables of NumPy have their headings in a comment.
        remarks = [line.lstrip().lstrip("#%/").strip() for line in lines if _is_comment(line)]
        written = [row for remark in remarks[-2:] if len(row := _split(remark, separator)) > 1]
    if not written:
        raise FlightError("is not a table: expected a row of headings above the numbers, got none")
    last = written[-1]
    if (
        len(written) > 1
        and len(written[-2]) > 1
        and all(is_unit(cell) for cell in last if cell)
        and any(last)
    ):
        return _named(written[-2]), tuple(last)
    return _named(last), ()


def _named(row: Sequence[str]) -> tuple[str, ...]:
    end = len(row)
    while end and not row[end - 1]:
        end -= 1
    return tuple(" ".join(cell.split()) for cell in row[:end])
