"""Text report of a scorecard."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from experiments.validation.scorecard import ScorecardCell
from experiments.validation.scorecard_files import Scorecard, format_number
from flight.plural import plural

WIDEST = 400
"""Characters of a line, more than any table needs."""

MOST_ROWS = 24
"""Largest number of cells printed one by one; more are printed as totals over all missions."""


def print_scorecard(card: Scorecard) -> None:
    """Prints the scorecard, reasons for goals not reached, and time bounds."""
    console = Console(highlight=False)
    cells = card.cells if len(card.cells) <= MOST_ROWS else card.totals
    console.print(f"{_where(cells)}; medians of flown and planned time", soft_wrap=True)
    table = _table(cells)
    # A narrow terminal wraps lines; no number is cut.
    wide = console.measure(table, options=console.options.update(max_width=WIDEST))
    console.width = max(console.width, wide.maximum)
    console.print(table)
    shown = [(cell, reason) for cell in card.cells for reason in cell.reasons]
    for cell, reason in shown[:MOST_ROWS]:
        console.print(f"{cell.mission}, {cell.policy}: not reached: {reason}", soft_wrap=True)
    if len(shown) > MOST_ROWS:
        console.print(f"and {len(shown) - MOST_ROWS} more; --out keeps them all", soft_wrap=True)
    for bound in card.time_bounds:
        if bound.flights >= MOST_ROWS and bound.factor is not None:
            source = f"95 % confidence, {plural(bound.flights, 'flight')}"
            console.print(
                f"{bound.policy}, {bound.plant}, {bound.wind}: {100 * bound.share:.0f} % of flights finish "
                f"within {bound.factor:.2f} × predicted ({source}); "
                f"here {bound.kept.count} of {bound.kept.of} did",
                soft_wrap=True,
            )
    for tube in card.tubes:
        result = "REFUTED" if tube.refuted else "not refuted"
        console.print(
            f"{tube.policy}, {tube.wind}: {tube.left} of {tube.flights} flights left the tube of "
            f"{tube.share:g} × the errors, at most {100 * tube.allowed:.0f} % allowed: {result}",
            soft_wrap=True,
        )


def _where(cells: Sequence[ScorecardCell]) -> str:
    winds = dict.fromkeys(cell.wind for cell in cells)
    return f"wind class {', '.join(winds)}" if list(winds) != ["none"] else "automaton, no wind"


def _table(cells: Sequence[ScorecardCell]) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    words = {
        "mission": lambda cell: cell.mission,
        "policy": lambda cell: cell.policy,
        "gamma": lambda cell: f"{cell.gamma:g}",
        "plant": lambda cell: cell.plant,
        "wind": lambda cell: cell.wind,
    }
    numbers = {
        "reached": lambda cell: f"{cell.reached.count}/{cell.flights}",
        "95 %": lambda cell: f"{cell.reached.low:.2f}-{cell.reached.high:.2f}",
        "flown, s": lambda cell: format_number(cell.flown_time),
        "plan, s": lambda cell: format_number(cell.planned_time),
        "within predicted": lambda cell: f"{cell.inside.count}/{cell.flights}",
        "miss, m": lambda cell: format_number(cell.miss),
        "no plan": lambda cell: str(cell.failures),
    }
    kept = {"mission", "policy", "reached", "95 %", "flown, s", "plan, s", "within predicted"}
    kept |= {name for name in ("plant", "wind") if len({getattr(cell, name) for cell in cells}) > 1}
    kept |= {"gamma"} if len({cell.gamma for cell in cells if cell.policy != "nominal"}) > 1 else set()
    kept |= {"miss, m"} if any(cell.miss is not None for cell in cells) else set()
    kept |= {"no plan"} if any(cell.failures for cell in cells) else set()
    columns = {name: of for name, of in (words | numbers).items() if name in kept}
    for name in columns:
        table.add_column(name, justify="left" if name in words else "right", no_wrap=True)
    for cell in cells:
        table.add_row(*(of(cell) for of in columns.values()))
    return table
