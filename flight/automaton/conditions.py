"""The conditions that a library was found under and is meant for."""

from dataclasses import dataclass
from typing import Literal

from .maneuver_end import ManeuverEnd

TrimErrorKind = Literal["instantaneous", "averaged", "assumed"]


@dataclass(frozen=True)
class Conditions:
    """Where a library's numbers hold.

    Attributes:
        wind: wind class, such as `gtmax`; `not stated` for a library from a book.
        altitude: metres above ground; None where not stated.
        maneuver_end: the rule by which maneuvers were ended; None where not stated.
        trim_error_kind: whether trim errors are instantaneous deviations, averages over a coast, or assumed.
        coasting_range: shortest and longest coast flown, seconds; None where not stated.
        vehicle_hash: SHA-256 of the parameters of the vehicle that flew; None where not stated.
        speed_range: lowest and highest forward speed commanded, metres per second; None where not stated.
        entry_trims: ids of the trims that were held and left by maneuvers; None where not stated.
    """

    wind: str = "not stated"
    altitude: float | None = None
    maneuver_end: ManeuverEnd | None = None
    trim_error_kind: TrimErrorKind = "assumed"
    coasting_range: tuple[float, float] | None = None
    vehicle_hash: str | None = None
    speed_range: tuple[float, float] | None = None
    entry_trims: tuple[int, ...] | None = None
