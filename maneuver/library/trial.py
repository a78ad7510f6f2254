"""`maneuver library test`: test of a library's coverage claim on new flights."""

import json as json_module
import sys
from collections.abc import Iterable
from concurrent.futures import Executor
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from experiments.campaign.evidence import gather_evidence, log_paths
from experiments.campaign.fly_campaign import TESTING, specify_campaign
from experiments.campaign.interpolation_flights import (
    EMPTY_SAMPLE,
    SAMPLE,
    all_interpolated,
    claimed_flight_count,
    judge_interpolated,
    sampled_flights,
)
from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from flight.errors import FlightError
from flight.mission.campaign import Campaign, VehiclePopulation
from flight.plural import plural
from identification.coverage_trial import CoverageTrial, NoClaimError, coverage_trials
from identification.design.interpolation_schedule import PrimitiveSample
from identification.segmentation.flight_evidence import FlightEvidence, StateJudged, extract_evidence
from maneuver.options.domain_warnings import warn_of_flight, warn_of_logs
from maneuver.options.numbers import Count, Seed
from maneuver.options.population import library_population
from runtime.executor import default_workers, worker_pool
from runtime.progress import show_progress
from scenarios.find import find_library
from sim.campaign_flight import fly_specification
from sim.loop.specification import DEFAULT_ALTITUDE, FlightOptions, FlightSpecification

REFUTED = 1

FLIGHTS = 100
"""New flights by default."""


def run_trial(
    library: str,
    /,
    *,
    flights: Count | None = None,
    sample: Count = SAMPLE,
    seed: Seed = 1,
    wind: str | None = None,
    vehicles: VehiclePopulation | None = None,
    airframe: Seed | None = None,
    sensors: str | None = None,
    logs: Annotated[list[Path] | None, Parameter(consume_multiple=True, negative="")] = None,
    workers: Count | None = None,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Tests a library's coverage claim on new flights.

    A flight is inside the bounds of a primitive if all its numbers are. Wind and schedules of the new flights
    differ from those of every campaign, for any seed. The table lists for each primitive the share of flights
    inside, its exact 95 % interval, and the p-value of the claim, corrected for the number of primitives
    (Holm). The exit code is 1 if a claim is refuted at 5 %.

    For an interpolated library, a random sample of interpolated maneuvers and of the trims that they lead to
    is flown. The share of them with every flight inside is compared with the claim for each kind.

    For example:

        maneuver library test gtmax-sim --flights 500

        maneuver library test mine.json --logs other-flights/ --json

        maneuver library test interpolated.json --sample 60

    Args:
        library: name or path of the library.
        flights: number of new flights; 100 by default, for an interpolated library the number of its claim.
        sample: number of trims, and of maneuvers, drawn from an interpolated library.
        seed: seed of all random numbers.
        wind: wind class; the library's by default.
        vehicles: vehicle flown: `nominal`, `one` drawn airframe or a `fleet`; the library's by default.
        airframe: seed of the airframe of --vehicles one; the library's, or --seed, by default.
        sensors: class of the sensors, rtk or gps; the library's by default.
        logs: existing logs, or folders of them, instead of new flights.
        workers: number of processes; one per processor by default.
        json: print the trials as JSON.
    """
    found = find_library(library)
    measured = any(trim.statistics for trim in found.trims) or any(row.statistics for row in found.maneuvers)
    if not (found.interpolated or measured):
        raise NoClaimError(found.name)
    of: StateJudged = "estimate" if found.provenance.get("deviations_of") == "believed" else "truth"
    with worker_pool(workers or default_workers()) as executor:
        if logs is not None:
            flown = gather_evidence(log_paths(logs), executor=executor, of=of)
            warn_of_logs(found, [flight.header for flight in flown])
            drawn = all_interpolated(found)
        else:
            air = wind or found.conditions.wind
            warn_of_flight(found, wind=air)
            drawn, specifications = _sample_and_flights(
                found, sample=sample, seed=seed, flights=flights, wind=air
            )
            population = library_population(found, vehicles, airframe=airframe, seed=seed, sensors=sensors)
            options = FlightOptions(**population)
            flown = list(
                _fly(tuple(one.with_options(options) for one in specifications), found, of, executor)
            )
    if found.interpolated:
        return REFUTED if judge_interpolated(found, drawn, flown, json=json) else 0
    trials = coverage_trials(found, flown)
    refuted = any(trial.refuted for trial in trials)
    if json:
        document = {
            "library": found.name,
            "sha256": library_hash(found),
            "flights": len(flown),
            "seeds": sorted(flight.header.seed for flight in flown),
            "refuted": refuted,
            "trials": [asdict(trial) for trial in trials],
        }
        sys.stdout.write(json_module.dumps(document, indent=2) + "\n")
    else:
        _print_trials(found, trials, len(flown))
    return REFUTED if refuted else 0


def _sample_and_flights(
    library: Library, *, sample: int, seed: int, flights: int | None, wind: str
) -> tuple[PrimitiveSample, tuple[FlightSpecification, ...]]:
    """Returns the sample of an interpolated library, and new flights."""
    if not library.interpolated:
        return EMPTY_SAMPLE, new_flights(library, seed=seed, flights=flights or FLIGHTS, wind=wind)
    claimed = claimed_flight_count(library)
    count = flights or claimed
    if count > claimed:
        raise FlightError(
            f"--flights: expected at most {claimed}, the number in the claim of {library.name}, got {count}"
        )
    ordered = _coasting_range(library)
    return sampled_flights(library, ordered, most=sample, seed=seed, flights=count, wind=wind)


def new_flights(library: Library, *, seed: int, flights: int, wind: str) -> tuple[FlightSpecification, ...]:
    """Returns flights by the library's own schedule with new seeds.

    Raises:
        FlightError: the library does not say how it was flown.
    """
    ordered, conditions = _coasting_range(library), library.conditions
    assert conditions.maneuver_end is not None
    like_before = Campaign(
        name=library.name,
        library=library.name,
        wind=wind,
        altitude=conditions.altitude or DEFAULT_ALTITUDE,
        flights=flights,
        coasting_range=ordered,
        maneuver_end={wind: conditions.maneuver_end},
    )
    return specify_campaign(like_before, library, seed=seed, flights=flights, wind=wind, role=TESTING)


def _coasting_range(library: Library) -> tuple[float, float]:
    """Returns shortest and longest coasting time of a library's flights, in seconds.

    Raises:
        FlightError: the library does not say how it was flown.
    """
    conditions = library.conditions
    ordered = library.provenance.get("coasting_times_ordered") or conditions.coasting_range
    if conditions.maneuver_end is None or ordered is None:
        raise FlightError(
            f"library {library.name}: expected a maneuver-end rule and a range of coasting times for new "
            "flights, got none; give --logs with existing flights"
        )
    return ordered[0], ordered[1]


def _fly(
    specifications: tuple[FlightSpecification, ...],
    library: Library,
    of: StateJudged,
    executor: Executor,
) -> Iterable[FlightEvidence]:
    cut = executor.map(partial(_fly_and_cut, library=library, of=of), specifications)
    return show_progress(cut, total=len(specifications), what=f"testing {library.name}")


def _fly_and_cut(specification: FlightSpecification, library: Library, of: StateJudged) -> FlightEvidence:
    """Flies once and returns the segments; writes no log."""
    log = fly_specification(specification, library)
    return extract_evidence(log, name=specification.name, sha256=f"seed {specification.seed}", of=of)


def _print_trials(library: Library, trials: tuple[CoverageTrial, ...], flights: int) -> None:
    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=110)
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    table.add_column("primitive", no_wrap=True)
    for name in ("flights", "inside", "unsettled", "share inside", "95 %", "claim", "p", ""):
        table.add_column(name, justify="right", no_wrap=True)
    for trial in trials:
        share = f"{trial.inside / trial.flights:.3f}" if trial.flights else "-"
        table.add_row(
            *(f"{trial.kind} {trial.id}", str(trial.flights), str(trial.inside), str(trial.unsettled)),
            *(share, f"{trial.low:.3f}-{trial.high:.3f}", f"{trial.claimed:.3f}", f"{trial.p_value:.2g}"),
            "REFUTED" if trial.refuted else "not flown" if not trial.flights else "not refuted",
        )
    console.print(table)
    refuted = [f"{trial.kind} {trial.id}" for trial in trials if trial.refuted]
    verdict = f"refuted for {', '.join(refuted)}" if refuted else "not refuted"
    least = min((t.inside / t.flights for t in trials if t.flights), default=0.0)
    console.print(
        f"{library.name}: {plural(flights, 'new flight')}, at least {least:.1%} of them inside the bounds "
        f"of each primitive; its claim is {verdict}. p is Holm's for {len(trials)} primitives at once.",
        soft_wrap=True,
    )
