"""`maneuver regenerate`: a shipped library again, from nothing."""

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
from maneuver.library.publish import check_library_target, library_report, publish_library
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

    Says before flying how many flights, flight hours and minutes it takes. --coverage and --confidence say
    how many flights: the fewest of which the largest deviations of a primitive cover that share of future
    flights with all its numbers at once. The same seed gives the same bytes, whatever the number of workers.
    Stopped in whatever way and started again, the same command flies only what is missing. The exit code is 1
    where a primitive claims less than --coverage, because a maneuver did not settle.

    For example:

        maneuver regenerate --coverage 0.95 --confidence 0.95 --seed 1

        maneuver regenerate --wind calm --flights 20 --out still-air.json

        maneuver regenerate --seed 1 --cluster tcp://head:8786 --logs flights

    Args:
        campaign: name or path of the campaign.
        seed: of all chance.
        coverage: share of future flights to be covered.
        confidence: with which the coverage is claimed.
        flights: how many give the bounds; the campaign's by default.
        nominal_flights: how many others, before them, give the values of maneuvers; with 0, which is the
            default where only --flights is given, the same flights give both and may claim less.
        wind: wind class; the campaign's by default.
        vehicles: what flies while the nominal vehicle is believed: that one exactly, `one` airframe for all
            flights, or a `fleet`, an airframe for each; the campaign's by default.
        airframe: seed of the airframe of --vehicles one; --seed by default.
        sensors: class of the sensors, rtk or gps; the campaign's by default.
        out: where the library goes; its data sheet goes beside it.
        logs: folder that keeps the logs; by default OUT's name with `-flights`, removed when OUT is there.
        of: whose deviations: those of the true motion, or of what the vehicle believed.
        trim_errors: largest deviation of a trim at any instant, or averaged over a coast.
        job_executor: who flies; the library is identified on this machine.
        status: fly nothing; say which flights are there already. The exit code is 1 where one is missing.
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
    # Without force too, what is there may be what is made here.
    check_library_target(out, force=True)
    folder = logs or out.with_name(f"{out.stem}-flights")
    if status:
        return print_status(inspect_jobs(order.jobs(folder), folder), as_json=json)
    finish_removal(folder)
    if out.exists() and not force and not inspect_jobs(order.jobs(folder), folder).complete:
        library = find_made_library(out, order, of=of, confidence=confidence, trim_errors=trim_errors)
        print(f"{out} is there already, and is what this command makes: nothing is flown", file=sys.stderr)
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
    with open_executor(job_executor) as lent:
        flown = fly_campaign(order, folder, job_executor=lent, force=force)
    with worker_pool(job_executor.workers or default_workers()) as executor:
        cut = gather_evidence([flight.path for flight in flown.flights], executor=executor, of=of)
    bounding, centring = split_by_kind(cut)
    library = identify_library(
        bounding,
        name=out.stem,
        nominal=centring,
        confidence=confidence,
        trim_errors=trim_errors,
        campaign=order.provenance(),
    )
    publish_library(library, out, force=force)
    if logs is None:
        remove_flights(order.jobs(folder), folder)
    if not json:
        hours, minutes = flown.duration / 3600, (perf_counter() - began) / 60
        print(
            f"{plural(size.flights, 'flight')}, {hours:.2f} flight hours, seed {seed}, {minutes:.1f} minutes"
        )
    return _report_library(library, out, coverage=coverage, json=json)


def _report_library(library: Library, out: Path, *, coverage: float | None, json: bool) -> int:
    """Says what a library is worth, and returns the exit code."""
    sys.stdout.write(library_text(library) if json else library_report(library, out))
    weak = weaker_claims(library, coverage)
    for line in weak:
        print(line, file=sys.stderr)
    return COVERAGE_TOO_LOW if weak else 0
