"""Flight computer with late commands or missed periods."""

from collections import deque
from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from flight.mission.fault import Fault


class DelayedComputer:
    """Maneuver generator and controller with delayed or missed periods.

    Args:
        compute: one period of each; the controller writes `controls`.
        controls: servo commands in force, changed in place.
        step: control period, s.
    """

    def __init__(
        self, compute: tuple[Callable[[], None], ...], controls: Float[np.ndarray, "4"], *, step: float
    ) -> None:
        self._compute, self._controls, self._step = compute, controls, step
        self._now = self._computed = 0
        self._faults: dict[int, tuple[Fault, int]] = {}
        self._waiting: deque[tuple[int, Float[np.ndarray, "4"]]] = deque()
        self._in_force = controls.copy()

    def begin(self, number: int, fault: Fault) -> Callable[[], float]:
        """Starts a fault at the next period; returns its effect function."""
        self._faults[number] = (fault, self._now)
        return lambda: (self._now - 1 - self._computed) * self._step

    def end(self, number: int, fault: Fault) -> None:
        """Ends a fault."""
        del self._faults[number]

    def run(self) -> None:
        """Computes unless missed, and applies the newest command due."""
        if not any(self._is_missed(fault, begun) for fault, begun in self._faults.values()):
            for run in self._compute:
                run()
            self._waiting.append((self._now, self._controls.copy()))
        latency = sum(
            round(fault.size[0] / self._step) for fault, _ in self._faults.values() if fault.what == "late"
        )
        while self._waiting and self._waiting[0][0] + latency <= self._now:
            self._computed, self._in_force = self._waiting.popleft()
        self._controls[:] = self._in_force
        self._now += 1

    def _is_missed(self, fault: Fault, begun: int) -> bool:
        """Returns True if a fault skips this period."""
        return fault.what == "misses" and (self._now - begun) % round(fault.size[0]) != 0
