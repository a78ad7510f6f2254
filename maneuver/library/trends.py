"""`maneuver library trends`: primitives against speed and yaw rate (thesis, Figures 7 to 9)."""

import json as json_module
import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from matplotlib.figure import Figure
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flight.errors import FlightError
from flight.units import FOOT
from identification.trends import SpeedStep, Trends, TurnStep
from identification.trends import trends as trends_of
from review.pictures.flight_picture import write_picture
from review.pictures.trends_picture import Points, trends_picture
from runtime.atomic_write import check_output_files
from scenarios.find import find_library, library_path


def trends(
    library: str,
    /,
    *,
    speed_step: float = 8 * FOOT,
    rate_step: float = 0.1,
    out: Path | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Shows errors and displacements against speed and yaw rate.

    The library must be flown on a grid of speeds or yaw rates; campaign `trends` has straight flight in steps
    of 8 ft/s up to 80 ft/s, and turns in steps of 0.1 rad/s.

    For example:

        maneuver regenerate --campaign trends --out trends-flown.json

        maneuver library trends trends-flown.json --out trends.png

    Args:
        library: name or path of the flown library.
        speed_step: size of the speed changes shown, m/s.
        rate_step: size of the yaw-rate changes shown, rad/s.
        out: picture to write; none by default.
        force: overwrite OUT.
        json: print the trends as JSON.
    """
    check_output_files(out, force=force, inputs=[library_path(library)], ending=".png")
    found = find_library(library)
    seen = trends_of(found, speed_step=speed_step, rate_step=rate_step)
    if not (seen.speed_errors or seen.speed_steps or seen.turn_steps):
        raise FlightError(f"{library}: expected flown straight trims or steps between trims, got none")
    if out is not None:
        title = f"Trends of {found.name}    |    {found.vehicle}, wind {found.conditions.wind}"
        write_picture(_picture_of(title, seen), out, force=force)
    if json:
        sys.stdout.write(json_module.dumps(asdict(seen), indent=2) + "\n")
        return 0
    console = Console(highlight=False)
    for headline, heads, rows in _tables(seen):
        if not rows:
            continue
        console.print(headline, soft_wrap=True)
        table = Table(box=SIMPLE_HEAD, pad_edge=False)
        for head in heads:
            table.add_column(head, justify="right")
        for row in rows:
            table.add_row(*row)
        console.print(table)
    if out is not None:
        print(f"picture {out}")
    return 0


def _picture_of(title: str, seen: Trends) -> Figure:
    faster = [row for row in seen.speed_steps if row.exit_speed > row.entry_speed]
    slower = [row for row in seen.speed_steps if row.exit_speed < row.entry_speed]
    right = [row for row in seen.turn_steps if row.exit_rate > row.entry_rate]
    left = [row for row in seen.turn_steps if row.exit_rate < row.entry_rate]

    def speeds(name: str) -> tuple[Points, Points]:
        return _points(faster, "entry_speed", name), _points(slower, "entry_speed", name)

    def rates(name: str) -> tuple[Points, Points]:
        return _points(right, "entry_rate", name), _points(left, "entry_rate", name)

    return trends_picture(
        title,
        speed_errors=[(row.speed, row.percent) for row in seen.speed_errors if row.percent is not None],
        displacements=speeds("displacement"),
        displacement_percents=speeds("percent"),
        heading_changes=rates("heading_change"),
        duration_percents=rates("duration_percent"),
    )


def _points(rows: Sequence[SpeedStep] | Sequence[TurnStep], across: str, up: str) -> Points:
    return [(getattr(row, across), getattr(row, up)) for row in rows]


def _tables(seen: Trends) -> Iterator[tuple[str, tuple[str, ...], list[tuple[str, ...]]]]:
    """Yields title, headings and rows of each figure, in metres and feet."""
    yield (
        "Forward error over speed (Figure 7)",
        ("ft/s", "m/s", "largest deviation, m/s", "%", "flights"),
        [
            (
                _feet(row.speed),
                f"{row.speed:.2f}",
                f"{row.error:.3f}",
                "-" if row.percent is None else f"{row.percent:.1f}",
                str(row.samples),
            )
            for row in seen.speed_errors
        ],
    )
    yield (
        "Changes of speed (Figure 8)",
        ("from ft/s", "to ft/s", "forward, m", "error, m", "error, %", "duration, s", "error, %", "flights"),
        [
            (
                _feet(row.entry_speed),
                _feet(row.exit_speed),
                f"{row.displacement:.2f}",
                f"{row.error:.2f}",
                f"{row.percent:.1f}",
                f"{row.duration:.2f}",
                f"{row.duration_percent:.1f}",
                str(row.samples),
            )
            for row in seen.speed_steps
        ],
    )
    yield (
        "Changes of yaw rate (Figure 9)",
        (
            "at ft/s",
            "from rad/s",
            "to rad/s",
            "heading change, rad",
            "off by, rad",
            "duration, s",
            "off by, %",
        ),
        [
            (
                _feet(row.speed),
                f"{row.entry_rate:+.1f}",
                f"{row.exit_rate:+.1f}",
                f"{row.heading_change:+.3f}",
                f"{row.heading_error:.3f}",
                f"{row.duration:.2f}",
                f"{row.duration_percent:.1f}",
            )
            for row in seen.turn_steps
        ],
    )


def _feet(speed: float) -> str:
    return f"{speed / FOOT:.0f}"
