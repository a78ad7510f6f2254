"""Holes and breaks in the motion of imported logs."""

import json
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from flightlog.attachment_names import IMPORT_ATTACHMENT
from flightlog.consistency import IMPORT
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ESTIMATE, MOTION, TRUTH

# Gaps that are holes, in median intervals, and in seconds at least.
_HOLE, _SHORTEST = 10.0, 0.5
_MOTION = ("forward", "side", "yaw_rate")

Column = Float[np.ndarray, "n"]


@dataclass(frozen=True, slots=True)
class LoggedBreak:
    """Reset or jump of an imported motion.

    Attributes:
        start: last state before, seconds.
        time: first state after, seconds.
        reason: in words.
    """

    start: float
    time: float
    reason: str


def logged_breaks(log: FlightLog) -> tuple[LoggedBreak, ...]:
    """Returns the resets and jumps that the import of a log found."""
    content = log.attachments.get(IMPORT_ATTACHMENT)
    if content is None:
        return ()
    try:
        rows = json.loads(content).get("breaks", [])
        return tuple(LoggedBreak(float(row["start"]), float(row["time"]), str(row["reason"])) for row in rows)
    except (ValueError, KeyError, TypeError, AttributeError):
        return ()


def continuous_parts(log: FlightLog) -> tuple[FlightLog, ...]:
    """Returns an imported log's parts without holes and breaks.

    Each starts at time 0; another log is one part. Where the motion is not known at all, so is its part.
    """
    if log.header.kind != IMPORT or not log.motion.has_fields(*_MOTION):
        return (log,)
    motion = log.motion
    rows = np.flatnonzero(np.isfinite(motion.values).all(axis=1))
    if len(rows) < 2:
        return (log,)
    time = motion.time[rows]
    cuts = _cuts(time, logged_breaks(log))
    if not len(cuts) and len(rows) == len(motion.time):
        return (log,)
    parts = [part for part in np.split(rows, cuts) if len(part) > 1]
    return tuple(_cut(log, motion.time[part[0]], motion.time[part[-1]]) for part in parts)


def with_marked_holes(log: FlightLog) -> FlightLog:
    """Returns an imported log with an unknown state in each hole.

    Lines that are drawn of it then end there.
    """
    if log.header.kind != IMPORT:
        return log
    names = {TRUTH.name, ESTIMATE.name, MOTION.name}
    breaks = logged_breaks(log)
    series = {
        name: _marked(part, breaks) if name in names and len(part) > 1 else part
        for name, part in log.series.items()
    }
    return replace(log, series=series)


def _cuts(time: Column, breaks: Sequence[LoggedBreak]) -> Int[np.ndarray, "k"]:
    """Returns the places of first states after holes and breaks."""
    steps = np.diff(time)
    after = np.flatnonzero(steps > max(_HOLE * float(np.median(steps)), _SHORTEST)) + 1
    jumps = [int(np.searchsorted(time, each.time - 1e-9)) for each in breaks]
    befores = [int(np.searchsorted(time, each.start + 1e-6)) for each in breaks]
    cuts = np.unique([*after.tolist(), *jumps, *befores]).astype(np.int64)
    return cuts[(cuts > 0) & (cuts < len(time))]


def _cut(log: FlightLog, start: float, end: float) -> FlightLog:
    series = {}
    for name, part in log.series.items():
        inside = (part.time >= start) & (part.time <= end)
        if inside.any():
            series[name] = Series(part.topic, part.time[inside] - start, part.values[inside])
    return replace(log, series=series)


def _marked(series: Series, breaks: Sequence[LoggedBreak]) -> Series:
    time = series.time
    usual = float(np.median(np.diff(time)))
    cuts = _cuts(time, breaks)
    if not len(cuts):
        return series
    at = np.minimum(time[cuts - 1] + usual, 0.5 * (time[cuts - 1] + time[cuts]))
    hole = np.full((len(cuts), series.values.shape[1]), np.nan)
    return Series(series.topic, np.insert(time, cuts, at), np.insert(series.values, cuts, hole, axis=0))
