"""Many flights at a glance: a row for each log, those that stand out first."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.errors import FlightError
from flightlog.channels import COMMAND, TRUTH
from flightlog.file.reader import read_log
from flightlog.log import FlightLog
from review.summary.bound_check import bounding_library, compute_deviations, with_bounds_of
from review.summary.summary import Summary, summarise
from review.summary.tracking import tracking_error

from .flight import sparkline

SPARKLINE_POINTS = 120
# Makes the median of absolute deviations a standard deviation, for a normal law.
_MAD_TO_SIGMA = 1.4826

FIGURES = {
    "forward": "forward speed off command",
    "side": "sideward speed off command",
    "yaw_rate": "yaw rate off command",
    "navigation": "navigation error",
    "share": "deviation over its bound",
}
"""What flights are compared by, in words; each is a figure that is better small."""


@dataclass(frozen=True, slots=True)
class FlightRow:
    """What a campaign's page says of one log.

    Attributes:
        path: the log.
        problem: why it could not be reviewed; empty where it could.
        name: of the flight.
        outcome: `completed`, `reached`, or what went wrong.
        good: whether the outcome is what was wanted.
        wind: wind class.
        duration: seconds.
        primitives: how many were flown.
        left: how many left their bounds; None without a library.
        timeouts: maneuvers that ended by time-out.
        figures: values of `FIGURES` that the log has.
        spark: how far the horizontal velocity was off command, m/s, over the flight.
        score: how far it stands out: standard deviations above the campaign's median.
        reason: in what it stands out.
    """

    path: Path
    problem: str = ""
    name: str = ""
    outcome: str = ""
    good: bool = False
    wind: str = ""
    duration: float = 0.0
    primitives: int = 0
    left: int | None = None
    timeouts: int = 0
    figures: tuple[tuple[str, float], ...] = ()
    spark: tuple[float, ...] = ()
    score: float = 0.0
    reason: str = ""


def flight_row(path: Path, *, library: Library | None = None) -> FlightRow:
    """Returns the row of a log; a log that cannot be reviewed says why in its row.

    Args:
        path: of the log.
        library: that judges it; the one flown with where None.
    """
    try:
        log = read_log(path)
        if library is not None:
            log = with_bounds_of(log, library)
        summary = summarise(log)
        figures = _figures(log, summary)
    except FlightError as error:
        return FlightRow(path, problem=str(error))
    reached = summary.arrival is not None and summary.arrival.time is not None
    missed = summary.arrival is not None and not reached
    completed = summary.outcome == "completed"
    outcome = summary.outcome if not completed else "reached" if reached else "completed"
    return FlightRow(
        path=path,
        name=summary.name,
        outcome="not reached" if completed and missed else outcome,
        good=completed and not missed,
        wind=summary.wind,
        duration=summary.duration,
        primitives=sum(part.count for part in (*summary.trims, *summary.maneuvers)),
        left=None if summary.bounds is None else len(summary.bounds.departures),
        timeouts=summary.timeouts,
        figures=figures,
        spark=_row_sparkline(log),
    )


def sort_outliers_first(rows: Sequence[FlightRow]) -> tuple[FlightRow, ...]:
    """Returns the rows with their scores: what failed, then what stands out from the others by most.

    A figure's score is its distance above the median in robust standard deviations (1.4826 times the median
    absolute deviation); a flight's is the largest of its figures'.
    """
    whole = [row for row in rows if not row.problem]
    names = [name for name in FIGURES if all(name in dict(row.figures) for row in whole)]
    values = np.array([[dict(row.figures)[name] for name in names] for row in whole])
    scores = _robust_scores(values.reshape(len(whole), len(names)))
    scored = [replace(row, score=inf, reason="cannot be reviewed") for row in rows if row.problem]
    for row, line in zip(whole, scores, strict=True):
        place = int(np.argmax(line)) if len(line) else -1
        score, reason = (float(line[place]), FIGURES[names[place]]) if len(line) else (0.0, "")
        if not row.good:
            score, reason = inf, row.outcome
        elif row.timeouts:
            score, reason = score + 100.0, "time-outs"
        scored.append(replace(row, score=score, reason=reason))
    return tuple(sorted(scored, key=lambda row: (-row.score, row.path.name)))


def _robust_scores(values: Float[np.ndarray, "flights figures"]) -> Float[np.ndarray, "flights figures"]:
    """Returns robust standard deviations above the median; 0 for a figure that does not vary."""
    if values.size == 0:
        return values
    apart = values - np.median(values, axis=0)
    spread = _MAD_TO_SIGMA * np.median(np.abs(apart), axis=0)
    return np.asarray(np.divide(apart, spread, out=np.zeros_like(apart), where=spread > 0))


def _figures(log: FlightLog, summary: Summary) -> tuple[tuple[str, float], ...]:
    figures = {error.field: error.rms for error in summary.tracking or ()}
    if summary.navigation is not None:
        figures["navigation"] = summary.navigation.position_rms
    if summary.bounds is not None:
        library = bounding_library(log)
        assert library is not None
        figures["share"] = max((one.share for one in compute_deviations(log, library)), default=0.0)
    return tuple(figures.items())


def _row_sparkline(log: FlightLog) -> tuple[float, ...]:
    if not {COMMAND.name, TRUTH.name} <= log.series.keys():
        return ()
    off = np.hypot(tracking_error(log, "forward"), tracking_error(log, "side"))
    return tuple(sparkline(log[TRUTH].time, off, points=SPARKLINE_POINTS))
