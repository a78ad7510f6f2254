"""`maneuver library`: tables and checks of a library."""

import json as json_module
import sys
from typing import Annotated

from cyclopts import App, Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash, library_text
from flight.automaton.sign_convention import signed_maneuver_error, signed_trim_error
from flight.plural import plural
from flight.units import FOOT
from identification.data_sheet import describe_sample_size
from scenarios.find import find_library

# Metres, radians and seconds; smaller differences are rounding.
SAME = 1e-12

app = App(
    name="library", help="Shows, checks, tests, compares, interpolates and makes motion-primitive libraries."
)
app.command("maneuver.library.audit:audit", name="audit")
app.command("maneuver.library.diff:diff", name="diff")
app.command("maneuver.library.kinematic:kinematic", name="kinematic")
app.command("maneuver.library.graph:graph", name="graph")
app.command("maneuver.library.trends:trends", name="trends")
app.command("maneuver.library.interpolate:interpolate", name="interpolate")
app.command("maneuver.library.sheet:sheet", name="sheet")
app.command("maneuver.library.sources:sources", name="sources")
app.command("maneuver.library.trial:run_trial", name="test")


@app.command
def show(
    library: str,
    /,
    *,
    feet: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Shows a library's trims and maneuvers with their signed errors.

    For example:

        maneuver library show thesis-gtmax --feet

        maneuver library show my-library.json --json

    Args:
        library: name or path of the library.
        feet: print lengths in feet, as in the thesis.
        json: print the library as JSON, always in SI units.
    """
    found = find_library(library)
    if json:
        sys.stdout.write(library_text(found))
        return 0
    console = Console(highlight=False)
    console.print(f"{found.name}: {found.description}", soft_wrap=True)
    console.print(
        f"{found.vehicle}; wind {found.conditions.wind}; sha256 {library_hash(found)}", soft_wrap=True
    )
    console.print(describe_sample_size(found), soft_wrap=True)
    console.print("Each value with its signed error:")
    console.print(_trims(found, feet=feet))
    console.print(_maneuvers(found, feet=feet))
    for row in found.maneuvers:
        if row.notes:
            console.print(f"maneuver {row.id}: {row.notes}", soft_wrap=True)
    return 0


@app.command
def check(library: str, /, *, json: Annotated[bool, Parameter(negative="")] = False) -> int:
    """Checks a library's file, references and error signs.

    An invalid library gives exit code 2 and one line with the place of the error. Remarks do not change the
    exit code: the tables of the thesis have rows with irregular signs.

    For example:

        maneuver library check my-library.json

    Args:
        library: name or path of the library.
        json: print the result as JSON.
    """
    found = find_library(library)
    said = remarks(found)
    if json:
        verdict = {"library": found.name, "sha256": library_hash(found), "passed": True, "remarks": said}
        sys.stdout.write(json_module.dumps(verdict, indent=2) + "\n")
        return 0
    for remark in said:
        print(f"remark: {remark}")
    sizes = f"{plural(len(found.trims), 'trim')}, {plural(len(found.maneuvers), 'maneuver')}"
    print(f"{found.name}: {sizes}, valid")
    return 0


def remarks(library: Library) -> list[str]:
    """Returns warnings: errors against the sign convention, trims without a maneuver."""
    said = []
    for trim in library.trims:
        if trim.error != signed_trim_error(trim.error, trim.velocity):
            said.append(f"trim {trim.id}: an error does not have the sign of its nominal value")
        if not library.successors(trim.id):
            said.append(f"trim {trim.id}: no maneuver starts from it")
    for row in library.maneuvers:
        expected = signed_maneuver_error(
            row.error,
            left=library.trim(row.from_trim).velocity,
            reached=library.trim(row.to_trim).velocity,
        )
        for name in ("duration", "forward", "side", "heading_change"):
            if abs(getattr(row.error, name) - getattr(expected, name)) > SAME:
                said.append(f"maneuver {row.id}: its {name} error violates the sign convention")
        if row.duration + row.error.duration < 0 or row.duration - row.error.duration < 0:
            said.append(f"maneuver {row.id}: negative duration at gamma 1 or -1")
    return said


def _trims(library: Library, *, feet: bool) -> Table:
    unit, scale = ("ft", FOOT) if feet else ("m", 1.0)
    table = _table("id", "trim", f"forward, {unit}/s", f"side, {unit}/s", "yaw rate, rad/s")
    for trim in library.trims:
        velocity, error = trim.velocity, trim.error
        table.add_row(
            str(trim.id),
            trim.name,
            _value(velocity.forward / scale, error.forward / scale),
            _value(velocity.side / scale, error.side / scale),
            _value(velocity.yaw_rate, error.yaw_rate),
        )
    return table


def _maneuvers(library: Library, *, feet: bool) -> Table:
    unit, scale = ("ft", FOOT) if feet else ("m", 1.0)
    table = _table("id", "trims", "duration, s", f"forward, {unit}", f"side, {unit}", "heading, rad")
    for row in library.maneuvers:
        moved, error = row.displacement, row.error
        table.add_row(
            str(row.id),
            f"{row.from_trim}-{row.to_trim}",
            _value(row.duration, error.duration),
            _value(moved.x / scale, error.forward / scale),
            _value(moved.y / scale, error.side / scale),
            _value(moved.heading, error.heading_change),
        )
    return table


def _table(*headings: str) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for place, heading in enumerate(headings):
        table.add_column(heading, justify="left" if place < 2 else "right", no_wrap=True)
    return table


def _value(value: float, error: float) -> str:
    return f"{value:.3f} {error:+7.3f}"
