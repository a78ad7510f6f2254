"""The discrete gust of MIL-F-8785C, 3.7.1.3: one minus cosine up, then, by the same way, down again."""

from dataclasses import dataclass
from math import cos, hypot, pi

import numpy as np


@dataclass(frozen=True, slots=True)
class DiscreteGust:
    """A gust that comes at a time and goes.

    Attributes:
        start: s.
        duration: from nothing over the peak to nothing, s.
        north: velocity of the air at the peak, m/s.
        east: likewise.
        down: likewise.
    """

    start: float
    duration: float
    north: float
    east: float
    down: float

    def __post_init__(self) -> None:
        """Refuses a gust without a length."""
        if not self.duration > 0.0:
            raise ValueError(f"duration must be > 0 s, got {self.duration} s")

    def speed(self, time: float) -> float:
        """Returns the speed of the gust's air at a time in s, m/s."""
        return self._share(time) * hypot(self.north, self.east, self.down)

    def blow(self, wind: np.ndarray, time: float) -> None:
        """Adds the gust at a time in s to a wind laid out as `Wind`."""
        share = self._share(time)
        wind[:3] += (share * self.north, share * self.east, share * self.down)

    def _share(self, time: float) -> float:
        """Returns how much of the peak there is at a time in s."""
        along = (time - self.start) / self.duration
        return 0.5 * (1.0 - cos(2.0 * pi * along)) if 0.0 < along < 1.0 else 0.0
