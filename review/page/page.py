"""Self-contained HTML page of one flight or of several compared."""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

from flight.errors import FlightError
from flightlog.log import FlightLog
from review.summary.summary import Summary

from .columns import PageColumns
from .comparison import comparison_rows
from .flight import flight_page_content
from .panels import Limits, panels
from .spectra import spectra

WEB = Path(__file__).parents[1] / "web"
STYLES = ("uplot.css", "page.css")
# In order of dependency.
SCRIPTS = (
    *("uplot.js", "state.js", "plots.js", "lane.js", "camera.js"),
    *("view.js", "view_input.js", "table.js", "spectra.js", "page.js"),
)


@dataclass(frozen=True, slots=True, eq=False)
class ReviewedFlight:
    """A flight with its summary and its label on the page."""

    log: FlightLog
    summary: Summary
    label: str


def review_page(flights: Sequence[ReviewedFlight], *, limits: Limits | None = None) -> str:
    """Returns the HTML page of a flight, or of several compared.

    Args:
        flights: one flight, or several to compare; goal and plans are those of the first.
        limits: known limits of the controls in radians, by field.

    Raises:
        FlightError: a log lacks motion, or an attachment is broken.
    """
    columns = PageColumns()
    title, eyebrow, subtitle = _heading(flights)
    content = {
        "title": title,
        "eyebrow": eyebrow,
        "subtitle": subtitle,
        "footer": "",
        "flights": [flight_page_content(part.log, part.summary, part.label) for part in flights],
        "panels": panels([part.log for part in flights], columns, limits or {}),
        "scorecard": comparison_rows([part.summary for part in flights]) if len(flights) > 1 else [],
        "spectra": spectra([part.log for part in flights]),
        "bases": columns.content(),
    }
    content["footer"] = _footer(columns)
    return fill_page("page.html", title=title, content=content, styles=STYLES, scripts=SCRIPTS)


def fill_page(
    template: str, *, title: str, content: object, styles: Sequence[str], scripts: Sequence[str]
) -> str:
    """Fills a template with styles, scripts and data.

    Raises:
        FlightError: the content has a number that is not finite.
    """
    try:
        data = json.dumps(content, allow_nan=False, separators=(",", ":"))
    except ValueError:
        raise FlightError(
            "cannot make a page: expected finite numbers in the log, got NaN or infinity"
        ) from None
    parts = {
        "title": escape(title),
        "styles": _joined_texts(styles),
        "scripts": _joined_texts(scripts),
        # `</` would end the script element; JSON allows an escaped slash.
        "data": data.replace("</", "<\\/"),
    }
    text = (WEB / template).read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda mark: parts[mark[1]], text)


def _joined_texts(names: Sequence[str]) -> str:
    return "\n".join((WEB / name).read_text(encoding="utf-8") for name in names)


def _heading(flights: Sequence[ReviewedFlight]) -> tuple[str, str, str]:
    summary = flights[0].summary
    known = "" if summary.kind == "import" else f", wind class {summary.wind}, seed {summary.seed}"
    facts = f"{summary.vehicle}{known}, {summary.duration:.1f} s"
    if len(flights) == 1:
        return f"{summary.kind.capitalize()} {summary.name}", "flight review", facts
    names = " and ".join(part.label for part in flights)
    flown = " beside ".join(dict.fromkeys(f"{part.summary.kind} {part.summary.name}" for part in flights))
    return names, f"flight review: {flown}", "aligned at the start of each flight"


def _footer(columns: PageColumns) -> str:
    samples = columns.samples_a_point
    if samples <= 1.0:
        return "Curves show every sample of the log."
    return (
        f"Curves show one point per {samples:.1f} samples at most: the exact minimum and maximum of each "
        "interval, at times within the interval."
    )
