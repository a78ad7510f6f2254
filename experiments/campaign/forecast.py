"""What a campaign will take on this machine, said before it is flown."""

from concurrent.futures import Executor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

from flight.automaton.library import Library
from flight.mission.campaign import Campaign
from flightlog.file.writer import write_log
from identification.identify import identify
from identification.segmentation.flight_evidence import FlightEvidence
from identification.statistics.samples import NeverFlownError
from runtime.executor import worker_pool
from sim.campaign_flight import fly_specification
from sim.loop.specification import FlightSpecification

from .evidence import evidence_of
from .fly_campaign import MEASURING, campaign_library, specify_campaign

# Each worker is measured by one flight, and one more for every so many that it has to fly; three at most.
_FLIGHTS_PER_ROUND, _MOST_ROUNDS = 30, 3


@dataclass(frozen=True, slots=True)
class Forecast:
    """What a campaign will take, judged from flights like its own.

    Attributes:
        flight_hours: of all flights.
        minutes: on this machine.
        measured: flights that it is judged from.
        speed: flight time over the time that it took with all workers busy: flying, logging, identifying.
    """

    flight_hours: float
    minutes: float
    measured: int
    speed: float

    def describe(self) -> str:
        """Returns the forecast for people."""
        return (
            f"about {self.flight_hours:.1f} flight hours and {self.minutes:.1f} minutes here "
            f"({self.measured} flights like these went {self.speed:.0f} times as fast as they last)"
        )


def forecast_campaign(campaign: Campaign, *, wind: str, seed: int, flights: int, workers: int) -> Forecast:
    """Flies a few flights, none of them the campaign's, and judges the whole from them.

    Args:
        campaign: what is to be flown.
        wind: wind class.
        seed: of the campaign.
        flights: how many.
        workers: processes that share them.
    """
    began = perf_counter()
    with worker_pool(workers) as executor:
        return forecast_with_executor(
            executor, campaign, wind=wind, seed=seed, flights=flights, workers=workers, began=began
        )


def forecast_with_executor(
    executor: Executor,
    campaign: Campaign,
    *,
    wind: str,
    seed: int,
    flights: int,
    workers: int,
    began: float,
) -> Forecast:
    """Returns the forecast from as many flights at once as there are workers.

    Each worker first flies a short one, which pays for what is built once in each, as the campaign will pay
    again. What is measured then is what happens to every flight: it is flown, written, read again, cut,
    handed back and identified, while the other workers do the same.

    Args:
        executor: lends the workers.
        campaign: what is to be flown.
        wind: wind class.
        seed: of the campaign.
        flights: how many.
        workers: processes that share them.
        began: when the executor was asked for them, by `perf_counter`.
    """
    library = campaign_library(campaign, wind)
    rounds = min(_MOST_ROUNDS, 1 + flights // (_FLIGHTS_PER_ROUND * workers))
    specifications = specify_campaign(
        campaign, library, seed=seed, flights=rounds * workers, wind=wind, role=MEASURING
    )
    fly = partial(_fly_and_cut, library=library)
    list(executor.map(fly, [_shorten(one) for one in specifications[:workers]]))
    ready = perf_counter()
    cut = list(executor.map(fly, specifications))
    # So few flights may not show each maneuver to its end; the time that was taken counts all the same.
    with suppress(NeverFlownError):
        identify(cut, name=campaign.name)
    took, flown = perf_counter() - ready, sum(flight.duration for flight in cut)
    share = flights / len(cut)
    return Forecast(
        flight_hours=share * flown / 3600,
        minutes=(ready - began + share * took) / 60,
        measured=len(cut),
        speed=flown / took,
    )


def _shorten(specification: FlightSpecification) -> FlightSpecification:
    return specification.model_copy(
        update={"trims": specification.trims[:2], "coasting_times": specification.coasting_times[:2]}
    )


def _fly_and_cut(specification: FlightSpecification, library: Library) -> FlightEvidence:
    """Returns what identification keeps of a flight that leaves nothing else behind."""
    log = fly_specification(specification, library)
    with TemporaryDirectory(prefix="maneuver-") as folder:
        path = Path(folder) / f"{specification.name}.mcap"
        write_log(log, path, force=False)
        return evidence_of(path)
