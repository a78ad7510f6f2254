"""The conditions that a library was found under and is meant for."""

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import Field

from flight.file_value import FileValue

from .maneuver_end import ManeuverEnd

TrimErrorKind = Literal["instantaneous", "averaged", "assumed"]


@dataclass(frozen=True)
class Conditions(FileValue):
    """Conditions under which a library's numbers hold.

    Attributes:
        wind: wind class, such as `gtmax`; `not stated` for a library from a book.
        altitude: metres above ground; None where not stated.
        maneuver_end: the rule by which maneuvers were ended; None where not stated.
        trim_error_kind: kind of trim errors: instantaneous deviations, averages over a coast, or assumed.
        coasting_range: shortest and longest coast flown, seconds; None where not stated.
        vehicle_hash: SHA-256 of the parameters of the vehicle that flew; None where not stated.
        speed_range: lowest and highest forward speed commanded, metres per second; None where not stated.
        entry_trims: ids of the trims that were held and left by maneuvers; None where not stated.
        air: mean wind, standard deviations and intensities at the altitude; None where not stated.
        vehicles: population that flew: `nominal`, `airframe SEED` or `fleet`; None where not stated.
        sensors: class of the sensors that flew; None where not stated.
    """

    wind: str = "not stated"
    altitude: Annotated[float | None, Field(description="metres above ground")] = None
    maneuver_end: ManeuverEnd | None = None
    trim_error_kind: TrimErrorKind = "assumed"
    coasting_range: Annotated[
        tuple[float, float] | None, Field(description="shortest and longest coast flown, seconds")
    ] = None
    vehicle_hash: Annotated[str | None, Field(description="SHA-256 of the vehicle's parameters")] = None
    speed_range: Annotated[
        tuple[float, float] | None,
        Field(description="lowest and highest forward speed commanded, metres per second"),
    ] = None
    entry_trims: Annotated[
        tuple[int, ...] | None, Field(description="trims left by maneuvers that were flown")
    ] = None
    air: Annotated[str | None, Field(description="mean wind and gusts at the altitude")] = None
    vehicles: Annotated[
        str | None, Field(description="population that flew: nominal, airframe SEED or fleet")
    ] = None
    sensors: Annotated[str | None, Field(description="class of the sensors that flew")] = None

    @property
    def future_flights(self) -> str:
        """Population that a claim of coverage is for, in words."""
        match (self.vehicles or "").partition(" ")[0]:
            case "nominal":
                return "future flights of the vehicle exactly as modelled"
            case "airframe":
                return "future flights of this airframe"
            case "fleet":
                return "future flights of airframes like these"
            case _:
                return "future flights"
