"""Decimation of curves that keeps every extreme."""

import numpy as np
from jaxtyping import Float


def decimate(
    time: Float[np.ndarray, "n"], columns: Float[np.ndarray, "n k"], *, most: int
) -> tuple[Float[np.ndarray, "m"], Float[np.ndarray, "m k"]]:
    """Reduces to at most `most` points: minimum and maximum per interval.

    The two keep their order and stand at the interval's beginning and middle: values are exact, times to
    within an interval. Input of at most `most` points is returned unchanged.

    Args:
        time: not decreasing.
        columns: values at those times.
        most: >= 4, even.
    """
    count = len(time)
    if count <= most:
        return time, columns
    length = -(-count // (most // 2))
    intervals = -(-count // length)
    # The last interval is padded with its last value, which changes no extreme.
    padded = np.concatenate([columns, np.repeat(columns[-1:], intervals * length - count, axis=0)])
    pieces = padded.reshape(intervals, length, -1)
    least, greatest = pieces.argmin(axis=1), pieces.argmax(axis=1)
    places = np.stack([np.minimum(least, greatest), np.maximum(least, greatest)], axis=1)
    kept = np.take_along_axis(pieces, places, axis=1).reshape(2 * intervals, -1)
    begins = length * np.arange(intervals)
    at = np.stack([begins, np.minimum(begins + length // 2, count - 1)], axis=1).ravel()
    times = time[at]
    times[-1] = time[-1]
    return times, kept
