"""Campaign flights for `fly`, `regenerate` and `demo`."""

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
from sim.wind.flyable import check_flyable


@dataclass(frozen=True, slots=True)
class FlightRole:
    """Purpose of flights, with its own random streams for wind and schedule.

    Attributes:
        kind: kind in the flights' headers.
        suffix: suffix of the campaign's name in the flights' names.
        schedule_stream: key of the schedule's random stream; keys of a flight's own streams are below ten.
        flight_stream: key of the streams of the flights' seeds.
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
    """A campaign's library and its flights, sorted by name."""

    library: Library
    flights: tuple[CampaignFlightResult, ...]

    @property
    def duration(self) -> float:
        """Total flight time in seconds."""
        return sum(flight.duration for flight in self.flights)


def campaign_library(campaign: Campaign, wind: str) -> Library:
    """Returns the flights' library: trims, maneuvers, prescribed conditions."""
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
    """Returns the flights, each determined by seed, role and number alone."""
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
    """Returns a flight per tour, determined by seed, role and number alone."""
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
    """Returns a 63-bit seed derived from a seed and a key."""
    words = np.random.SeedSequence(seed, spawn_key=key).generate_state(1, np.uint64)
    return int(words[0] >> np.uint64(1))


@dataclass(frozen=True, slots=True)
class CampaignOrder:
    """Order of a campaign.

    Attributes:
        campaign: the campaign's definition.
        seed: seed of all random numbers.
        flights: number of flights for the bounds.
        nominal_flights: number of other flights for the values of maneuvers.
        wind: wind class.
        flight_options: options of the flights.
    """

    campaign: Campaign
    seed: int
    flights: int
    wind: str
    nominal_flights: int = 0
    flight_options: FlightOptions = DEFAULT_OPTIONS

    def provenance(self) -> dict[str, object]:
        """Returns the campaign's entry in a library's provenance."""
        return {
            "name": self.campaign.name,
            "seed": self.seed,
            "flights": self.flights,
            "nominal": self.nominal_flights,
            "vehicles": self.flight_options.population,
            "sensors": self.flight_options.sensors,
        }

    def library(self) -> Library:
        """Returns the library attached to the flights."""
        return campaign_library(self.campaign, self.wind)

    def jobs(self, folder: Path) -> tuple[CampaignFlight, ...]:
        """Returns the flights with their logs in a folder.

        Raises:
            FlightError: the campaign cannot be flown as ordered.
        """
        library = self.library()
        check_flyable(self.wind, library, height=self.campaign.altitude)
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
    """Flies the missing flights of a campaign, one log each.

    Args:
        order: order of the campaign.
        folder: folder of the logs.
        job_executor: executor of the flights.
        force: replace logs of other flights, and keep other files.

    Raises:
        FlightError: the campaign cannot be flown as ordered, or the folder has other files.
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
