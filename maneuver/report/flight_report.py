"""Text report of `maneuver review`: a flight, several, or a campaign."""

from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from typing import Any

from rich.console import Group
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from flight.mission.arrival import ArrivalVerdict
from flight.plural import plural
from flightlog.primitives import PrimitiveKind
from review.page.campaign_rows import FlightRow
from review.page.comparison import comparison_rows
from review.summary.bound_check import IDENTIFICATION_KINDS, BoundCheck
from review.summary.summary import PrimitiveCount, Summary
from review.summary.tiles import NO_BOUNDS

# Violations of bounds, and flights of a campaign, that are listed; the rest is counted.
MOST_VIOLATIONS, MOST_FLIGHTS = 8, 12


def summary_content(summary: Summary) -> dict[str, Any]:
    """Returns a summary as JSON values; null where data are missing."""
    content = asdict(summary)
    if summary.bounds is not None:
        for violation in content["bounds"]["violations"]:
            violation["kind"] = PrimitiveKind(violation["kind"]).name.lower()
    return content


def flight_report(summary: Summary) -> Group:
    """Returns the summary as text."""
    parts: list[Table | Padding | Text] = [_facts(summary)]
    if summary.trims or summary.maneuvers:
        parts += [_heading("Flown"), _primitives(summary)]
    if summary.tracking is not None:
        parts += [_heading("Truth minus command"), _tracking(summary)]
    if summary.bounds is not None and summary.bounds.violations:
        parts += [
            _heading(f"Largest deviations outside the bounds of library {summary.bounds.library}"),
            _violations(summary.bounds),
        ]
    return Group(*parts)


def side_by_side(labels: Sequence[str], summaries: Sequence[Summary]) -> Table:
    """Returns several flights' numbers, a column for each flight."""
    table = _columns("", *labels, right=tuple(labels))
    for name, *values in comparison_rows(summaries):
        table.add_row(name, *values)
    return table


def campaign_report(rows: Sequence[FlightRow]) -> Group:
    """Returns a campaign's flights, outliers first."""
    failed = [row for row in rows if not row.good]
    hours = sum(row.duration for row in rows) / 3600.0
    facts = Table.grid(padding=(0, 2))
    facts.add_column(style="bold")
    facts.add_row("flights", f"{len(rows)}, {hours:.2f} flight hours")
    facts.add_row("successful", f"{len(rows) - len(failed)} of {len(rows)}")
    facts.add_row("time-outs", str(sum(row.timeouts for row in rows)))
    table = _columns("", "outcome", "score", "outlier in", "out of bounds", right=("score", "out of bounds"))
    for row in rows[:MOST_FLIGHTS]:
        left = "-" if row.left is None else f"{row.left} of {row.primitives}"
        score = f"{row.score:.1f}" if isfinite(row.score) else "-"
        table.add_row(row.path.name, row.problem or row.outcome, score, row.reason, left)
    if len(rows) > MOST_FLIGHTS:
        table.add_row(f"and {len(rows) - MOST_FLIGHTS} more")
    return Group(facts, _heading("Flights, outliers first"), table)


def _heading(text: str) -> Padding:
    return Padding(Text(text, style="bold"), (1, 0, 0, 0))


def _facts(summary: Summary) -> Table:
    table = Table.grid(padding=(0, 2))
    table.add_column(style="bold")
    table.add_column()
    table.add_row(summary.kind, summary.name)
    flown = "" if summary.kind == "import" else f", wind class {summary.wind}, seed {summary.seed}"
    table.add_row("vehicle", f"{summary.vehicle}{flown}")
    track = "positions unknown" if summary.distance is None else f"{summary.distance:.1f} m over the ground"
    table.add_row("flight", f"{summary.duration:.2f} s, {track}")
    table.add_row("outcome", summary.outcome)
    if summary.arrival is not None:
        table.add_row("goal", _arrival(summary.arrival))
    if summary.planned_time is not None:
        table.add_row("planned time", f"{summary.planned_time:.2f} s")
    if summary.plans is not None:
        failed = f", {plural(summary.failures, 'replan')} failed" if summary.failures else ""
        table.add_row("plans found", f"{summary.plans}{failed}")
    if summary.trims or summary.maneuvers:
        table.add_row("time-outs", str(summary.timeouts))
    for sentence in summary.faults:
        table.add_row("fault", sentence)
    if summary.bounds is not None:
        table.add_row("out of bounds", _bounds(summary.bounds))
    elif summary.kind in IDENTIFICATION_KINDS:
        table.add_row("out of bounds", f"not compared: {NO_BOUNDS}")
    if summary.navigation is not None:
        error = summary.navigation
        table.add_row(
            "navigation",
            f"position {error.position_rms:.2f} m rms, {error.position_max:.2f} m at most; "
            f"velocity {error.velocity_rms:.3f} m/s rms; heading {error.heading_rms:.4f} rad rms",
        )
    return table


def _arrival(arrival: ArrivalVerdict) -> str:
    if arrival.time is None:
        return f"not reached: {arrival.reason}"
    return f"reached after {arrival.time:.2f} s"


def _bounds(bounds: BoundCheck) -> str:
    coasts, maneuvers = (
        bounds.count_violations(PrimitiveKind.COAST),
        bounds.count_violations(PrimitiveKind.MANEUVER),
    )
    return (
        f"{coasts} of {plural(bounds.coasts, 'coast')}, "
        f"{maneuvers} of {plural(bounds.maneuvers, 'maneuver')} "
        f"(library {bounds.library}, trim errors {bounds.trim_error_kind})"
    )


def _primitives(summary: Summary) -> Table:
    table = _columns("", "id", "", "count", "total, s", right=("id", "count", "total, s"))
    for kind, counts in (("trim", summary.trims), ("maneuver", summary.maneuvers)):
        for count in counts:
            table.add_row(kind, *_cells(count))
    return table


def _cells(count: PrimitiveCount) -> tuple[str, ...]:
    return str(count.id), count.name, str(count.count), f"{count.seconds:.2f}"


def _tracking(summary: Summary) -> Table:
    table = _columns("", "largest", "at", "rms", "unit", right=("largest", "at", "rms"))
    for error in summary.tracking or ():
        name = error.field.replace("_", " ")
        table.add_row(name, f"{error.worst:+.3f}", f"{error.time:.2f} s", f"{error.rms:.3f}", error.unit)
    return table


def _violations(bounds: BoundCheck) -> Table:
    table = _columns(
        "", "id", "start", "number", "deviation", "bound", right=("id", "start", "deviation", "bound")
    )
    furthest = sorted(bounds.violations, key=lambda d: -abs(d.deviation) / max(d.bound, 1e-9))
    for violation in furthest[:MOST_VIOLATIONS]:
        table.add_row(
            violation.kind.name.lower(),
            str(violation.id),
            f"{violation.start:.2f} s",
            violation.number.replace("_", " "),
            f"{violation.deviation:+.3f}",
            f"{violation.bound:.3f}",
        )
    if len(furthest) > MOST_VIOLATIONS:
        table.add_row(f"and {len(furthest) - MOST_VIOLATIONS} more")
    return table


def _columns(*names: str, right: tuple[str, ...]) -> Table:
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for name in names:
        table.add_column(name, justify="right" if name in right else "left")
    return table
