"""Vehicles and sensors of flights, by options and files."""

from typing import Any, cast

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.campaign import DEFAULT_SENSORS, Campaign, VehiclePopulation
from sim.navigation.sensor_errors import sensor_errors
from sim.population import IDEAL


class AirframeNotFlownError(FlightError):
    """Airframe named for vehicles that are not of one airframe."""

    def __init__(self, vehicles: str) -> None:
        super().__init__(f"--airframe: expected --vehicles one, got vehicles {vehicles!r}")


def campaign_population(
    campaign: Campaign,
    vehicles: VehiclePopulation | None,
    *,
    airframe: int | None,
    seed: int,
    sensors: str | None,
) -> dict[str, Any]:
    """Returns fields of `FlightOptions` for a campaign's flights.

    Args:
        campaign: states population and sensors where the options do not.
        vehicles: population; None for the campaign's.
        airframe: seed of the airframe of `one`; None for the campaign's seed.
        seed: of the campaign.
        sensors: class of the sensors; None for the campaign's.

    Raises:
        FlightError: an airframe is named for another population, or there is no such class.
    """
    stated = cast(VehiclePopulation, campaign.vehicles or "nominal")
    known = vehicles or stated
    number = seed if airframe is None else airframe
    return _population(known, airframe, number, sensors or campaign.sensors or DEFAULT_SENSORS)


def library_population(
    library: Library,
    vehicles: VehiclePopulation | None,
    *,
    airframe: int | None,
    seed: int,
    sensors: str | None,
) -> dict[str, Any]:
    """Returns fields of `FlightOptions` for flights with a library.

    Args:
        library: states the population that it was identified from, and so its airframe.
        vehicles: population; None for the library's.
        airframe: seed of the airframe of `one`; None for the library's, else the flights' seed.
        seed: of the flights.
        sensors: class of the sensors; None for the library's.

    Raises:
        FlightError: an airframe is named for another population, or there is no such class.
    """
    kind, _, number = (library.conditions.vehicles or "nominal").partition(" ")
    stated: VehiclePopulation = "one" if number else "fleet" if kind == "fleet" else "nominal"
    known = vehicles or stated
    own = int(number) if number else seed
    flown = library.conditions.sensors
    usual = DEFAULT_SENSORS if flown in {None, IDEAL} else flown
    return _population(known, airframe, own if airframe is None else airframe, sensors or usual)


def _population(
    vehicles: VehiclePopulation, airframe: int | None, number: int, sensors: str
) -> dict[str, Any]:
    if airframe is not None and vehicles != "one":
        raise AirframeNotFlownError(vehicles)
    sensor_errors(sensors)
    return {
        "vehicles": vehicles,
        "airframe_seed": number if vehicles == "one" else None,
        "sensors": sensors,
    }
