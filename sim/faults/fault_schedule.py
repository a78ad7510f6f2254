"""When faults begin and end, to the nearest control period."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

from flight.mission.fault import Fault
from sim.loop.specification import CONTROL_PERIOD


class FaultTarget(Protocol):
    """A part of the flight loop that can fail."""

    def begin(self, number: int, fault: Fault) -> Callable[[], float]:
        """Lets a fault act from now on; returns what tells its effect."""

    def end(self, number: int, fault: Fault) -> None:
        """Takes a fault away."""


@dataclass(frozen=True, slots=True)
class FaultWindow:
    """The control periods in which a fault acts: from the first until before the last."""

    first: int
    last: int | None


def fault_window(fault: Fault) -> FaultWindow:
    """Returns when a fault acts: for one control period at least, for good where it has no duration."""
    first = round(fault.start / CONTROL_PERIOD)
    if fault.duration is None:
        return FaultWindow(first, None)
    return FaultWindow(first, max(first + 1, round((fault.start + fault.duration) / CONTROL_PERIOD)))


class FaultSchedule:
    """Begins and ends faults, period by period.

    Args:
        faults: by their numbers.
        places: what fails, by the name that faults have for it.

    Attributes:
        active: what tells the effects of the faults that act now, by their numbers.
    """

    def __init__(self, faults: Mapping[int, Fault], places: Mapping[str, FaultTarget]) -> None:
        self._faults, self._places = faults, places
        self._windows = {number: fault_window(fault) for number, fault in faults.items()}
        self.active: dict[int, Callable[[], float]] = {}

    def begin(self, period: int) -> list[tuple[int, bool]]:
        """Ends and begins what is due at the start of a control period; returns which, and whether begun."""
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
