"""`maneuver library kinematic`: library from the kinematic equations, beside the thesis's."""

import sys
from collections.abc import Iterator
from math import degrees
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

import libraries
from flight.automaton.library import Library
from flight.automaton.library_file import library_hash, library_text
from flight.automaton.maneuver import Maneuver
from flight.plural import plural
from identification.design.kinematic_library import read_kinematic_library
from scenarios.find import find_library

from .library_files import check_library_target, write_library_files

THESIS = libraries.FOLDER / "kinematic.toml"
PRINTED = "thesis-kinematic"

# The printed tables have one or two decimals, and degrees; what differs by no more is the same.
ROUNDING = {"duration": 0.005, "forward": 0.05, "side": 0.05, "heading, deg": 0.5}


def kinematic(
    file: Path = THESIS,
    /,
    *,
    out: Path | None = None,
    beside: str | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Makes a library from assumed trims, durations and errors (thesis, 2.6.1, 3.2.1).

    Its numbers are printed beside those of another library with the same maneuvers, by default Tables 6 and 8
    of the thesis if FILE is the shipped one, which is also an example of such a file.

    For example:

        maneuver library kinematic

        maneuver library kinematic mine.toml --out mine.json

    Args:
        file: TOML file with trims, percent errors, maneuvers, durations and duration errors.
        out: library file to write; its data sheet is written beside it.
        beside: name or path of the library to compare with.
        force: overwrite OUT.
        json: print the library as JSON.
    """
    made = read_kinematic_library(file)
    if out is not None:
        check_library_target(out, force=force, inputs=[file])
        write_library_files(made, out, force=force)
    if json:
        sys.stdout.write(library_text(made))
        return 0
    sizes = f"{plural(len(made.trims), 'trim')}, {plural(len(made.maneuvers), 'maneuver')}"
    print(f"{made.name}: {sizes}, {library_hash(made)}")
    compared = find_library(beside or PRINTED) if beside or file == THESIS else None
    Console(highlight=False).print(_table(made, compared))
    if compared is not None:
        rows = [row for row in made.maneuvers if _matching_maneuver(row, compared)]
        wrong = [
            row.id
            for row in rows
            if any(not same for *_, same in _numbers(row, _matching_maneuver(row, compared)))
        ]
        print(
            f"{len(rows) - len(wrong)} of {len(rows)} maneuvers equal those of {compared.name} "
            "within its rounding"
        )
        if wrong:
            print(f"different: {', '.join(map(str, wrong))}")
    return 0


def _matching_maneuver(row: Maneuver, library: Library) -> Maneuver | None:
    return next(
        (one for one in library.maneuvers if (one.from_trim, one.to_trim) == (row.from_trim, row.to_trim)),
        None,
    )


def _numbers(row: Maneuver, other: Maneuver | None) -> Iterator[tuple[str, str, bool]]:
    """Yields each number with its error, and whether another library's agrees."""
    for name, (value, error), (known, known_error) in zip(
        ROUNDING, _pairs(row), _pairs(other) if other else ((None, None),) * len(ROUNDING), strict=True
    ):
        text = f"{value:.2f} {error:+.2f}"
        if known is None or known_error is None:
            yield text, "", True
            continue
        bar = ROUNDING[name] * (1 + 1e-9)
        same = abs(value - known) <= bar and abs(error - known_error) <= bar
        yield text, "" if same else f"{known:.2f} {known_error:+.2f}", same


def _pairs(row: Maneuver) -> tuple[tuple[float, float], ...]:
    moved, error = row.displacement, row.error
    return (
        (row.duration, error.duration),
        (moved.x, error.forward),
        (moved.y, error.side),
        (degrees(moved.heading), degrees(error.heading_change)),
    )


def _table(library: Library, compared: Library | None) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    headings = ("id", "trims", *(f"{name}{'' if ',' in name else _UNITS[name]}" for name in ROUNDING))
    for heading in headings:
        table.add_column(heading, justify="right" if heading not in {"id", "trims"} else "left", no_wrap=True)
    for row in library.maneuvers:
        other = None if compared is None else _matching_maneuver(row, compared)
        numbers = list(_numbers(row, other))
        table.add_row(str(row.id), f"{row.from_trim}-{row.to_trim}", *(text for text, *_ in numbers))
        if any(printed for _, printed, _ in numbers):
            table.add_row("", "printed", *(printed for _, printed, _ in numbers), style="yellow")
    return table


_UNITS = {"duration": ", s", "forward": ", m", "side": ", m"}
