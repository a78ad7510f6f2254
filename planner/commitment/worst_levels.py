"""Uncertainty levels with the largest miss at the middle of a box."""

import numpy as np
from jaxtyping import Complex, Float


def worst_levels(
    levels: Float[np.ndarray, "grid"], off: Complex[np.ndarray, "n grid"], count: int
) -> Float[np.ndarray, "n count"]:
    """Returns the interior levels with largest misses, in decreasing order.

    Args:
        levels: evenly spaced, the ends of the interval among them.
        off: from the goal to each end at these levels, metres.
        count: number of levels to return; filled up if the misses have fewer peaks.
    """
    miss = off.real**2 + off.imag**2
    before, here, after = miss[:, :-2], miss[:, 1:-1], miss[:, 2:]
    peak = (here >= before) & (here >= after)
    score = np.where(peak, here, -1.0)
    chosen = np.argsort(-score, axis=1)[:, :count]
    row = np.arange(len(miss))[:, None]
    bend = 2 * here - before - after
    shift = np.where(bend > 0, 0.5 * (after - before) / np.where(bend > 0, bend, 1.0), 0.0)
    step = levels[1] - levels[0]
    refined: Float[np.ndarray, "n count"] = levels[1:-1][chosen] + step * np.clip(
        shift[row, chosen], -0.5, 0.5
    )
    return refined
