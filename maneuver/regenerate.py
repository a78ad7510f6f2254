"""`maneuver regenerate`: a shipped library again, from nothing."""

import sys
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated

from cyclopts import Parameter

from flight.library_file import library_text
from identification.identify import identify as identify_library

from .campaign_flights import fly_whole_campaign
from .evidence import gather_evidence
from .files import find_campaign, refuse_existing
from .identify import publish_library, report
from .numbers import Count, Seed
from .workers import default_workers, worker_pool


def regenerate(
    *,
    campaign: str = "gtmax",
    seed: Seed = 1,
    flights: Count | None = None,
    wind: str | None = None,
    out: Path = Path("gtmax-sim.json"),
    logs: Path | None = None,
    confidence: float = 0.95,
    workers: Count | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Flies a campaign and identifies a library from its logs: `fly` and `identify` in one.

    The same seed gives the same bytes, whatever the number of workers.

    For example:

        maneuver regenerate --seed 1

        maneuver regenerate --wind calm --flights 20 --out still-air.json

    Args:
        campaign: name or path of the campaign.
        seed: of all chance.
        flights: how many; the campaign's by default.
        wind: wind class; the campaign's by default.
        out: where the library goes; its data sheet goes beside it.
        logs: folder that keeps the logs; none are kept by default.
        confidence: with which the coverage is claimed.
        workers: processes; one for each processor by default.
        force: overwrite OUT and logs.
        json: print the library as JSON.
    """
    plan = find_campaign(campaign)
    refuse_existing(out, force=force)
    if logs is not None:
        refuse_existing(logs, force=force)
    with ExitStack() as stack:
        folder = logs or Path(stack.enter_context(TemporaryDirectory(prefix="maneuver-")))
        executor = stack.enter_context(worker_pool(workers or default_workers()))
        flown = fly_whole_campaign(
            plan,
            seed=seed,
            flights=flights or plan.flights,
            wind=wind or plan.wind,
            folder=folder,
            executor=executor,
            force=force,
        )
        evidence = gather_evidence([flight.path for flight in flown.flights], executor=executor)
    ordered = {"name": plan.name, "seed": seed, "flights": len(flown.flights)}
    library = identify_library(evidence, name=out.stem, confidence=confidence, campaign=ordered)
    publish_library(library, out, force=force)
    if json:
        sys.stdout.write(library_text(library))
    else:
        print(f"{len(flown.flights)} flights, {flown.duration / 3600:.2f} flight hours, seed {seed}")
        sys.stdout.write(report(library, out))
    return 0
