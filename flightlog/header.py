"""The header of a flight log: what was flown, by what, and what came of it."""

from dataclasses import dataclass, replace

# Between the two parts of a header's back-end.
_PLANS = ", plans "


@dataclass(frozen=True, slots=True)
class FlightHeader:
    """What was flown, by what: enough, with the attachments, to repeat the flight.

    Attributes:
        kind: `sequence`, `campaign`, `mission` or `import`.
        name: of the sequence, campaign or mission.
        vehicle: what flew.
        model_hash: SHA-256 of the vehicle's parameters and model.
        seed: of every random number of the flight.
        wind: wind class.
        code_version: version of this program; after a `+`, of its code (`runtime.code_version`).
        backend: what evaluated the vehicle's expressions, and how: `casadi-3.8.2 compiled`; where it was
            planned in flight, how plans were searched for too: `casadi-3.8.2 compiled, plans compiled`.
        outcome: `completed`, or what went wrong.
    """

    kind: str
    name: str
    vehicle: str
    model_hash: str
    seed: int
    wind: str
    code_version: str
    backend: str
    outcome: str = "completed"

    @property
    def release(self) -> str:
        """Version of the program, without that of its code."""
        return self.code_version.partition("+")[0]

    @property
    def vehicle_backend(self) -> str:
        """What evaluated the vehicle's expressions, and how."""
        return self.backend.partition(_PLANS)[0]

    @property
    def search_backend(self) -> str:
        """How plans were searched for; empty where none were."""
        return self.backend.partition(_PLANS)[2]

    def with_search_backend(self, search: str) -> "FlightHeader":
        """Returns the header of a flight that was planned as it flew."""
        return replace(self, backend=f"{self.vehicle_backend}{_PLANS}{search}")

    @property
    def arithmetic(self) -> str:
        """What evaluated the expressions; interpreted or compiled it gives the same bits."""
        return self.backend.partition(" ")[0]
