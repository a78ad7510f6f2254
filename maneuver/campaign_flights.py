"""Campaigns, flown: what `fly`, `regenerate` and `demo` share."""

from collections.abc import Iterable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from flight.campaign import Campaign
from flight.conditions import Conditions
from flight.library import Library
from flight.sequence import Sequence
from identification.flight_evidence import NOMINAL
from identification.schedule import schedule
from sim.campaign import FlightFlown, fly_campaign
from sim.specification import PLAIN, Departure, FlightSpecification, specify_sequence

from .files import find_library
from .progress import shown


@dataclass(frozen=True, slots=True)
class Role:
    """What flights are for; each role has air and schedules of its own, whatever the seed.

    Attributes:
        kind: in the flights' headers.
        suffix: of the campaign's name, in the flights' names.
        schedule_stream: key of the random stream that orders the flights; those of a flight are below ten.
        flight_stream: key of the streams that the flights' seeds come from.
    """

    kind: str
    suffix: str
    schedule_stream: int
    flight_stream: int


BOUNDING = Role("campaign", "", 100, 101)
CENTRING = Role(NOMINAL, "-nominal", 103, 104)
TESTING = Role("test", "-test", 105, 106)
GROWN_TESTING = Role("test", "-grown", 109, 110)
MEASURING = Role("measured", "-measured", 107, 108)


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
    campaign: Campaign, library: Library, *, seed: int, flights: int, wind: str, role: Role = BOUNDING
) -> tuple[FlightSpecification, ...]:
    """Returns what is flown; a flight depends on the seed, its role and its number alone."""
    tours = schedule(
        library,
        flights=flights,
        rng=np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(role.schedule_stream,))),
        coasting_range=campaign.coasting_range,
        wind=wind,
    )
    return specify_tours(tours, campaign.name, seed=seed, altitude=campaign.altitude, role=role)


def specify_tours(
    tours: Iterable[Sequence], name: str, *, seed: int, altitude: float, role: Role
) -> tuple[FlightSpecification, ...]:
    """Returns a flight for each tour, in air that depends on the seed, the role and its number alone."""
    return tuple(
        specify_sequence(
            replace(tour, name=f"{name}{role.suffix}-{number:04d}"),
            seed=derived_seed(seed, role.flight_stream, number),
            kind=role.kind,
            altitude=altitude,
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
    nominal_flights: int = 0,
    wind: str,
    folder: Path,
    executor: Executor,
    force: bool,
    departure: Departure = PLAIN,
) -> CampaignFlown:
    """Flies a campaign, one log a flight in the folder.

    Args:
        campaign: what is fixed before.
        seed: of all chance.
        flights: how many give the bounds.
        nominal_flights: how many others give the values of maneuvers.
        wind: wind class.
        folder: of the logs.
        executor: runs the flights.
        force: overwrite logs.
        departure: how the flights differ from plain ones.

    Raises:
        FlightError: the campaign cannot be flown as asked.
    """
    library = campaign_library(campaign, wind)
    specifications = [
        specification.depart(departure)
        for role, count in ((CENTRING, nominal_flights), (BOUNDING, flights))
        for specification in specify_campaign(
            campaign, library, seed=seed, flights=count, wind=wind, role=role
        )
    ]
    flown = fly_campaign(specifications, library, folder=folder, executor=executor, force=force)
    done = list(shown(flown, total=len(specifications), what=f"flying {campaign.name}"))
    return CampaignFlown(library, tuple(sorted(done, key=lambda flight: flight.path.name)))
