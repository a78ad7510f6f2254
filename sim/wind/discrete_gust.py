"""Discrete gust of MIL-F-8785C, 3.7.1.3: one minus cosine."""

from dataclasses import dataclass
from math import cos, hypot, pi

import numpy as np


@dataclass(frozen=True, slots=True)
class DiscreteGust:
    """Discrete gust with start and duration.

    Attributes:
        start: start, s.
        duration: total duration, s.
        north: peak velocity of the air, m/s.
        east: peak velocity of the air, m/s.
        down: peak velocity of the air, m/s.
    """

    start: float
    duration: float
    north: float
    east: float
    down: float

    def __post_init__(self) -> None:
        """Refuses durations that are not positive."""
        if not self.duration > 0.0:
            raise ValueError(f"duration must be > 0 s, got {self.duration} s")

    def speed(self, time: float) -> float:
        """Returns the gust's speed at a time, m/s."""
        return self._share(time) * hypot(self.north, self.east, self.down)

    def blow(self, wind: np.ndarray, time: float) -> None:
        """Adds the gust at a time in s to a `Wind` array."""
        share = self._share(time)
        wind[:3] += (share * self.north, share * self.east, share * self.down)

    def _share(self, time: float) -> float:
        """Returns the share of the peak at a time in s."""
        along = (time - self.start) / self.duration
        return 0.5 * (1.0 - cos(2.0 * pi * along)) if 0.0 < along < 1.0 else 0.0
