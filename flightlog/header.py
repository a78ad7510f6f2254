"""Header of a flight log: inputs, code and outcome."""

from dataclasses import dataclass, replace

# Separates the two parts of a header's back-end.
_PLANS = ", plans "


@dataclass(frozen=True, slots=True)
class FlightHeader:
    """Inputs, code and outcome of a flight.

    With the attachments it suffices to repeat the flight.

    Attributes:
        kind: `sequence`, `campaign`, `mission` or `import`.
        name: name of the sequence, campaign or mission.
        vehicle: name of the vehicle.
        model_hash: SHA-256 of the vehicle's parameters and model.
        seed: seed of all random numbers of the flight.
        wind: wind class.
        code_version: version of the program and, after a `+`, digest of its code (`runtime.code_version`).
        backend: numeric back-end of the vehicle, such as `casadi-3.8.2 compiled`; with planning in flight
            also that of the search: `casadi-3.8.2 compiled, plans compiled`.
        outcome: `completed`, or the reason of the failure.
        air: mean wind, standard deviations and intensities of the wind class at the flight's height; empty
            where not known.
        vehicles: population that the vehicle was drawn from: `nominal`, `airframe SEED` or `fleet`.
        drawn: differences of the vehicle flown from the one believed, by name, SI units.
        sensors: class of the sensors; `ideal` without errors; empty where not stated.
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
    air: str = ""
    vehicles: str = "nominal"
    drawn: str = ""
    sensors: str = ""

    @property
    def release(self) -> str:
        """Version of the program without the digest of its code."""
        return self.code_version.partition("+")[0]

    @property
    def vehicle_backend(self) -> str:
        """Numeric back-end of the vehicle."""
        return self.backend.partition(_PLANS)[0]

    @property
    def search_backend(self) -> str:
        """Back-end of the plan search; empty without planning."""
        return self.backend.partition(_PLANS)[2]

    def with_search_backend(self, search: str) -> "FlightHeader":
        """Returns the header with the back-end of the plan search."""
        return replace(self, backend=f"{self.vehicle_backend}{_PLANS}{search}")

    @property
    def arithmetic(self) -> str:
        """Numeric library; its bits are the same interpreted or compiled."""
        return self.backend.partition(" ")[0]
