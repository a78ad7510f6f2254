"""`maneuver segment`: maneuvers found from motion alone, compared with the commands."""

import json as json_module
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from experiments.campaign.evidence import log_paths
from flight.errors import FlightError
from flight.plural import plural
from flightlog.file.reader import read_log
from identification.segmentation.motion_model import sampled_motion
from identification.segmentation.motion_walk import walks_of
from identification.segmentation.segmentation import commanded_walk, cut_into_segments
from identification.segmentation.segmentation_score import (
    TOLERANCE,
    EdgeScore,
    boundaries_of,
    score_boundaries,
)

MISSED = 1
LEAST_FOUND, MOST_SPURIOUS = 0.98, 0.02


def segment(
    logs: Annotated[list[Path], Parameter(negative="")],
    /,
    *,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Finds maneuvers from motion alone and compares them with the commands.

    A boundary counts as found within a second of the commanded one, between the same trims. The exit code
    is 1 if fewer than 98 % are found, or more than 2 % are spurious.

    For example:

        maneuver segment flights/

    Args:
        logs: flight logs of one automaton, or folders of them.
        json: print the scores as JSON.
    """
    flights = [read_log(path) for path in log_paths(logs)]
    library = flights[0].library()
    walks = walks_of([sampled_motion(log) for log in flights], library)
    pairs = []
    for log, shown in zip(flights, walks, strict=True):
        if log.library() != library:
            raise FlightError("expected logs flown with one library, got several")
        commanded = commanded_walk(log)
        pairs.append(
            (
                boundaries_of(commanded, cut_into_segments(log, commanded, library)),
                boundaries_of(shown, cut_into_segments(log, shown, library)),
            )
        )
    entries, ends, edges = score_boundaries(pairs)
    rows = {"all entries": entries, "all ends": ends}
    rows |= {f"{row.edge[0]} to {row.edge[1]}": row for row in edges if row.edge}
    if json:
        document = {name: asdict(row) for name, row in rows.items()}
        sys.stdout.write(json_module.dumps(document, indent=2) + "\n")
    else:
        winds = ", ".join(sorted({log.header.wind for log in flights}))
        print(
            f"{plural(len(flights), 'flight')}, wind {winds}; found: within {TOLERANCE:g} s, "
            "between the same trims"
        )
        Console(highlight=False).print(_table(rows))
    return 0 if all(_passes(row) for row in (entries, ends)) else MISSED


def _passes(row: EdgeScore) -> bool:
    return row.found >= LEAST_FOUND * row.commanded and row.spurious <= MOST_SPURIOUS * max(row.commanded, 1)


def _table(rows: dict[str, EdgeScore]) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    headings = ("trims", "commanded", "found", "spurious", "mean delay, s", "std dev, s", "max error, s")
    for place, heading in enumerate(headings):
        table.add_column(heading, justify="right" if place else "left", no_wrap=True)
    for name, row in rows.items():
        counts = (row.commanded, row.found, row.spurious)
        times = (f"{row.late:+.3f}", f"{row.standard_deviation:.3f}", f"{row.furthest:.2f}")
        table.add_row(name, *map(str, counts), *times)
    return table
