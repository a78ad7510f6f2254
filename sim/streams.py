"""Named sources of chance: one seed gives one flight, whatever else is drawn and in whatever order."""

from enum import IntEnum

import numpy as np


class Stream(IntEnum):
    """The sources of a flight; each is independent of the others."""

    WIND = 0
    NAVIGATION = 1


def random_stream(seed: int, stream: Stream) -> np.random.Generator:
    """Returns a source; the same seed and name give the same numbers."""
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed, spawn_key=(stream.value,))))
