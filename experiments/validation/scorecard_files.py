"""Scorecard as Markdown, CSV and JSON."""

import csv
import io
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass

from experiments.mission.error_attribution import ErrorAttribution
from experiments.mission.result import MissionResult
from flight.plural import plural

from .scorecard import Proportion, ScorecardCell
from .time_bound_trial import TimeBoundTrial
from .tube_trial import TubeTrial


@dataclass(frozen=True, slots=True)
class Scorecard:
    """Results of a validation.

    Attributes:
        command: command that reproduces it.
        library: name of the library of the plans.
        totals: a cell per condition, all missions together.
        cells: a cell per mission and condition.
        time_bounds: trials of time bounds.
        attributions: deviations of primitives by wind class.
        tubes: trials of tubes.
    """

    command: str
    library: str
    totals: tuple[ScorecardCell, ...]
    cells: tuple[ScorecardCell, ...]
    time_bounds: tuple[TimeBoundTrial, ...]
    attributions: dict[str, tuple[ErrorAttribution, ...]]
    tubes: tuple[TubeTrial, ...] = ()


HEADS = (
    *("mission", "policy", "gamma", "plant", "wind", "reached", "95 %", "within predicted time", "95 %"),
    *(
        "flown, s",
        "95 % quantile, s",
        "planned, s",
        "predicted, s",
        "worst miss, m",
        "replans",
        "failed replans",
    ),
    *("safe stops", "replan CPU 99 %, ms"),
)

NOTES = """`reached`: the true track entered the tolerance on a plan; flights that end by time-out, by the
limit of replans, without a plan or on a safe-stop path do not count. `within predicted time`: reached within
the time that the loop predicts at its start, with its latency and the part of the tolerance that it aims at;
`planned` is the time of the plan for the mission as stated. Intervals are Wilson's. Times are medians; in the
`95 % quantile`, flights that did not reach the goal count as infinite. Replan times are CPU times."""


TIME_BOUND_HEADS = ("policy", "gamma", "plant", "wind", "share", "factor", "found on", "within bound", "95 %")

TIME_BOUND_NOTE = """\
`share` of flights finish within `factor` times the predicted time (95 % confidence). A bound of the
library, found on other missions, is tested on all of these; without one, every second mission sets the factor
and the others test it. The interval is Wilson's with one trial per mission, independent of the number of
flights per mission."""

ATTRIBUTION_HEADS = (
    *("primitive", "flights", "performances", "outside", "claimed inside", "p-value"),
    *("worst", "of", "flight", "at, s"),
)

ATTRIBUTION_NOTE = """\
Flights in which an error of the library was exceeded, with the coverage that the
library claims; `p-value` is the probability of at least this many outside if the claim is true. The worst
deviation is given over the error."""


TUBE_HEADS = (
    "policy",
    "gamma",
    "wind",
    "error scale",
    "left tube",
    "allowed share, at most",
    "p-value, at most",
    "claims",
)

TUBE_NOTE = """Flights that left the enclosure of the library's errors with independent signs between two
replans, with the share of flights that the claims of their primitives allow together. Smaller errors than the
library's are the control, which must be refuted."""


def scorecard_markdown(card: Scorecard) -> str:
    """Returns the scorecard as a Markdown page."""
    parts = [
        f"# Scorecard, {card.library}",
        f"    {card.command}",
        "## All missions",
        _table(HEADS, [_row(cell) for cell in card.totals]),
        NOTES,
        "## Time bounds",
        TIME_BOUND_NOTE,
        _table(
            TIME_BOUND_HEADS,
            [_time_bound_row(bound) for bound in card.time_bounds],
        ),
        *_attribution_parts(card.attributions),
        *_tube_parts(card.tubes),
        "## Every mission",
        _table(HEADS, [_row(cell) for cell in card.cells]),
    ]
    reasons = [
        f"- {cell.mission}, {cell.policy}, gamma {cell.gamma:g}, {cell.plant}, {cell.wind}: {reason}"
        for cell in card.cells
        for reason in cell.reasons
    ]
    parts += ["## Reasons for missed goals", "\n".join(reasons) or "Every goal was reached."]
    return "\n\n".join(parts) + "\n"


def scorecard_csv(card: Scorecard) -> str:
    """Returns all cells as CSV, with shares as counts and intervals."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    rows = [cell_content(cell) for cell in (*card.totals, *card.cells)]
    writer.writerow(rows[0])
    writer.writerows(row.values() for row in rows)
    return stream.getvalue()


def scorecard_json(card: Scorecard, results: Sequence[MissionResult]) -> str:
    """Returns the scorecard and all flights as JSON, without tracks."""
    document = {
        **asdict(card),
        "totals": [cell_content(cell) for cell in card.totals],
        "cells": [cell_content(cell) for cell in card.cells],
        "flights": [result_content(row) for row in results],
    }
    return json.dumps(document, indent=1) + "\n"


def result_content(row: MissionResult) -> dict[str, object]:
    """Returns a result as plain JSON values, without track and primitives."""
    content = asdict(row)
    for heavy in ("planning_times", "performances", "legs"):
        del content[heavy]
    return {**content, "log": None if row.log is None else str(row.log)}


def _attribution_parts(attributions: dict[str, tuple[ErrorAttribution, ...]]) -> list[str]:
    parts = []
    for wind, rows in attributions.items():
        parts += [
            f"## Errors exceeded by primitive, wind {wind}",
            ATTRIBUTION_NOTE,
            _table(ATTRIBUTION_HEADS, [_attribution_row(row) for row in rows]),
        ]
    return parts


def _tube_parts(tubes: Sequence[TubeTrial]) -> list[str]:
    rows = [
        [
            tube.policy,
            f"{tube.gamma:g}",
            tube.wind,
            f"{tube.share:g}",
            f"{tube.left}/{tube.flights}",
            f"{tube.allowed:.3f}",
            f"{tube.p_value:.2g}",
            "refuted" if tube.refuted else "not refuted",
        ]
        for tube in tubes
    ]
    return ["## Tubes", TUBE_NOTE, _table(TUBE_HEADS, rows)] if rows else []


def _attribution_row(row: ErrorAttribution) -> list[str]:
    return [
        f"{row.kind} {row.id}",
        str(row.flights),
        str(row.performances),
        str(row.outside),
        format_number(row.claimed, 3),
        "-" if row.p_value is None else f"{row.p_value:.2g}",
        format_number(row.worst.share),
        row.worst.scalar,
        row.flight,
        format_number(row.worst.time),
    ]


def _row(cell: ScorecardCell) -> list[str]:
    return [
        cell.mission,
        cell.policy,
        f"{cell.gamma:g}",
        cell.plant,
        cell.wind,
        *_share(cell.reached),
        *_share(cell.inside),
        format_number(cell.flown_time),
        format_number(cell.flown_time_95),
        format_number(cell.planned_time),
        format_number(cell.predicted_time),
        format_number(cell.miss),
        f"{cell.replans:g}",
        str(cell.failures),
        str(cell.safe_stops),
        format_number(None if cell.planning_time_99 is None else 1e3 * cell.planning_time_99),
    ]


def _time_bound_row(bound: TimeBoundTrial) -> list[str]:
    return [
        bound.policy,
        f"{bound.gamma:g}",
        bound.plant,
        bound.wind,
        f"{bound.share:.0%}",
        format_number(bound.factor),
        ("the library: " if bound.stated else "")
        + f"{plural(bound.missions, 'mission')}, {plural(bound.flights, 'flight')}",
        *_share(bound.kept),
    ]


def _share(share: Proportion) -> list[str]:
    return [f"{share.count}/{share.of}", format_interval(share)]


def format_interval(share: Proportion) -> str:
    """Returns the interval of a share for a table."""
    return f"{share.low:.3f}-{share.high:.3f}"


def format_number(value: float | None, digits: int = 2) -> str:
    """Returns a number for a table; a dash for None."""
    return "-" if value is None else f"{value:.{digits}f}"


def cell_content(cell: ScorecardCell) -> dict[str, object]:
    """Returns a cell as a flat row of plain values."""
    flat: dict[str, object] = {"flights": cell.flights}
    for key, value in asdict(cell).items():
        if isinstance(value, dict):
            flat[key] = value["count"]
            flat |= {f"{key}_low": value["low"], f"{key}_high": value["high"]}
        elif isinstance(value, tuple):
            flat[key] = "; ".join(value)
        else:
            flat[key] = value
    return flat


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
