"""Text and Markdown report of printed beside computed figures of the thesis."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from experiments.thesis.closed_loop_tables import NOT_REPRODUCED, ClosedLoopComparison, count_arrivals
from experiments.thesis.cost_tables import PrintedComparison

FIGURES = ("table", "figure", "printed", "computed", "trims", "")

FLIGHTS = ("table", "mission", "gamma", "policy", "printed, s", "flown at -gamma, s", "flown at +gamma, s")

TO_THE_RIGHT = {"table", "printed", "computed", "gamma", *FLIGHTS[4:]}


def print_thesis_tables(rows: Sequence[PrintedComparison], flights: Sequence[ClosedLoopComparison]) -> None:
    """Prints tables for a terminal."""
    console = Console(highlight=False)
    for headings, cells in _tables(rows, flights):
        table = Table(box=SIMPLE_HEAD, pad_edge=False)
        for heading in headings:
            table.add_column(heading, justify="right" if heading in TO_THE_RIGHT else "left")
        for line in cells:
            table.add_row(*(cell.replace("[", r"\[") for cell in line))
        console.print(table)
    for note in _notes(rows, flights):
        console.print(note.replace("[", r"\["), soft_wrap=True)


def markdown_page(rows: Sequence[PrintedComparison], flights: Sequence[ClosedLoopComparison]) -> str:
    """Returns the same as Markdown."""
    parts = []
    for headings, cells in _tables(rows, flights):
        rule = ["---:" if heading in TO_THE_RIGHT else "---" for heading in headings]
        parts.append("\n".join(f"| {' | '.join(line)} |" for line in (headings, rule, *cells)))
    return "\n\n".join([*parts, *_notes(rows, flights)]) + "\n"


def _tables(
    rows: Sequence[PrintedComparison], flights: Sequence[ClosedLoopComparison]
) -> list[tuple[tuple[str, ...], list[tuple[str, ...]]]]:
    explanations = _explanations(rows)
    figures = []
    for row in rows:
        computed = "none" if row.computed is None else f"{row.computed:.8g}"
        known = row.verdict in explanations
        mark = f"[{explanations.index(row.verdict) + 1}]" if known else row.verdict
        figures.append((str(row.table), row.what, f"{row.printed:.10g}", computed, row.sequence, mark))
    tables: list[tuple[tuple[str, ...], list[tuple[str, ...]]]] = [(FIGURES, [*figures])]
    if flights:
        flown = [
            (
                str(row.table),
                row.mission,
                f"{row.gamma:g}",
                row.policy,
                f"{row.printed:.2f}" + ("" if row.printed_reached else ", aborted"),
                *("aborted" if time is None else f"{time:.2f}" for time in (row.minus, row.plus)),
            )
            for row in flights
        ]
        tables.append((FLIGHTS, flown))
    return tables


def _notes(rows: Sequence[PrintedComparison], flights: Sequence[ClosedLoopComparison]) -> list[str]:
    notes = [f"[{place}] {note}" for place, note in enumerate(_explanations(rows), start=1)]
    return [*notes, *([count_arrivals(list(flights))] if flights else []), NOT_REPRODUCED]


def _explanations(rows: Sequence[PrintedComparison]) -> list[str]:
    return list(dict.fromkeys(row.verdict for row in rows if row.verdict not in {"same", "differs"}))
