"""`maneuver plan --pareto`: price of robustness as table, JSON and picture."""

import io
import json as json_module
import sys
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flight.automaton.library import Library
from flight.mission.mission import Mission
from planner.policies.price_of_robustness import PricePoint, price_curve
from runtime.atomic_write import write_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NO_PLAN = 1

SCHEMA = "maneuver-prices/1"
"""Of the curve as JSON."""


def print_prices(
    library: Library,
    mission: Mission,
    *,
    out: Path | None,
    picture: Path | None,
    replace_out: bool,
    force: bool,
    json: bool,
) -> int:
    """Prints the price curve; returns 1 where there is no nominal plan.

    Args:
        library: the primitives.
        mission: from where to where.
        out: file for the curve, as JSON.
        picture: file for its picture.
        replace_out: overwrite OUT.
        force: overwrite the picture.
        json: print the curve as JSON.
    """
    curve = price_curve(library, mission)
    document = json_module.dumps(_content(library, mission, curve), indent=2, allow_nan=False) + "\n"
    if out is not None:
        write_atomically(document.encode(), out, force=replace_out)
    if picture is not None and curve:
        from review.pictures.price_picture import price_picture

        drawn = price_picture(mission.name, [(point.gamma, point.cost) for point in curve])
        write_atomically(png_bytes(drawn), picture, force=force)
    if json:
        sys.stdout.write(document)
    elif curve:
        Console(highlight=False).print(_table(curve))
    else:
        print(f"{mission.name}: no price of robustness: there is no nominal plan")
    return 0 if curve else NO_PLAN


def png_bytes(figure: "Figure") -> bytes:
    """Returns a figure as PNG bytes without a time stamp."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None})
    return stream.getvalue()


def _content(library: Library, mission: Mission, curve: tuple[PricePoint, ...]) -> dict[str, Any]:
    points = [
        {
            "alpha": point.alpha if isfinite(point.alpha) else None,
            "gamma": point.gamma,
            "cost": point.cost if isfinite(point.cost) else None,
            "sequence": list(point.sequence),
        }
        for point in curve
    ]
    return {"schema": SCHEMA, "library": library.name, "mission": mission.name, "points": points}


def _table(curve: tuple[PricePoint, ...]) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False)
    for heading in ("gamma", "worst-case time, s", "alpha", "trims"):
        table.add_column(heading, justify="left" if heading == "trims" else "right")
    for point in curve:
        trims = "-".join(map(str, point.sequence)) or "no plan"
        table.add_row(f"{point.gamma:g}", f"{point.cost:.4f}", f"{point.alpha:.4f}", trims)
    return table
