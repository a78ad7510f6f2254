"""Rows of a campaign's index: figures of each flight, outliers first."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.errors import FlightError
from flightlog.file.reader import read_log
from flightlog.log import FlightLog
from flightlog.topics import COMMAND, TRUTH
from review.summary.bound_check import bounding_library, compute_deviations, with_bounds_of
from review.summary.summary import Summary, summarise
from review.summary.tracking import tracking_error

from .flight import sparkline

SPARKLINE_POINTS = 120
# Factor from median absolute deviation to standard deviation, for a normal distribution.
_MAD_TO_SIGMA = 1.4826

FIGURES = {
    "forward": "forward speed error",
    "side": "sideward speed error",
    "yaw_rate": "yaw rate error",
    "navigation": "navigation error",
    "share": "deviation over its bound",
}
"""Labels of the figures that flights are compared by; smaller is better."""


@dataclass(frozen=True, slots=True)
class FlightRow:
    """Row of one log in a campaign's index.

    Attributes:
        path: the log.
        problem: reason why it could not be reviewed; empty where it could.
        name: name of the flight.
        outcome: `completed`, `reached`, or the failure.
        good: True for a completed flight that did not miss its goal.
        wind: wind class.
        duration: seconds.
        primitives: number of primitives flown.
        left: number of primitives that left their bounds; None without a library.
        timeouts: maneuvers that ended by time-out.
        figures: values of `FIGURES` that the log has.
        spark: horizontal velocity error, m/s, over the flight.
        score: standard deviations above the campaign's median.
        reason: the figure with this score, or the failure.
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
    """Returns the row of a log; `problem` holds a failure to review.

    Args:
        path: the log file.
        library: library to check against; the one flown with where None.
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
        left=None if summary.bounds is None else len(summary.bounds.violations),
        timeouts=summary.timeouts,
        figures=figures,
        spark=_row_sparkline(log),
    )


def sort_outliers_first(rows: Sequence[FlightRow]) -> tuple[FlightRow, ...]:
    """Scores and sorts rows: failures first, then by decreasing score.

    A figure's score is its distance above the median in robust standard deviations (1.4826 times the median
    absolute deviation); a flight's score is the largest of its figures.
    """
    readable = [row for row in rows if not row.problem]
    names = [name for name in FIGURES if all(name in dict(row.figures) for row in readable)]
    values = np.array([[dict(row.figures)[name] for name in names] for row in readable])
    scores = _robust_scores(values.reshape(len(readable), len(names)))
    scored = [replace(row, score=inf, reason="cannot be reviewed") for row in rows if row.problem]
    for row, line in zip(readable, scores, strict=True):
        place = int(np.argmax(line)) if len(line) else -1
        score, reason = (float(line[place]), FIGURES[names[place]]) if len(line) else (0.0, "")
        if not row.good:
            score, reason = inf, row.outcome
        elif row.timeouts:
            score, reason = score + 100.0, "time-outs"
        scored.append(replace(row, score=score, reason=reason))
    return tuple(sorted(scored, key=lambda row: (-row.score, row.path.name)))


def _robust_scores(values: Float[np.ndarray, "flights figures"]) -> Float[np.ndarray, "flights figures"]:
    """Returns robust standard deviations above the median; 0 without variation."""
    if values.size == 0:
        return values
    off = values - np.median(values, axis=0)
    sigma = _MAD_TO_SIGMA * np.median(np.abs(off), axis=0)
    return np.asarray(np.divide(off, sigma, out=np.zeros_like(off), where=sigma > 0))


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
