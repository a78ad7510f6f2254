"""Trim errors: at every instant of a coast, or averaged over it."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from identification.segmentation.segmentation import CoastSegment

from .samples import Hull

# Averages fall with the square root of time; with more bins, each would have fewer flights.
BINS = 3


def instantaneous_hull(coasts: list[CoastSegment]) -> Hull:
    """Returns the extreme instantaneous velocities of coasts (thesis, 3.2.6)."""
    velocity = np.concatenate([coast.velocity for coast in coasts])
    return velocity.min(axis=0), velocity.max(axis=0)


def averaged_hull(shortest: float, longest: float = np.inf) -> Callable[[list[CoastSegment]], Hull | None]:
    """Returns a function for the extreme averages over coasts of a duration.

    Every beginning of a coast counts as a coast, because the time of the next command does not depend on the
    velocity.

    Args:
        shortest: shortest duration in seconds.
        longest: longest duration in seconds.
    """

    def hull(coasts: list[CoastSegment]) -> Hull | None:
        averages = [running_average(coast) for coast in coasts]
        chosen = [
            value[(time >= shortest - _INSTANT) & (time <= longest + _INSTANT)] for time, value in averages
        ]
        together = np.concatenate(chosen)
        return (together.min(axis=0), together.max(axis=0)) if len(together) else None

    return hull


def running_average(
    coast: CoastSegment,
) -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n 3"]]:
    """Returns durations from a coast's start, s, and velocities averaged over them.

    Uses the trapezoidal rule over evenly spaced samples.
    """
    velocity = coast.velocity
    time = np.linspace(0.0, coast.duration, len(velocity))[1:]
    middles = (velocity[1:] + velocity[:-1]) / 2
    return time, np.cumsum(middles, axis=0) / np.arange(1, len(velocity))[:, None]


def duration_bins(coasts: Sequence[float], ordered: tuple[float, float] | None) -> list[tuple[float, float]]:
    """Returns bins of coast durations, s, from the shortest coast flown.

    Args:
        coasts: durations flown.
        ordered: shortest and longest commanded coasting time, where known.
    """
    shortest, longest = min(coasts), max(coasts)
    if ordered is not None:
        shortest, longest = max(shortest, ordered[0]), min(longest, ordered[1])
    edges = np.linspace(shortest, max(shortest, longest), BINS + 1).round(6).tolist()
    edges[0] = shortest
    return [(low, high) for low, high in pairwise(edges) if low < high]


# Tolerance of times, s: far below a sample, far above the rounding of sample times.
_INSTANT = 1e-6
