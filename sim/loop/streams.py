"""Named sources of chance: one seed gives one flight, whatever else is drawn and in whatever order."""

from enum import IntEnum

import numpy as np


class Stream(IntEnum):
    """The sources of a flight; each is independent of the others."""

    WIND = 0
    NAVIGATION = 1


def random_stream(seed: int, stream: Stream, number: int = 0) -> np.random.Generator:
    """Returns a source; the same seed, name and number give the same numbers."""
    key = (stream.value, number) if number else (stream.value,)
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=key)))
