"""Discrete gusts injected into the wind."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from flight.mission.fault import Fault
from sim.loop.specification import CONTROL_PERIOD
from sim.wind.discrete_gust import DiscreteGust


class GustInjector:
    """Wind with discrete gusts.

    Args:
        blow: one period of the wind; writes `wind`.
        wind: motion of the air, laid out as `Wind`, changed in place.
    """

    def __init__(self, blow: Callable[[], None], wind: Float[np.ndarray, "6"]) -> None:
        self._blow, self._wind = blow, wind
        self._gusts: dict[int, DiscreteGust] = {}
        self._period = -1

    def begin(self, number: int, fault: Fault) -> Callable[[], float]:
        """Starts a gust; returns its speed function."""
        assert fault.duration is not None, fault
        gust = DiscreteGust(fault.start, fault.duration, *fault.size)
        self._gusts[number] = gust
        return lambda: gust.speed(self._period * CONTROL_PERIOD)

    def end(self, number: int, fault: Fault) -> None:
        """Ends a gust."""
        del self._gusts[number]

    def run(self) -> None:
        """Advances the wind by one control period."""
        self._blow()
        self._period += 1
        for gust in self._gusts.values():
            gust.blow(self._wind, self._period * CONTROL_PERIOD)
