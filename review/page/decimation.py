"""Fewer points for the eye, with every extreme kept."""

import numpy as np
from jaxtyping import Float


def decimate(
    time: Float[np.ndarray, "n"], columns: Float[np.ndarray, "n k"], *, most: int
) -> tuple[Float[np.ndarray, "m"], Float[np.ndarray, "m k"]]:
    """Returns at most `most` points: the least and the greatest of each stretch, by column.

    The two stand in the order in which they came, at the stretch's beginning and its middle: values are
    exact, times to within a stretch. Fewer points than `most` come back as they are.

    Args:
        time: not decreasing.
        columns: values at those times.
        most: >= 4, even.
    """
    count = len(time)
    if count <= most:
        return time, columns
    length = -(-count // (most // 2))
    stretches = -(-count // length)
    # The last stretch is filled up with its last value, which changes no extreme.
    padded = np.concatenate([columns, np.repeat(columns[-1:], stretches * length - count, axis=0)])
    pieces = padded.reshape(stretches, length, -1)
    least, greatest = pieces.argmin(axis=1), pieces.argmax(axis=1)
    places = np.stack([np.minimum(least, greatest), np.maximum(least, greatest)], axis=1)
    kept = np.take_along_axis(pieces, places, axis=1).reshape(2 * stretches, -1)
    begins = length * np.arange(stretches)
    at = np.stack([begins, np.minimum(begins + length // 2, count - 1)], axis=1).ravel()
    times = time[at]
    times[-1] = time[-1]
    return times, kept
