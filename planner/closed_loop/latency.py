"""Planning latency in flight."""

from dataclasses import dataclass

from flight.errors import FlightError
from flight.plan.plan import Plan


class LatencyRecordError(FlightError):
    """A flight is repeated with fewer measured latencies than it has plannings."""

    def __init__(self, known: int) -> None:
        super().__init__(f"expected a latency for every planning, got {known}")


@dataclass(frozen=True, slots=True)
class Latency:
    """Seconds that the vehicle flies on while a plan is made.

    A plan is asked for from the state predicted after that time. Measured time is no part of a flight that
    repeats, unless it is told: then it comes from the record of the flight that is repeated.

    Attributes:
        configured: seconds charged for every planning.
        measured: whether the clock is asked; a plan that took longer than configured is late.
        recorded: seconds that each planning took, in order, instead of the clock's; None asks the clock.
    """

    configured: float = 0.05
    measured: bool = False
    recorded: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        """Raises ValueError for a latency outside its range."""
        if not 0 <= self.configured <= 10:
            raise ValueError(f"latency must be between 0 and 10 s, got {self.configured} s")

    def of(self, number: int, plan: Plan) -> float:
        """Returns the planning latency from the record, the clock or the settings.

        Args:
            number: of the planning, from 0.
            plan: its answer.

        Raises:
            LatencyRecordError: the record does not reach that far.
        """
        if self.recorded is not None:
            if number >= len(self.recorded):
                raise LatencyRecordError(len(self.recorded))
            return self.recorded[number]
        return plan.solve_time if self.measured else self.configured
