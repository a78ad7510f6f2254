"""The scorecard as files: Markdown to read, CSV to count, JSON to go on with."""

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
    """What a validation came to.

    Attributes:
        command: that makes it again.
        library: name of the library planned with.
        totals: a cell for each condition, all missions together.
        cells: a cell for each mission and condition.
        promises: calibrated times.
        blamed: how the primitives kept their errors, by wind class.
        tubes: how flights kept their tubes, by wind class.
    """

    command: str
    library: str
    totals: tuple[ScorecardCell, ...]
    cells: tuple[ScorecardCell, ...]
    promises: tuple[TimeBoundTrial, ...]
    blamed: dict[str, tuple[ErrorAttribution, ...]]
    tubes: tuple[TubeTrial, ...] = ()


HEADS = (
    *("mission", "policy", "gamma", "plant", "wind", "reached", "95 %", "inside the prediction", "95 %"),
    *("flown, s", "95 % keep, s", "predicted, s", "worst miss, m", "plannings", "without a plan"),
    *("ways to rest", "planning 99 %, ms"),
)

NOTES = """`reached`: the true track entered the tolerance, on a plan; a flight that ends by time-out, by the
limit of plannings, without a plan or on its way to rest is not. `inside the prediction`: that, within the
time that the first plan promised. Intervals are Wilson's. `flown` and `predicted` are medians; `95 % keep`
counts flights that did not reach the goal as endless. Planning times are the processor's."""


TIME_BOUND_HEADS = ("policy", "gamma", "plant", "wind", "to be kept by", "factor", "from", "kept by", "95 %")

TIME_BOUND_NOTE = """\
A factor on the predicted time that so many flights or more keep, with 95 % confidence. What
stands beside the library, found on other missions, is tested on all of these; where nothing does, every
second mission sets the factor, and the others test it. The interval is Wilson's for as many trials as there
are missions, however often each was flown."""

ATTRIBUTION_HEADS = (
    *("primitive", "flights", "performances", "outside", "claimed inside", "chance"),
    *("furthest", "of", "flight", "at, s"),
)

ATTRIBUTION_NOTE = """\
Flights in which an error of the library was exceeded, beside the share of flights that the
library claims to stay inside; `chance` is that of so many outside, or more, if the claim held. The furthest
deviation is given in parts of the error."""


TUBE_HEADS = (
    "policy",
    "gamma",
    "wind",
    "errors times",
    "left it",
    "allowed share, at most",
    "chance, at most",
    "claims are",
)

TUBE_NOTE = """Flights that left the enclosure of the library's errors with independent signs between two
plannings, beside the share of flights in which the claims of their primitives, all together, let them. The
same with smaller errors than the library claims is the control: it has to be refuted."""


def scorecard_markdown(card: Scorecard) -> str:
    """Returns the scorecard as a page."""
    parts = [
        f"# Scorecard, {card.library}",
        f"    {card.command}",
        "## All missions",
        _table(HEADS, [_row(cell) for cell in card.totals]),
        NOTES,
        "## Promised times",
        TIME_BOUND_NOTE,
        _table(
            TIME_BOUND_HEADS,
            [_time_bound_row(promise) for promise in card.promises],
        ),
        *_attribution_parts(card.blamed),
        *_tube_parts(card.tubes),
        "## Every mission",
        _table(HEADS, [_row(cell) for cell in card.cells]),
    ]
    reasons = [
        f"- {cell.mission}, {cell.policy}, gamma {cell.gamma:g}, {cell.plant}, {cell.wind}: {reason}"
        for cell in card.cells
        for reason in cell.reasons
    ]
    parts += ["## Why goals were not reached", "\n".join(reasons) or "Every goal was reached."]
    return "\n\n".join(parts) + "\n"


def scorecard_csv(card: Scorecard) -> str:
    """Returns all cells as CSV; shares as counts with their intervals."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    rows = [cell_content(cell) for cell in (*card.totals, *card.cells)]
    writer.writerow(rows[0])
    writer.writerows(row.values() for row in rows)
    return stream.getvalue()


def scorecard_json(card: Scorecard, results: Sequence[MissionResult]) -> str:
    """Returns the scorecard with every flight, without tracks, as JSON."""
    document = {
        **asdict(card),
        "totals": [cell_content(cell) for cell in card.totals],
        "cells": [cell_content(cell) for cell in card.cells],
        "flights": [result_content(row) for row in results],
    }
    return json.dumps(document, indent=1) + "\n"


def result_content(row: MissionResult) -> dict[str, object]:
    """Returns a flight as plain JSON values, without its track and primitives."""
    content = asdict(row)
    for heavy in ("planning_times", "performances", "legs"):
        del content[heavy]
    return {**content, "log": None if row.log is None else str(row.log)}


def _attribution_parts(blamed: dict[str, tuple[ErrorAttribution, ...]]) -> list[str]:
    parts = []
    for wind, rows in blamed.items():
        parts += [
            f"## Which primitive to blame, wind {wind}",
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
            f"{tube.chance:.2g}",
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
        format_number(cell.predicted_time),
        format_number(cell.miss),
        f"{cell.activations:g}",
        str(cell.failures),
        str(cell.fallbacks),
        format_number(None if cell.planning_time_99 is None else 1e3 * cell.planning_time_99),
    ]


def _time_bound_row(promise: TimeBoundTrial) -> list[str]:
    return [
        promise.policy,
        f"{promise.gamma:g}",
        promise.plant,
        promise.wind,
        f"{promise.share:.0%}",
        format_number(promise.factor),
        ("the library: " if promise.stated else "")
        + f"{plural(promise.missions, 'mission')}, {plural(promise.flights, 'flight')}",
        *_share(promise.kept),
    ]


def _share(share: Proportion) -> list[str]:
    return [f"{share.count}/{share.of}", format_interval(share)]


def format_interval(share: Proportion) -> str:
    """Returns the interval of a share, in words for a table."""
    return f"{share.low:.3f}-{share.high:.3f}"


def format_number(value: float | None, digits: int = 2) -> str:
    """Returns a number for a table; a dash where there is none."""
    return "-" if value is None else f"{value:.{digits}f}"


def cell_content(cell: ScorecardCell) -> dict[str, object]:
    """Returns a cell as a flat row of plain values: a share as a count and its interval."""
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
