"""Independent named random streams from one seed."""

from enum import IntEnum

import numpy as np


class Stream(IntEnum):
    """Random streams of a flight, independent of each other."""

    WIND = 0
    NAVIGATION = 1
    AIRFRAME = 2
    LOADING = 3
    INSTALLATION = 4


def random_stream(seed: int, stream: Stream, number: int = 0) -> np.random.Generator:
    """Returns the random generator of a seed, stream and number."""
    key = (stream.value, number) if number else (stream.value,)
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key)))
