"""`maneuver regenerate`: a shipped library again, from nothing."""

import sys
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from flight.library_file import library_text
from flight.words import counted
from identification.identify import StateJudged, TrimErrors
from identification.identify import identify as identify_library

from .campaign_flights import fly_whole_campaign
from .campaign_size import campaign_size, forecast
from .claims import CLAIMS_LESS, split_by_kind, weaker_claims
from .evidence import gather_evidence
from .files import find_campaign, refuse_existing
from .identify import publish_library, report
from .numbers import Count, Seed
from .workers import default_workers, worker_pool


def regenerate(
    *,
    campaign: str = "gtmax",
    seed: Seed = 1,
    coverage: float | None = None,
    confidence: float = 0.95,
    flights: Count | None = None,
    nominal_flights: Annotated[int | None, Parameter(validator=Number(gte=0, lte=1_000_000))] = None,
    wind: str | None = None,
    out: Path = Path("gtmax-sim.json"),
    logs: Path | None = None,
    of: StateJudged = "truth",
    trim_errors: TrimErrors = "instantaneous",
    workers: Count | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Flies a campaign and identifies a library from its logs: `fly` and `identify` in one.

    Says before flying how many flights, flight hours and minutes it takes. --coverage and --confidence say
    how many flights: the fewest of which the largest deviations of a primitive cover that share of future
    flights with all its numbers at once. The same seed gives the same bytes, whatever the number of workers.
    The exit code is 1 where a primitive claims less than --coverage, because a maneuver did not settle.

    For example:

        maneuver regenerate --coverage 0.95 --confidence 0.95 --seed 1

        maneuver regenerate --wind calm --flights 20 --out still-air.json

    Args:
        campaign: name or path of the campaign.
        seed: of all chance.
        coverage: share of future flights to be covered.
        confidence: with which the coverage is claimed.
        flights: how many give the bounds; the campaign's by default.
        nominal_flights: how many others, before them, give the values of maneuvers; with 0, which is the
            default where only --flights is given, the same flights give both and may claim less.
        wind: wind class; the campaign's by default.
        out: where the library goes; its data sheet goes beside it.
        logs: folder that keeps the logs; none are kept by default.
        of: whose deviations: those of the true motion, or of what the vehicle believed.
        trim_errors: largest deviation of a trim at any instant, or averaged over a coast.
        workers: processes; one for each processor by default.
        force: overwrite OUT and logs.
        json: print the library as JSON.
    """
    plan = find_campaign(campaign)
    size = campaign_size(
        plan, coverage=coverage, confidence=confidence, flights=flights, nominal_flights=nominal_flights
    )
    refuse_existing(out, force=force)
    if logs is not None:
        refuse_existing(logs, force=force)
    air, processes = wind or plan.wind, workers or default_workers()
    if not json:
        ahead = forecast(plan, wind=air, seed=seed, flights=size.flights, workers=processes)
        print(f"{size.said()}\n{ahead.said()}", flush=True)
    began = perf_counter()
    with ExitStack() as stack:
        folder = logs or Path(stack.enter_context(TemporaryDirectory(prefix="maneuver-")))
        executor = stack.enter_context(worker_pool(processes))
        flown = fly_whole_campaign(
            plan,
            seed=seed,
            flights=size.bounding,
            nominal_flights=size.nominal,
            wind=air,
            folder=folder,
            executor=executor,
            force=force,
        )
        cut = gather_evidence([flight.path for flight in flown.flights], executor=executor, of=of)
    bounding, centring = split_by_kind(cut)
    library = identify_library(
        bounding,
        name=out.stem,
        nominal=centring,
        confidence=confidence,
        trim_errors=trim_errors,
        campaign={"name": plan.name, "seed": seed, "flights": size.bounding, "nominal": size.nominal},
    )
    weak = weaker_claims(library, coverage)
    publish_library(library, out, force=force)
    if json:
        sys.stdout.write(library_text(library))
    else:
        hours, minutes = flown.duration / 3600, (perf_counter() - began) / 60
        print(
            f"{counted(size.flights, 'flight')}, {hours:.2f} flight hours, seed {seed}, {minutes:.1f} minutes"
        )
        sys.stdout.write(report(library, out))
    for line in weak:
        print(line, file=sys.stderr)
    return CLAIMS_LESS if weak else 0
