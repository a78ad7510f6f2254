"""Index page of a campaign: a row per flight, outliers first."""

from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path

import numpy as np

from flight.plural import plural

from .campaign_rows import FIGURES, FlightRow
from .page import fill_page

Content = dict[str, object]


def campaign_page(rows: Sequence[FlightRow], *, title: str, pages: Mapping[Path, str]) -> str:
    """Returns the HTML of the index page.

    Args:
        rows: the flights in display order.
        title: the campaign's name.
        pages: relative address of a flight's own page, by log path; only flights that have one.
    """
    content = {
        "title": title,
        "subtitle": _subtitle(rows),
        "tiles": _tiles(rows),
        "figures": FIGURES,
        "rows": [_row(row, pages.get(row.path)) for row in rows],
    }
    return fill_page(
        "index.html", title=title, content=content, styles=("page.css", "index.css"), scripts=("index.js",)
    )


def _subtitle(rows: Sequence[FlightRow]) -> str:
    hours = sum(row.duration for row in rows) / 3600.0
    winds = ", ".join(sorted({row.wind for row in rows if row.wind}))
    return f"{plural(len(rows), 'flight')}, {hours:.2f} flight hours, wind class {winds or 'unknown'}"


def _tiles(rows: Sequence[FlightRow]) -> list[Content]:
    failed = sum(not row.good for row in rows)
    timeouts = sum(row.timeouts for row in rows)
    checked = sum(row.primitives for row in rows if row.left is not None)
    tiles: list[Content] = [
        _tile("successful", f"{len(rows) - failed} of {len(rows)}", "completed, goal reached", failed),
        _tile("time-outs", str(timeouts), "of maneuvers", timeouts),
    ]
    if checked:
        left = sum(row.left or 0 for row in rows)
        share = f"{left / checked:.1%} of the primitives"
        tiles.append(_tile("left their bounds", f"{left} of {checked}", share, 0, plain=True))
    for name, scale, unit in (("forward", 1.0, "m/s"), ("side", 1.0, "m/s"), ("yaw_rate", None, "deg/s")):
        values = [dict(row.figures)[name] for row in rows if name in dict(row.figures)]
        if values:
            factor = float(np.degrees(1.0)) if scale is None else scale
            value = f"{factor * float(np.median(values)):.3f} {unit}"
            tiles.append(_tile(FIGURES[name], value, "median of the flights' rms", 0, plain=True))
    return tiles


def _tile(label: str, value: str, note: str, wrong: int, *, plain: bool = False) -> Content:
    tone = "plain" if plain else "bad" if wrong else "good"
    return {"label": label, "value": value, "note": note, "tone": tone}


def _row(row: FlightRow, page: str | None) -> Content:
    return {
        "file": row.path.name,
        "page": page,
        "problem": row.problem,
        "name": row.name,
        "outcome": row.outcome,
        "good": row.good,
        "duration": row.duration,
        "primitives": row.primitives,
        "left": row.left,
        "timeouts": row.timeouts,
        "figures": dict(row.figures),
        "spark": row.spark,
        "score": row.score if isfinite(row.score) else None,
        "reason": row.reason,
    }
