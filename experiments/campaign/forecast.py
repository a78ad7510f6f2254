"""Forecast of a campaign's duration on this machine."""

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

# Test flights per worker: one, and one more for every `_FLIGHTS_PER_ROUND` flights per worker; at most three.
_FLIGHTS_PER_ROUND, _MOST_ROUNDS = 30, 3


@dataclass(frozen=True, slots=True)
class Forecast:
    """Forecast of a campaign from similar flights.

    Attributes:
        flight_hours: total flight hours.
        minutes: minutes on this machine.
        measured: number of flights measured.
        speed: flight time over computing time with all workers busy: flying, logging, identifying.
    """

    flight_hours: float
    minutes: float
    measured: int
    speed: float

    def describe(self) -> str:
        """Returns the forecast in one sentence."""
        return (
            f"about {self.flight_hours:.1f} flight hours, {self.minutes:.1f} minutes on this machine "
            f"({self.measured} test flights ran {self.speed:.0f} times as fast as real time)"
        )


def forecast_campaign(campaign: Campaign, *, wind: str, seed: int, flights: int, workers: int) -> Forecast:
    """Forecasts a campaign from a few other flights.

    Args:
        campaign: the campaign.
        wind: wind class.
        seed: seed of the campaign.
        flights: number of flights.
        workers: number of processes.
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
    """Forecasts a campaign from flights in all workers at once.

    Each worker first flies a short flight, which covers the set-up that the campaign pays again. Then every
    step of a flight is measured with all workers busy: it is flown, written, read, segmented, returned and
    identified.

    Args:
        executor: executor with the workers.
        campaign: the campaign.
        wind: wind class.
        seed: seed of the campaign.
        flights: number of flights.
        workers: number of processes.
        began: time when the executor was started, by `perf_counter`.
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
    # So few flights may lack settled maneuvers; their time counts all the same.
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
    """Returns the evidence of a flight whose log is temporary."""
    log = fly_specification(specification, library)
    with TemporaryDirectory(prefix="maneuver-") as folder:
        path = Path(folder) / f"{specification.name}.mcap"
        write_log(log, path, force=False)
        return evidence_of(path)
