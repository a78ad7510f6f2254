"""Planning latency in flight."""

from dataclasses import dataclass

from flight.errors import FlightError
from flight.plan.plan import Plan


class LatencyRecordError(FlightError):
    """A flight is repeated with fewer measured latencies than it has plannings."""

    def __init__(self, known: int) -> None:
        super().__init__(f"expected a recorded latency for every replan, got only {known}")


@dataclass(frozen=True, slots=True)
class Latency:
    """Seconds that the vehicle flies on while a plan is made.

    The plan starts at the state predicted after that time. A repeated flight with measured latency takes the
    latencies from the record of the first flight.

    Attributes:
        configured: seconds charged for every planning.
        measured: True if the clock decides; a plan that took longer than configured is late.
        recorded: seconds of each planning, in order, instead of the clock's; None measures them.
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
            plan: its result.

        Raises:
            LatencyRecordError: the record does not reach that far.
        """
        if self.recorded is not None:
            if number >= len(self.recorded):
                raise LatencyRecordError(len(self.recorded))
            return self.recorded[number]
        return plan.solve_time if self.measured else self.configured
