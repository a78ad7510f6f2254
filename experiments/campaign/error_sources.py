"""Study of error sources: campaigns with one each, and with all."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass
from functools import partial
from statistics import median

import numpy as np

from flight.automaton.library import Library
from flight.mission.campaign import Campaign, VehiclePopulation
from identification.design.schedule import schedule
from identification.segmentation.flight_evidence import FlightEvidence, extract_evidence
from identification.statistics.samples import MANEUVER_SCALARS, TRIM_SCALARS
from identification.statistics.variance_shares import ScalarVariance, source_shares, variances_of
from runtime.progress import show_progress
from sim.campaign_flight import fly_specification
from sim.loop.specification import FlightOptions, FlightSpecification
from sim.navigation.sensor_errors import NOISE, SYSTEMATIC

from .fly_campaign import FlightRole, campaign_library, specify_tours

ALL = "all"
REPETITIONS = 2
"""Performances of each maneuver in a flight: two show what they share."""

_STUDYING = FlightRole("study", "-sources", 111, 112)


@dataclass(frozen=True, slots=True)
class ErrorSources:
    """Variances of every scalar by source.

    Attributes:
        campaign: name of the campaign.
        wind: wind class.
        vehicles: population of the vehicles.
        sensors: class of the sensors.
        flights: number of flights of each source.
        seed: seed of all random numbers.
        variances: by source: `wind`, `noise`, `vehicle`, `sensor`, `all`.
    """

    campaign: str
    wind: str
    vehicles: str
    sensors: str
    flights: int
    seed: int
    variances: Mapping[str, Sequence[ScalarVariance]]

    def document(self) -> dict[str, object]:
        """Returns the study as plain JSON values."""
        rows = {
            source: [
                {"primitive": row.primitive, "scalar": row.scalar, **asdict(row.variance)} for row in rows
            ]
            for source, rows in self.variances.items()
        }
        names = ("campaign", "wind", "vehicles", "sensors", "flights", "seed")
        return {**{name: getattr(self, name) for name in names}, "variances": rows}

    def markdown(self) -> str:
        """Returns the medians over primitives as a Markdown table."""
        shares = source_shares({name: rows for name, rows in self.variances.items() if name != ALL})
        sources = [name for name in self.variances if name != ALL]
        head = ["scalar", *(f"{name}, %" for name in sources), "shared by a flight, %", "largest, %"]
        lines = [head, ["---"] * len(head)]
        for kind, scalars in (("trim", TRIM_SCALARS), ("maneuver", MANEUVER_SCALARS)):
            for scalar in scalars:
                parts = [part for key, part in shares.items() if key[0].startswith(kind) and key[1] == scalar]
                common = [
                    row.variance.share
                    for row in self.variances[ALL]
                    if row.primitive.startswith(kind) and row.scalar == scalar
                ]
                cells = [f"{100 * median(part[name] for part in parts):.0f}" for name in sources]
                lines.append(
                    [
                        f"{kind}, {scalar}",
                        *cells,
                        f"{100 * median(common):.0f}",
                        f"{100 * max(common):.0f}",
                    ]
                )
        table = "\n".join(f"| {' | '.join(line)} |" for line in lines)
        return (
            f"## Sources of error\n\nCampaign {self.campaign}, wind {self.wind}, vehicles {self.vehicles}, "
            f"sensors {self.sensors}: {self.flights} flights with each source alone and with all, each "
            f"maneuver {REPETITIONS} times a flight, seed {self.seed}. Shares of the summed variances of the "
            "sources, and share of the variance with all that is between flights (one-way random effects); "
            "medians over "
            f"the primitives.\n\n{table}\n"
        )


def study_sources(
    campaign: Campaign,
    *,
    vehicles: VehiclePopulation,
    airframe_seed: int | None,
    sensors: str,
    flights: int,
    seed: int,
    executor: Executor,
) -> ErrorSources:
    """Flies a campaign with each source of error alone, and with all.

    Wind, schedule, white noise and vehicle are drawn alike in each campaign that has them.

    Args:
        campaign: trims, maneuvers, wind and rule.
        vehicles: population of the vehicles.
        airframe_seed: seed of the airframe of `one`.
        sensors: class of the sensors.
        flights: number of flights of each source.
        seed: seed of all random numbers.
        executor: executor of the flights.

    Raises:
        TooFewRepetitionsError: too few flights.
    """
    library = campaign_library(campaign, campaign.wind)
    drawn = {"vehicles": vehicles, "airframe_seed": airframe_seed}
    sources = {
        "wind": (campaign.wind, FlightOptions(ideal_navigation=True)),
        "noise": ("calm", FlightOptions(sensors=f"{sensors}-{NOISE}")),
        "vehicle": ("calm", FlightOptions(ideal_navigation=True, **drawn)),  # type: ignore[arg-type]
        "sensor": ("calm", FlightOptions(sensors=f"{sensors}-{SYSTEMATIC}")),
        ALL: (campaign.wind, FlightOptions(sensors=sensors, **drawn)),  # type: ignore[arg-type]
    }
    tours = schedule(
        library,
        flights=flights,
        rng=np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(_STUDYING.schedule_stream,))),
        coasting_range=campaign.coasting_range,
        wind=campaign.wind,
        repetitions=REPETITIONS,
    )
    plain = specify_tours(tours, campaign.name, seed=seed, altitude=campaign.altitude, role=_STUDYING)
    ordered = [
        flight.with_options(options).model_copy(update={"wind": wind})
        for wind, options in sources.values()
        for flight in plain
    ]
    cut = list(
        show_progress(
            executor.map(partial(_fly_and_cut, library=library), ordered),
            total=len(ordered),
            what=f"sources of error of {campaign.name}",
        )
    )
    by_source = zip(sources, (cut[at : at + flights] for at in range(0, len(cut), flights)), strict=True)
    population = sources[ALL][1].population
    return ErrorSources(
        campaign.name,
        campaign.wind,
        population,
        sensors,
        flights,
        seed,
        {name: variances_of(rows) for name, rows in by_source},
    )


def _fly_and_cut(specification: FlightSpecification, library: Library) -> FlightEvidence:
    log = fly_specification(specification, library)
    return extract_evidence(log, name=specification.name, sha256=f"seed {specification.seed}")
