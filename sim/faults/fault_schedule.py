"""Schedule of faults in control periods."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

from flight.mission.fault import Fault
from sim.loop.specification import CONTROL_PERIOD


class FaultTarget(Protocol):
    """Part of the flight loop that can fail."""

    def begin(self, number: int, fault: Fault) -> Callable[[], float]:
        """Starts a fault; returns its effect function."""

    def end(self, number: int, fault: Fault) -> None:
        """Ends a fault."""


@dataclass(frozen=True, slots=True)
class FaultWindow:
    """Control periods of a fault: first, and the one after the last."""

    first: int
    last: int | None


def fault_window(fault: Fault) -> FaultWindow:
    """Returns the control periods of a fault, at least one.

    Without a duration it lasts to the end of the flight.
    """
    first = round(fault.start / CONTROL_PERIOD)
    if fault.duration is None:
        return FaultWindow(first, None)
    return FaultWindow(first, max(first + 1, round((fault.start + fault.duration) / CONTROL_PERIOD)))


class FaultSchedule:
    """Schedule that starts and ends faults, period by period.

    Args:
        faults: faults by number.
        places: failing parts by the place of the faults.

    Attributes:
        active: effect functions of the active faults by number.
    """

    def __init__(self, faults: Mapping[int, Fault], places: Mapping[str, FaultTarget]) -> None:
        self._faults, self._places = faults, places
        self._windows = {number: fault_window(fault) for number, fault in faults.items()}
        self.active: dict[int, Callable[[], float]] = {}

    def begin(self, period: int) -> list[tuple[int, bool]]:
        """Ends and starts the faults due; returns numbers and if started."""
        ended = [number for number, at in self._windows.items() if at.last == period]
        begun = [number for number, at in self._windows.items() if at.first == period]
        for number in ended:
            fault = self._faults[number]
            self._places[fault.where].end(number, fault)
            del self.active[number]
        for number in begun:
            fault = self._faults[number]
            self.active[number] = self._places[fault.where].begin(number, fault)
        return [(number, False) for number in ended] + [(number, True) for number in begun]
