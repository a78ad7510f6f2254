"""Flight of single primitives, recorded."""

from collections.abc import Callable
from math import inf

from flight.automaton.library import Library
from flight.automaton.vehicle import Leg, Vehicle
from flight.errors import FlightLostError
from flightlog.decision import DecisionKind

from .flight_record import FlightRecorder
from .remaining_plan import PlanStep


class PrimitiveFlyer:
    """Flies primitives and records them; says why a flight ends.

    Args:
        vehicle: the vehicle.
        library: of its maneuvers.
        record: of the flight.
        on_leg: called with every flown leg that does not end the flight.

    Attributes:
        lost: whether the vehicle was lost.
    """

    def __init__(
        self,
        vehicle: Vehicle,
        library: Library,
        record: FlightRecorder,
        on_leg: Callable[[Leg], None] | None,
    ) -> None:
        self._vehicle, self._library, self._record, self._on_leg = vehicle, library, record, on_leg
        self.lost = False

    def fly(self, step: PlanStep, *, on_a_plan: bool, level: float = 0.0) -> str:
        """Flies one primitive.

        Args:
            step: the primitive.
            on_a_plan: whether an arrival counts.
            level: gamma that a decision by alarm is recorded with.

        Returns:
            The reason for the end of the flight; empty if it continues.
        """
        vehicle = self._vehicle
        try:
            if step.to_trim is None:
                leg = vehicle.coast(step.duration)
            else:
                leg = vehicle.perform(self._library.maneuver(step.trim, step.to_trim))
        except FlightLostError as error:
            self.lost = True
            self._record.add_lost_leg(step, error)
            return str(error)
        self._record.add_leg(step, leg, on_a_plan=on_a_plan)
        if leg.alarm:
            self._record.decide(vehicle.time, DecisionKind.ALARM, cost=inf, level=level)
            return f"alarm: {leg.alarm}"
        if not leg.settled:
            return f"a maneuver to trim {vehicle.trim} timed out after {leg.duration:.1f} s"
        if self._on_leg is not None:
            self._on_leg(leg)
        return ""
