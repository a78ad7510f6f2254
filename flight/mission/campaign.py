"""Identification campaign: automaton, number of flights, wind, maneuver-end rule."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal, get_args

from pydantic import NonNegativeInt, PositiveFloat, PositiveInt

from flight.automaton.maneuver_end import ManeuverEnd
from flight.errors import FlightError
from flight.file_value import FileValue, Omittable, Share
from flight.schema import read_toml, schema_named

SCHEMA = "maneuver-campaign/1"
"""Schema name that a file may state; without one it is of this version."""

VehiclePopulation = Literal["nominal", "one", "fleet"]
"""Vehicles flown: the one believed, one airframe, an airframe for each flight."""

DEFAULT_SENSORS = "rtk"
"""Class of the sensors where a file names none."""


class NoRuleForWindError(FlightError):
    """A campaign fixes no maneuver-end rule for a wind class."""

    def __init__(self, campaign: str, wind: str, known: Mapping[str, object]) -> None:
        super().__init__(f"campaign {campaign} has no maneuver_end for wind {wind!r}; it has {sorted(known)}")


@dataclass(frozen=True)
class Campaign(FileValue):
    """Settings of a campaign, fixed before its first flight.

    Attributes:
        schema: of its file, which need not say.
        name: short name.
        library: name or path of the library that names the trims and the maneuvers.
        wind: wind class.
        altitude: metres above ground.
        flights: number of flights for the bounds.
        nominal_flights: number of other flights for the values of maneuvers; 0 for the same flights.
        without_coast: share of trims left at once; the other coasts are then short ones more often.
        coasting_range: shortest and longest coasting time, seconds.
        maneuver_end: the rule, by wind class.
        vehicles: population flown; empty for the nominal vehicle.
        sensors: class of the sensors; empty for `rtk`.
    """

    schema: Annotated[Omittable[str], schema_named(SCHEMA)] = field(init=False, default=SCHEMA, repr=False)
    name: str
    library: str
    wind: str
    altitude: PositiveFloat
    flights: PositiveInt
    coasting_range: tuple[float, float]
    maneuver_end: Mapping[str, ManeuverEnd]
    nominal_flights: Omittable[NonNegativeInt] = 0
    without_coast: Omittable[Share] = 0.0
    vehicles: Omittable[str] = ""
    sensors: Omittable[str] = ""

    def __post_init__(self) -> None:
        """Refuses an unknown population, and coasting times in the wrong order."""
        if self.vehicles and self.vehicles not in get_args(VehiclePopulation):
            known = ", ".join(get_args(VehiclePopulation))
            raise ValueError(f"vehicles: expected one of {known}, got {self.vehicles!r}")
        shortest, longest = self.coasting_range
        if not 0 <= shortest <= longest:
            raise ValueError(
                f"coasting_range: expected 0 <= shortest <= longest, got {self.coasting_range} s"
            )

        if self.without_coast == 1:
            raise ValueError("without_coast: expected less than 1, some trims must be held, got 1")

    def rule(self, wind: str) -> ManeuverEnd:
        """Returns the maneuver-end rule for a wind class.

        Raises:
            NoRuleForWindError: the campaign fixes none.
        """
        try:
            return self.maneuver_end[wind]
        except KeyError:
            raise NoRuleForWindError(self.name, wind, self.maneuver_end) from None


def read_campaign(path: Path) -> Campaign:
    """Reads `campaigns/NAME.toml`.

    Raises:
        BadFileError: the file is missing, is no TOML, or lacks or misnames a part.
    """
    return read_toml(path, Campaign)
