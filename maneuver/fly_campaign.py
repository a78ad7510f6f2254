"""Campaign flights of `maneuver fly`."""

from dataclasses import replace
from pathlib import Path

from experiments.campaign.campaign_size import campaign_size
from experiments.campaign.fly_campaign import CampaignOrder, fly_campaign
from flight.mission.campaign import VehiclePopulation
from maneuver.options.executor_options import ExecutorOptions, open_executor
from maneuver.options.population import campaign_population
from scenarios.find import find_campaign
from sim.loop.specification import FlightOptions

LOST = 1


def order_campaign(
    name: str,
    *,
    counts: tuple[int | None, int | None],
    wind: str | None,
    seed: int,
    flight_options: FlightOptions,
    vehicles: VehiclePopulation | None = None,
    airframe: int | None = None,
    sensors: str | None = None,
) -> CampaignOrder:
    """Returns the order of a campaign.

    Args:
        name: or path of the campaign.
        counts: flights for the bounds and for the values; None for the campaign's.
        wind: wind class; None for the campaign's.
        seed: seed of all random numbers.
        flight_options: options of the flights.
        vehicles: population flown; None for the campaign's.
        airframe: seed of the airframe of `one`; None for the campaign's seed.
        sensors: class of the sensors; None for the campaign's.

    Raises:
        FlightError: there is no such campaign, or it is broken.
    """
    campaign = find_campaign(name)
    size = campaign_size(
        campaign, coverage=None, confidence=0.95, flights=counts[0], nominal_flights=counts[1]
    )
    return CampaignOrder(
        campaign,
        seed=seed,
        flights=size.bounding,
        nominal_flights=size.nominal,
        wind=wind or campaign.wind,
        flight_options=replace(
            flight_options,
            **campaign_population(campaign, vehicles, airframe=airframe, seed=seed, sensors=sensors),
        ),
    )


def fly_ordered_campaign(
    order: CampaignOrder, folder: Path, *, job_executor: ExecutorOptions, force: bool
) -> tuple[int, dict[str, object]]:
    """Flies the missing flights of a campaign; returns exit code and report.

    Raises:
        FlightError: the campaign cannot be flown as asked, or the folder holds something else.
    """
    with open_executor(job_executor) as executor:
        flown = fly_campaign(order, folder, job_executor=executor, force=force)
    lost = [flight.path.name for flight in flown.flights if flight.outcome != "completed"]
    result: dict[str, object] = {
        "campaign": order.campaign.name,
        "flights": len(flown.flights),
        "flight_hours": round(flown.duration / 3600, 3),
        "timeouts": sum(flight.timeouts for flight in flown.flights),
        "lost": lost,
        "logs": str(folder),
    }
    return (LOST if lost else 0), result
