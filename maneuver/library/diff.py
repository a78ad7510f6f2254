"""`maneuver library diff`: differences between two libraries."""

import json as json_module
import sys
from collections import Counter
from dataclasses import asdict
from typing import Annotated

from cyclopts import Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flight.automaton.library_diff import Value, library_differences
from scenarios.find import find_library

DIFFERENT = 1


def diff(
    first: str,
    second: str,
    /,
    *,
    numbers: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Compares two libraries, primitive by primitive.

    For example:

        maneuver library diff gtmax-sim mine.json

        maneuver library diff thesis-kinematic kinematic.json --numbers

    Args:
        first: name or path of the first library.
        second: name or path of the second library.
        numbers: compare only values and signed errors of trims and maneuvers, not their origin.
        json: print the differences as JSON.
    """
    found = library_differences(find_library(first), find_library(second))
    if numbers:
        found = tuple(
            one
            for one in found
            if one.part != "library" and not one.place.startswith(("name", "notes", "statistics"))
        )
    if json:
        sys.stdout.write(json_module.dumps([asdict(one) for one in found], indent=2) + "\n")
        return DIFFERENT if found else 0
    if not found:
        print(f"{first} and {second} are the same")
        return 0
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for place, heading in enumerate(("part", "place", first, second, "change")):
        table.add_column(heading, justify="right" if place > 1 else "left", overflow="fold")
    for one in found:
        table.add_row(
            one.part, one.place, _text(one.first), _text(one.second), _change(one.first, one.second)
        )
    Console(highlight=False).print(table)
    parts = Counter(one.part.split()[0] for one in found)
    touched = len({one.part for one in found if one.part != "library"})
    print(f"{len(found)} differences in {touched} primitives and {parts['library']} library entries")
    return DIFFERENT


def _text(value: Value) -> str:
    if value is None:
        return "-"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _change(first: Value, second: Value) -> str:
    if isinstance(first, bool | str) or isinstance(second, bool | str) or first is None or second is None:
        return ""
    return f"{second - first:+.4g}"
