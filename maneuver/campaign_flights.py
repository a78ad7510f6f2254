"""Campaigns, flown: what `fly`, `regenerate` and `demo` share."""

from concurrent.futures import Executor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from flight.campaign import Campaign
from flight.conditions import Conditions
from flight.library import Library
from identification.schedule import schedule
from sim.campaign import FlightFlown, fly_campaign
from sim.specification import PLAIN, Departure, FlightSpecification, specify_sequence

from .files import find_library
from .progress import shown

# Keys of the random streams that a seed is split into here; those of a single flight are below ten.
_SCHEDULE_STREAM = 100
_FLIGHT_STREAM = 101


@dataclass(frozen=True, slots=True)
class CampaignFlown:
    """What became of a campaign: its flights in the order of their names, and the library flown with."""

    library: Library
    flights: tuple[FlightFlown, ...]

    @property
    def duration(self) -> float:
        """Seconds of flight, all together."""
        return sum(flight.duration for flight in self.flights)


def campaign_library(campaign: Campaign, wind: str) -> Library:
    """Returns the library that the flights carry: trims, maneuvers, and the conditions fixed before."""
    conditions = Conditions(
        wind=wind,
        altitude=campaign.altitude,
        maneuver_end=campaign.rule(wind),
        trim_error_kind="instantaneous",
        coasting_range=campaign.coasting_range,
    )
    return replace(find_library(campaign.library), conditions=conditions)


def specify_campaign(
    campaign: Campaign, library: Library, *, seed: int, flights: int, wind: str
) -> tuple[FlightSpecification, ...]:
    """Returns what is flown; a flight's specification depends on the seed and its number alone."""
    tours = schedule(
        library,
        flights=flights,
        rng=np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_SCHEDULE_STREAM,))),
        coasting_range=campaign.coasting_range,
        wind=wind,
    )
    return tuple(
        specify_sequence(
            replace(tour, name=f"{campaign.name}-{number:04d}"),
            seed=derived_seed(seed, _FLIGHT_STREAM, number),
            kind="campaign",
            altitude=campaign.altitude,
        )
        for number, tour in enumerate(tours)
    )


def derived_seed(seed: int, *key: int) -> int:
    """Returns a seed of 63 bits for one flight of many, from the seed of all and the flight's place."""
    words = np.random.SeedSequence(seed, spawn_key=key).generate_state(1, np.uint64)
    return int(words[0] >> np.uint64(1))


def fly_whole_campaign(
    campaign: Campaign,
    *,
    seed: int,
    flights: int,
    wind: str,
    folder: Path,
    executor: Executor,
    force: bool,
    departure: Departure = PLAIN,
) -> CampaignFlown:
    """Flies a campaign, one log a flight in the folder.

    Raises:
        FlightError: the campaign cannot be flown as asked.
    """
    library = campaign_library(campaign, wind)
    specifications = [
        specification.depart(departure)
        for specification in specify_campaign(campaign, library, seed=seed, flights=flights, wind=wind)
    ]
    flown = fly_campaign(specifications, library, folder=folder, executor=executor, force=force)
    done = list(shown(flown, total=len(specifications), what=f"flying {campaign.name}"))
    return CampaignFlown(library, tuple(sorted(done, key=lambda flight: flight.path.name)))
