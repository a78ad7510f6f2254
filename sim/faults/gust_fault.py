"""Air with discrete gusts in it."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from flight.mission.fault import Fault
from sim.loop.specification import CONTROL_PERIOD
from sim.wind.discrete_gust import DiscreteGust


class GustInjector:
    """Adds gusts to the wind, period by period.

    Args:
        blow: one period of the wind; leaves the air's motion in `wind`.
        wind: laid out as `Wind`; altered in place.
    """

    def __init__(self, blow: Callable[[], None], wind: Float[np.ndarray, "6"]) -> None:
        self._blow, self._wind = blow, wind
        self._gusts: dict[int, DiscreteGust] = {}
        self._period = -1

    def begin(self, number: int, fault: Fault) -> Callable[[], float]:
        """Lets a gust come; returns what tells its speed."""
        assert fault.duration is not None, fault
        gust = DiscreteGust(fault.start, fault.duration, *fault.size)
        self._gusts[number] = gust
        return lambda: gust.speed(self._period * CONTROL_PERIOD)

    def end(self, number: int, fault: Fault) -> None:
        """Lets a gust be gone."""
        del self._gusts[number]

    def run(self) -> None:
        """Moves the air on by one control period."""
        self._blow()
        self._period += 1
        for gust in self._gusts.values():
            gust.blow(self._wind, self._period * CONTROL_PERIOD)
