"""Campaigns, flown: what `fly`, `regenerate` and `demo` share."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from flight.automaton.conditions import Conditions
from flight.automaton.library import Library
from flight.mission.campaign import Campaign
from flight.mission.sequence import Sequence
from identification.design.schedule import schedule
from identification.segmentation.flight_evidence import NOMINAL
from runtime.executor import JobExecutor
from runtime.job_store import allow_other_files, check_own_folder, complete
from scenarios.find import find_library
from sim.campaign_flight import CampaignFlight, CampaignFlightResult
from sim.loop.specification import DEFAULT_OPTIONS, FlightOptions, FlightSpecification, specify_sequence


@dataclass(frozen=True, slots=True)
class FlightRole:
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


BOUNDING = FlightRole("campaign", "", 100, 101)
CENTRING = FlightRole(NOMINAL, "-nominal", 103, 104)
TESTING = FlightRole("test", "-test", 105, 106)
INTERPOLATION_TESTING = FlightRole("test", "-grown", 109, 110)
MEASURING = FlightRole("measured", "-measured", 107, 108)


@dataclass(frozen=True, slots=True)
class CampaignResult:
    """What became of a campaign: its flights in the order of their names, and the library flown with."""

    library: Library
    flights: tuple[CampaignFlightResult, ...]

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
    campaign: Campaign, library: Library, *, seed: int, flights: int, wind: str, role: FlightRole = BOUNDING
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
    tours: Iterable[Sequence], name: str, *, seed: int, altitude: float, role: FlightRole
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


@dataclass(frozen=True, slots=True)
class CampaignOrder:
    """A campaign as it is asked for.

    Attributes:
        campaign: what is fixed before.
        seed: of all chance.
        flights: how many give the bounds.
        nominal_flights: how many others give the values of maneuvers.
        wind: wind class.
        flight_options: how the flights differ from plain ones.
    """

    campaign: Campaign
    seed: int
    flights: int
    wind: str
    nominal_flights: int = 0
    flight_options: FlightOptions = DEFAULT_OPTIONS

    def provenance(self) -> dict[str, object]:
        """Returns what a library says of the campaign that it was identified from."""
        return {
            "name": self.campaign.name,
            "seed": self.seed,
            "flights": self.flights,
            "nominal": self.nominal_flights,
        }

    def library(self) -> Library:
        """Returns the library that the flights carry."""
        return campaign_library(self.campaign, self.wind)

    def jobs(self, folder: Path) -> tuple[CampaignFlight, ...]:
        """Returns the flights with their logs in a folder.

        Raises:
            FlightError: the campaign cannot be flown as asked.
        """
        library = self.library()
        return tuple(
            CampaignFlight(
                specification.with_options(self.flight_options),
                library,
                folder / f"{specification.name}.mcap",
            )
            for role, count in ((CENTRING, self.nominal_flights), (BOUNDING, self.flights))
            for specification in specify_campaign(
                self.campaign, library, seed=self.seed, flights=count, wind=self.wind, role=role
            )
        )


def fly_campaign(
    order: CampaignOrder, folder: Path, *, job_executor: JobExecutor, force: bool = False
) -> CampaignResult:
    """Flies what is missing of a campaign, one log a flight in the folder.

    Args:
        order: what is flown.
        folder: of the logs.
        job_executor: what flies.
        force: replace logs of other flights, and leave what else is there.

    Raises:
        FlightError: the campaign cannot be flown as asked, or the folder holds something else.
    """
    check = allow_other_files if force else check_own_folder
    done = complete(
        order.jobs(folder),
        folder,
        job_executor=job_executor,
        what=f"flying {order.campaign.name}",
        check=check,
    )
    return CampaignResult(order.library(), tuple(sorted(done, key=lambda flight: flight.path.name)))
