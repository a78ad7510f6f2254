"""`maneuver verify`: the checks of physics that need no test runner, every figure beside its bar."""

import json as json_module
import sys
from collections.abc import Iterable
from dataclasses import asdict
from typing import Annotated

from cyclopts import Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from sim.figure import Figure

CHECK_FAILED = 1
# Of the table where it goes to a file.
_WIDTH = 150


def verify(
    *,
    topics: Annotated[tuple[str, ...], Parameter(consume_multiple=True)] = (),
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Measures the simulator against its bars; ends with 1 where one is missed.

    Examples:
        maneuver verify
        maneuver verify --topics trim modes
        maneuver verify --json

    Args:
        topics: show and judge these topics alone.
        json: print one JSON document.
    """
    figures = [figure for figure in measure() if not topics or figure.topic in topics]
    if json:
        rows = [asdict(figure) | {"holds": figure.holds} for figure in figures]
        sys.stdout.write(json_module.dumps({"figures": rows}, indent=2) + "\n")
    else:
        _show(figures)
    return 0 if figures and all(figure.holds for figure in figures) else CHECK_FAILED


def measure() -> Iterable[Figure]:
    """Yields every figure."""
    from sim.controller_check import (
        check_adaptation,
        check_delay,
        check_limits,
        check_margins,
        check_response,
    )
    from sim.parameters import read_parameters
    from sim.vehicle_check import check_vehicle

    parameters = read_parameters()
    yield from check_vehicle(parameters)
    for check in (check_response, check_limits, check_margins, check_delay, check_adaptation):
        yield from check(parameters)


def _show(figures: list[Figure]) -> None:
    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=_WIDTH)
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("topic", "figure", "value", "unit", "bar", "", "beside"):
        table.add_column(heading, justify="right" if heading == "value" else "left")
    for figure in figures:
        verdict = "" if not figure.bar else "holds" if figure.holds else "MISSED"
        table.add_row(
            *(figure.topic, figure.name, f"{figure.value:.4g}", figure.unit),
            *(figure.bar, verdict, figure.beside),
        )
    console.print(table)
    missed = sum(not figure.holds for figure in figures)
    console.print(f"{len(figures)} figures, {missed} missed their bar")
