"""`maneuver library ratios`: the errors of a library over those of another."""

import json as json_module
import sys
from dataclasses import asdict
from itertools import groupby
from typing import Annotated

from cyclopts import Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from identification.error_ratios import SAME_ORDER, ErrorRatio, error_ratios

from .files import find_library


def ratios(
    library: str,
    /,
    *,
    against: str = "thesis-gtmax",
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Prints each error of a library over the same error of another, those of another order marked.

    Trims correspond where their velocities do, maneuvers where they join corresponding trims. An error that
    is 0 in the other library has no ratio.

    For example:

        maneuver library ratios gtmax-sim

        maneuver library ratios mine.json --against gtmax-sim --json

    Args:
        library: name or path.
        against: name or path of the other; Tables 9 and 10 of the thesis by default.
        json: print the ratios as JSON.
    """
    found = error_ratios(find_library(library), find_library(against))
    if json:
        content = [asdict(row) | {"ratio": row.ratio, "same_order": row.same_order} for row in found]
        sys.stdout.write(json_module.dumps({"ratios": content}, indent=2) + "\n")
        return 0
    console = Console(highlight=False)
    for kind, rows in groupby(found, key=lambda row: row.kind):
        console.print(_table(kind, list(rows)))
    known = [row for row in found if row.ratio is not None]
    outside = sum(not row.same_order for row in known)
    console.print(
        f"{len(known)} errors of {library} over those of {against}; {outside} outside {SAME_ORDER[0]:g} to "
        f"{SAME_ORDER[1]:g}, marked *",
        soft_wrap=True,
    )
    return 0


def _table(kind: str, rows: list[ErrorRatio]) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    table.add_column(kind, no_wrap=True)
    names = list(dict.fromkeys(row.scalar for row in rows))
    for name in names:
        table.add_column(name.replace("_", " "), justify="right", no_wrap=True)
    for number, entries in groupby(rows, key=lambda row: row.id):
        table.add_row(str(number), *map(_text, entries))
    return table


def _text(row: ErrorRatio) -> str:
    if row.ratio is None:
        return "-"
    return f"{row.ratio:.2f}{' ' if row.same_order else '*'}"
