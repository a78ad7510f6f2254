"""Clock of an imported file: unit, order, outliers and parts."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float, Int

from flight.errors import FlightError

from .order import displaced_rows, reset_places

TimeUnit = Literal["s", "ms", "us", "ns"]

SECONDS: dict[TimeUnit, float] = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
"""Seconds in each unit."""

INTERVALS = (1e-4, 10.0)
"""Median sample intervals in seconds, from fast gyroscopes to slow trackers."""

SURE_INTERVAL = 0.5
"""Longest median interval at which unstated times are seconds, not milliseconds."""

LONGEST_GAP = 3600.0
"""Longest gap between two samples of one flight, seconds."""

SMALLEST_PART = 0.01
"""Smallest share of a file's samples that is a part of its own; less is left out."""

MOST_REPEATED = 0.1
"""Largest share of samples that may have the time of another one."""

DESCENDING = 0.9
"""Share of steps back above which a file has its latest sample first."""

_MOST_LISTED = 6

Column = Float[np.ndarray, "n"]


class ClockError(FlightError):
    """Times of an imported file that are not those of one flight."""


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Samples of one part of a file, in order of time.

    Attributes:
        rows: places of the samples in the file.
        time: seconds, increasing.
        left_out: number of samples of the file left out, by reason.
        total: samples of the part and those left out.
    """

    rows: Int[np.ndarray, "k"]
    time: Float[np.ndarray, "k"]
    left_out: dict[str, int]
    total: int

    @property
    def lost(self) -> int:
        """Number of samples left out."""
        return sum(self.left_out.values())


def check_unit(stamps: Column, unit: TimeUnit | None) -> None:
    """Refuses stamps that cannot be in a unit.

    Args:
        stamps: times as they are in the file.
        unit: unit stated, which may be slow; seconds where None.

    Raises:
        ClockError: their rate is that of no flight, or fits two units; the message names those that fit.
    """
    interval = _median_interval(stamps)
    shortest, longest = INTERVALS
    size = SECONDS[unit or "s"]
    if interval is None or shortest <= size * interval <= (LONGEST_GAP if unit else SURE_INTERVAL):
        return
    fitting = [
        f"{name} ({1.0 / (second * interval):.4g} Hz)"
        for name, second in SECONDS.items()
        if shortest <= second * interval <= longest
    ]
    raise ClockError(
        f"expected sample intervals of {shortest:g} to {LONGEST_GAP if unit else SURE_INTERVAL:g} s, got "
        f"{size * interval:.3g} s if times are in {unit or 's'}: "
        f"give --time-unit {' or '.join(fitting)}".rstrip()
    )


def order_by_time(
    time: Column, *, sample: str, part: int | None = None, repeated: Bool[np.ndarray, "n"] | None = None
) -> Part:
    """Returns the samples of one part of a file, sorted by time.

    A stamp out of order is sorted where the others leave a hole for it, and otherwise left out. The file is
    split where its clock was set back and at jumps of more than an hour; pieces of less than 1 % are left
    out.

    Args:
        time: seconds; samples that are not finite are left out.
        sample: name of a sample in the file, such as `row`.
        part: number of the part, from 1; needed where there are several.
        repeated: samples that are a copy of the one before.

    Raises:
        ClockError: there are several parts and none is chosen, or the clock is too coarse or too fast.
    """
    places = np.flatnonzero(np.isfinite(time))
    if len(places) < 2:
        raise ClockError(f"expected at least two {sample}s with a time, got {len(places)}")
    left_out = {"without a time": len(time) - len(places)}
    if repeated is not None:
        left_out["repeated"] = int(repeated[places].sum())
        places = places[~repeated[places]]
    steps = np.diff(time[places])
    if (steps < 0.0).sum() > DESCENDING * len(steps):
        places = places[::-1]
    pieces, left_out["with a time out of order"] = _pieces(time, places)
    smallest = max(3.0, SMALLEST_PART * len(places))
    parts = [piece for piece in pieces if len(piece) >= smallest] or [max(pieces, key=len)]
    left_out["with a time far from the others"] = sum(map(len, pieces)) - sum(map(len, parts))
    chosen = parts[_choose(time, parts, sample=sample, part=part) - 1]
    times = time[chosen]
    new = np.diff(times, prepend=-np.inf) > 0.0
    left_out["with the time of another"] = int((~new).sum())
    _check_resolution(times, new, sample=sample)
    left_out = {reason: count for reason, count in left_out.items() if count}
    return Part(chosen[new], times[new], left_out, len(chosen) + sum(left_out.values()) - int((~new).sum()))


def _pieces(time: Column, places: Int[np.ndarray, "k"]) -> tuple[list[Int[np.ndarray, "m"]], int]:
    """Returns pieces of ascending times in file order, and stamps rejected."""
    if (np.diff(time[places]) >= 0.0).all():
        between = [places]
        rejected = 0
    else:
        interval = _median_interval(time[places]) or 0.0
        bounds = [0, *reset_places(time[places], interval, LONGEST_GAP), len(places)]
        between, rejected = [], 0
        for start, end in pairwise(bounds):
            part = places[start:end]
            kept, lost = displaced_rows(time[part])
            between.append(part[kept])
            rejected += lost
    pieces = []
    for part in between:
        jumps = np.flatnonzero(np.diff(time[part]) > LONGEST_GAP) + 1
        pieces += [piece for piece in np.split(part, jumps) if len(piece)]
    return pieces, rejected


def _choose(time: Column, parts: list[Int[np.ndarray, "m"]], *, sample: str, part: int | None) -> int:
    """Returns the number of the part to read."""
    if part is not None and not 1 <= part <= len(parts):
        raise ClockError(f"no part {part}; the file has {len(parts)}")
    if part is not None or len(parts) == 1:
        return part or 1
    listed = [
        f"{number}: {sample}s {piece.min() + 1} to {piece.max() + 1}, {time[piece[0]]:.6f} to "
        f"{time[piece[-1]]:.6f} s"
        for number, piece in enumerate(parts[:_MOST_LISTED], start=1)
    ]
    more = f"; and {len(parts) - _MOST_LISTED} more" if len(parts) > _MOST_LISTED else ""
    raise ClockError(
        f"time was set back or jumps by more than {LONGEST_GAP:g} s: give --part N, one of "
        f"{'; '.join(listed)}{more}"
    )


def _check_resolution(times: Column, new: Bool[np.ndarray, "k"], *, sample: str) -> None:
    """Refuses a clock that is coarser, or faster, than a sensor's rate."""
    count, span = int(new.sum()), float(times[-1] - times[0])
    if (~new).sum() > MOST_REPEATED * len(times):
        rate = (
            f"give --rate {len(times) * (count - 1) / count / span:.4g}"
            if count > 1 and span > 0.0
            else "give --rate"
        )
        raise ClockError(
            f"{len(times)} {sample}s have {count} different times: for {sample}s at equal intervals {rate} "
            "(Hz), or another column of times"
        )
    if 0.0 < span < INTERVALS[0] * (count - 1):
        raise ClockError(
            f"expected a {sample} every {INTERVALS[0]:g} s or less often, got {count} in {span:.3g} s: "
            "check the unit of the times"
        )


def _median_interval(stamps: Column) -> float | None:
    """Returns the median interval between different stamps."""
    steps = np.abs(np.diff(stamps[np.isfinite(stamps)]))
    steps = steps[steps > 0.0]
    return float(np.median(steps)) if len(steps) else None
