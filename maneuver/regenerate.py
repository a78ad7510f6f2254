"""`maneuver regenerate`: campaign flights and their library in one command."""

import sys
from pathlib import Path
from time import perf_counter
from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from experiments.campaign.campaign_size import campaign_size
from experiments.campaign.cleanup import find_made_library, finish_removal, remove_flights
from experiments.campaign.coverage_report import COVERAGE_TOO_LOW, split_by_kind, weaker_claims
from experiments.campaign.evidence import gather_evidence
from experiments.campaign.fly_campaign import CampaignOrder, fly_campaign
from experiments.campaign.forecast import forecast_campaign
from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flight.mission.campaign import VehiclePopulation
from flight.plural import plural
from identification.identify import TrimErrors
from identification.identify import identify as identify_library
from identification.segmentation.flight_evidence import StateJudged
from maneuver.library.library_files import check_library_target, library_report, write_library_files
from maneuver.options.executor_options import THIS_MACHINE, ExecutorArgument, open_executor
from maneuver.options.folder_status import print_status
from maneuver.options.numbers import Count, Seed
from maneuver.options.population import campaign_population
from runtime.executor import default_workers, worker_pool
from runtime.job_store import inspect_jobs
from scenarios.find import find_campaign
from sim.loop.specification import FlightOptions


def regenerate(
    *,
    campaign: str = "gtmax",
    seed: Seed = 1,
    coverage: float | None = None,
    confidence: float = 0.95,
    flights: Count | None = None,
    nominal_flights: Annotated[int | None, Parameter(validator=Number(gte=0, lte=1_000_000))] = None,
    wind: str | None = None,
    vehicles: VehiclePopulation | None = None,
    airframe: Seed | None = None,
    sensors: str | None = None,
    out: Path = Path("gtmax-sim.json"),
    logs: Path | None = None,
    of: StateJudged = "truth",
    trim_errors: TrimErrors = "instantaneous",
    job_executor: ExecutorArgument = THIS_MACHINE,
    status: Annotated[bool, Parameter(negative="")] = False,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Flies a campaign and identifies a library from its logs.

    Flights, flight hours and minutes are printed before flying. --coverage and --confidence determine the
    number of flights: the smallest number whose largest deviations cover that share of future flights, in all
    numbers of a primitive at once. The same seed gives the same bytes for any number of workers. The same
    command resumes after a stop. The exit code is 1 if a primitive's claim is below --coverage because a
    maneuver did not settle.

    For example:

        maneuver regenerate --coverage 0.95 --confidence 0.95 --seed 1

        maneuver regenerate --wind calm --flights 20 --out still-air.json

        maneuver regenerate --seed 1 --cluster tcp://head:8786 --logs flights

    Args:
        campaign: name or path of the campaign.
        seed: seed of all random numbers.
        coverage: share of future flights to cover.
        confidence: confidence of the coverage.
        flights: number of flights for the bounds; the campaign's by default.
        nominal_flights: number of earlier flights for the values of maneuvers; with 0, the default if only
            --flights is given, the same flights give values and bounds, and the claim may be weaker.
        wind: wind class; the campaign's by default.
        vehicles: vehicle flown, while the nominal one is assumed: `nominal`, `one` drawn airframe for all
            flights, or a `fleet`, an airframe drawn for each flight; the campaign's by default.
        airframe: seed of the airframe of --vehicles one; --seed by default.
        sensors: sensor class, rtk or gps; the campaign's by default.
        out: library file to write; its data sheet is written beside it.
        logs: folder for the logs; by default OUT's name with `-flights`, removed once OUT is written.
        of: motion whose deviations are bounded: the truth or the vehicle's estimate.
        trim_errors: largest deviation of a trim at any instant, or averaged over a coast.
        job_executor: executor of the flights; the library is identified on this machine.
        status: list the stored flights without flying; the exit code is 1 if one is missing.
        force: overwrite OUT and logs of other flights.
        json: print the library as JSON.
    """
    plan = find_campaign(campaign)
    size = campaign_size(
        plan, coverage=coverage, confidence=confidence, flights=flights, nominal_flights=nominal_flights
    )
    population = campaign_population(plan, vehicles, airframe=airframe, seed=seed, sensors=sensors)
    order = CampaignOrder(
        plan,
        seed,
        size.bounding,
        wind or plan.wind,
        nominal_flights=size.nominal,
        flight_options=FlightOptions(**population),
    )
    # Without --force too: the existing file may be this command's result.
    check_library_target(out, force=True)
    folder = logs or out.with_name(f"{out.stem}-flights")
    if status:
        return print_status(inspect_jobs(order.jobs(folder), folder), as_json=json)
    finish_removal(folder)
    if out.exists() and not force and not inspect_jobs(order.jobs(folder), folder).complete:
        library = find_made_library(out, order, of=of, confidence=confidence, trim_errors=trim_errors)
        print(f"{out} exists and is the result of this command: nothing is flown", file=sys.stderr)
        return _report_library(library, out, coverage=coverage, json=json)
    if not json:
        print(size.describe())
        if job_executor.cluster is None:
            processes = job_executor.workers or default_workers()
            ahead = forecast_campaign(
                plan, wind=order.wind, seed=seed, flights=size.flights, workers=processes
            )
            print(ahead.describe(), flush=True)
    began = perf_counter()
    with open_executor(job_executor) as executor:
        flown = fly_campaign(order, folder, job_executor=executor, force=force)
    with worker_pool(job_executor.workers or default_workers()) as pool:
        cut = gather_evidence([flight.path for flight in flown.flights], executor=pool, of=of)
    bounding, centring = split_by_kind(cut)
    library = identify_library(
        bounding,
        name=out.stem,
        nominal=centring,
        confidence=confidence,
        trim_errors=trim_errors,
        campaign=order.provenance(),
    )
    write_library_files(library, out, force=force)
    if logs is None:
        remove_flights(order.jobs(folder), folder)
    if not json:
        hours, minutes = flown.duration / 3600, (perf_counter() - began) / 60
        print(
            f"{plural(size.flights, 'flight')}, {hours:.2f} flight hours, seed {seed}, {minutes:.1f} minutes"
        )
    return _report_library(library, out, coverage=coverage, json=json)


def _report_library(library: Library, out: Path, *, coverage: float | None, json: bool) -> int:
    """Prints a library's report and weak claims; returns the exit code."""
    sys.stdout.write(library_text(library) if json else library_report(library, out))
    weak = weaker_claims(library, coverage)
    for line in weak:
        print(line, file=sys.stderr)
    return COVERAGE_TOO_LOW if weak else 0
