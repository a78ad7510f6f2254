"""How many flights a campaign takes, said before the first of them."""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time

from flight.campaign import Campaign
from flight.errors import FlightError
from flight.library import Library
from flight.log_file import publish_log
from identification.bounds import joint_coverage, samples_needed
from identification.samples import MANEUVER_SCALARS, TRIM_SCALARS
from sim.campaign import fly_specification
from sim.specification import FlightSpecification

from .campaign_flights import MEASURING, campaign_library, specify_campaign
from .evidence import evidence_of


@dataclass(frozen=True, slots=True)
class CampaignSize:
    """How many flights, and what they may promise when no maneuver fails to settle.

    Attributes:
        bounding: flights that give the bounds.
        nominal: others, that give the values of maneuvers; 0 where the same flights give both.
        confidence: of the coverage.
    """

    bounding: int
    nominal: int
    confidence: float

    @property
    def flights(self) -> int:
        """All flights."""
        return self.bounding + self.nominal

    @property
    def maneuver_support(self) -> int:
        """Numbers fitted to a maneuver's samples."""
        return len(MANEUVER_SCALARS) * (1 if self.nominal else 2)

    def said(self) -> str:
        """Returns for people what the flights are for and what they promise."""
        claims = [
            joint_coverage(self.bounding, support=support, confidence=self.confidence)
            for support in (len(TRIM_SCALARS), self.maneuver_support)
        ]
        values = f"{self.nominal} others give their values" if self.nominal else "the same give their values"
        return (
            f"{self.bounding} flights give the bounds, {values}: with {self.confidence:.0%} confidence the "
            f"bounds of a trim hold {claims[0]:.1%} of future flights, of a maneuver {claims[1]:.1%}, "
            "all numbers at once"
        )


def campaign_size(
    campaign: Campaign,
    *,
    coverage: float | None,
    confidence: float,
    flights: int | None,
    nominal_flights: int | None,
) -> CampaignSize:
    """Returns how many flights are flown: as many as asked for, as a coverage takes, or the campaign's.

    Args:
        campaign: its own numbers stand in where nothing is asked.
        coverage: share of future flights to be covered, all numbers of a primitive at once.
        confidence: of that share.
        flights: number asked for.
        nominal_flights: number of flights for the values of maneuvers.

    Raises:
        FlightError: coverage or confidence is no share, or both a coverage and a number of flights are given.
    """
    for name, value in (("coverage", coverage), ("confidence", confidence)):
        if value is not None and not 0 < value < 1:
            raise FlightError(f"--{name} must be between 0 and 1, got {value}")
    if coverage is not None and flights is not None:
        raise FlightError("--coverage says how many flights: give it or --flights, not both")
    own_values = campaign.nominal_flights if flights is None else 0
    nominal = own_values if nominal_flights is None else nominal_flights
    if coverage is None:
        return CampaignSize(flights or campaign.flights, nominal, confidence)
    support = CampaignSize(0, nominal, confidence).maneuver_support
    return CampaignSize(samples_needed(coverage, support=support, confidence=confidence), nominal, confidence)


@dataclass(frozen=True, slots=True)
class Forecast:
    """What a campaign will take, judged from one flight of it.

    Attributes:
        flight_hours: of all flights.
        minutes: on this machine.
        speed: flight time over processor time of the flight measured, flying, logging and identifying.
    """

    flight_hours: float
    minutes: float
    speed: float

    def said(self) -> str:
        """Returns the forecast for people."""
        return (
            f"about {self.flight_hours:.1f} flight hours and {self.minutes:.1f} minutes here "
            f"(one flight took 1/{self.speed:.0f} of its time)"
        )


def forecast(campaign: Campaign, *, wind: str, seed: int, flights: int, workers: int) -> Forecast:
    """Flies one flight that is not of the campaign, twice, and judges the whole from the second.

    The first time pays for what is built once in each worker.

    Args:
        campaign: what is to be flown.
        wind: wind class.
        seed: of the campaign.
        flights: how many.
        workers: processes that share them.
    """
    library = campaign_library(campaign, wind)
    (specification,) = specify_campaign(campaign, library, seed=seed, flights=1, wind=wind, role=MEASURING)
    short = specification.model_copy(
        update={"trims": specification.trims[:2], "coasting_times": specification.coasting_times[:2]}
    )
    began = perf_counter()
    _flown_and_identified(short, library)
    building = perf_counter() - began
    began, worked = perf_counter(), process_time()
    duration = _flown_and_identified(specification, library)
    took = max(perf_counter() - began, process_time() - worked)
    return Forecast(
        flight_hours=flights * duration / 3600,
        minutes=(building + took * -(-flights // workers)) / 60,
        speed=duration / took,
    )


def _flown_and_identified(specification: FlightSpecification, library: Library) -> float:
    """Returns the seconds flown of a flight that leaves nothing behind."""
    log = fly_specification(specification, library)
    with TemporaryDirectory(prefix="maneuver-") as folder:
        path = Path(folder) / f"{specification.name}.mcap"
        publish_log(log, path, force=False)
        evidence_of(path)
    return log.duration
