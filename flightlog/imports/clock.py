"""Clock of an imported file: unit, order and jumps of its stamps."""

from typing import Literal

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError

TimeUnit = Literal["s", "ms", "us", "ns"]

SECONDS: dict[TimeUnit, float] = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
"""Seconds in each unit."""

INTERVALS = (1e-4, 10.0)
"""Median sample intervals in seconds, from fast gyroscopes to slow trackers."""

LONGEST_GAP = 3600.0
"""Longest gap between two samples of one flight, seconds."""

LARGEST_LOSS = 0.01
"""Largest share of samples that may lie before an earlier one; they are dropped."""

Column = Float[np.ndarray, "n"]


class ClockError(FlightError):
    """Times of an imported file that are not those of one flight."""


def check_unit(stamps: Column, unit: TimeUnit | None) -> None:
    """Refuses stamps that cannot be in a unit.

    Args:
        stamps: times as they are in the file.
        unit: unit stated, which may be slow; seconds where None.

    Raises:
        ClockError: their rate is that of no flight; the message names the units that fit.
    """
    interval = _median_interval(stamps)
    shortest, longest = INTERVALS
    size = SECONDS[unit or "s"]
    if interval is None or shortest <= size * interval <= (LONGEST_GAP if unit else longest):
        return
    fitting = [
        f"{name} ({1.0 / (second * interval):.4g} Hz)"
        for name, second in SECONDS.items()
        if shortest <= second * interval <= longest
    ]
    raise ClockError(
        f"expected sample intervals of {shortest:g} to {longest:g} s, got {size * interval:.3g} s if times "
        f"are in {unit or 's'}: give --time-unit {' or '.join(fitting)}".rstrip()
    )


def check_clock(time: Column, *, sample: str) -> None:
    """Checks that a clock is slow enough, without jumps.

    Args:
        time: seconds; samples that are not finite are passed over.
        sample: name of a sample in the file, such as `row`.

    Raises:
        ClockError: it is not; the message has the sample and the size.
    """
    places = np.flatnonzero(np.isfinite(time))
    steps = np.diff(time[places])
    jumps = np.flatnonzero(steps > LONGEST_GAP)
    if len(jumps):
        at = jumps[0]
        raise ClockError(
            f"{sample} {places[at + 1] + 1}: time jumps ahead by {steps[at]:.6g} s, from "
            f"{time[places[at]]:.12g} s; expected gaps of at most {LONGEST_GAP:g} s: correct the times, or "
            "cut the file there"
        )
    if len(steps) and 0.0 < np.ptp(time[places]) < INTERVALS[0] * len(steps):
        raise ClockError(
            f"expected a {sample} every {INTERVALS[0]:g} s or less often, got {len(places)} in "
            f"{np.ptp(time[places]):.3g} s: check the unit of the times"
        )
    latest = np.maximum.accumulate(time[places])
    lost = int((time[places] < latest).sum())
    if lost > LARGEST_LOSS * len(places):
        at = np.flatnonzero(steps < 0.0)[0]
        raise ClockError(
            f"{sample} {places[at + 1] + 1}: time goes back by {-steps[at]:.6g} s, from "
            f"{time[places[at]]:.12g} s, and {lost} of {len(time)} times are before an earlier one: sort the "
            "file by time, or cut it there"
        )


def _median_interval(stamps: Column) -> float | None:
    """Returns the median interval between different stamps."""
    steps = np.abs(np.diff(stamps[np.isfinite(stamps)]))
    steps = steps[steps > 0.0]
    return float(np.median(steps)) if len(steps) else None
