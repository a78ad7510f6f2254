"""Order of stamps: clocks set back, and stamps out of order."""

from bisect import bisect_right

import numpy as np
from jaxtyping import Float, Int

Column = Float[np.ndarray, "n"]

# Share of a span that both sides of a step back must fill for the clock to have been set back.
_MIN_FILLED = 0.75
_MIN_ROWS = 3
# Rows and intervals from the first or last stamp within which one out of order is kept.
_NEAR = 10.0
# Seconds from the others at which a few stamps at an end of a disordered file are corrupt.
_FAR = 1.0


def reset_places(time: Column, interval: float, longest_gap: float) -> list[int]:
    """Returns places at which the clock was set back.

    There the times that follow fill a span that those before fill too; rows written late fill holes.

    Args:
        time: finite seconds in the order of the file.
        interval: median interval, seconds.
        longest_gap: longest gap of one flight, seconds.
    """
    steps = np.diff(time)
    bounds = [0, *(np.flatnonzero((steps < 0.0) | (steps > longest_gap)) + 1).tolist(), len(time)]
    places = []
    start = 0
    for number in range(1, len(bounds) - 1):
        place, end = bounds[number], bounds[number + 1]
        before, after = time[start:place], time[place:end]
        if steps[place - 1] > longest_gap:
            # Far ahead: another flight, unless it is a few corrupt stamps.
            start = place
            continue
        low, high = max(float(after[0]), float(before.min())), min(float(before.max()), float(after[-1]))
        expected = (high - low) / interval + 1.0
        filled = [int(((side >= low) & (side <= high)).sum()) for side in (before, after)]
        if min(filled) >= max(_MIN_ROWS, _MIN_FILLED * expected):
            places.append(place)
            start = place
    return places


def displaced_rows(time: Column) -> tuple[Int[np.ndarray, "k"], int]:
    """Returns places in the order of time, and the number left out.

    A stamp out of order is kept if the others leave a hole at its time, or end shortly before or after it.
    """
    kept = _longest_increasing(time)
    displaced = np.setdiff1d(np.arange(len(time)), kept)
    base, wanted = time[kept], time[displaced]
    steps = np.diff(np.unique(time))
    interval = float(np.median(steps)) if len(steps) else 0.0
    after = np.searchsorted(base, wanted)
    inner = (after > 0) & (after < len(base))
    hole = np.zeros(len(displaced))
    hole[inner] = base[after[inner]] - base[after[inner] - 1]
    outside = np.maximum(base[0] - wanted, wanted - base[-1])
    beside = np.minimum(np.abs(displaced - kept[0]), np.abs(displaced - kept[-1])) <= _NEAR
    late = beside & (outside > 0.0) & (outside < _NEAR * interval)
    fitting = displaced[(hole > 1.5 * interval) | late]
    both = np.concatenate([kept, fitting])
    ordered = both[np.argsort(time[both], kind="stable")]
    if len(displaced):
        ordered = _without_lone_ends(ordered, time, interval)
    return ordered, len(time) - len(ordered)


def _without_lone_ends(places: Int[np.ndarray, "k"], time: Column, interval: float) -> Int[np.ndarray, "m"]:
    """Returns places without a few stamps far beyond an end."""
    far = np.flatnonzero(np.diff(time[places]) > max(_NEAR * interval, _FAR)) + 1
    start = max((at for at in far if at < _MIN_ROWS), default=0)
    end = min((at for at in far if len(places) - at < _MIN_ROWS), default=len(places))
    return places[start:end]


def _longest_increasing(time: Column) -> Int[np.ndarray, "k"]:
    """Returns places of a longest subsequence that does not decrease."""
    tails: list[float] = []
    ends: list[int] = []
    before = np.full(len(time), -1, np.int64)
    for place, value in enumerate(time.tolist()):
        at = bisect_right(tails, value)
        before[place] = ends[at - 1] if at else -1
        if at == len(tails):
            tails.append(value)
            ends.append(place)
        else:
            tails[at], ends[at] = value, place
    chain, place = [], ends[-1]
    while place >= 0:
        chain.append(place)
        place = int(before[place])
    return np.array(chain[::-1], np.int64)
