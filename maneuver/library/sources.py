"""`maneuver library sources`: shares of wind, noise, vehicle and sensors in the errors."""

import json as json_module
import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from experiments.campaign.error_sources import study_sources
from flight.mission.campaign import VehiclePopulation
from maneuver.options.numbers import Count, Seed
from maneuver.options.population import campaign_population
from runtime.atomic_write import check_output_files, write_atomically
from runtime.executor import default_workers, worker_pool
from scenarios.find import find_campaign


def sources(
    campaign: str = "gtmax",
    /,
    *,
    vehicles: VehiclePopulation | None = None,
    airframe: Seed | None = None,
    sensors: str | None = None,
    flights: Count = 20,
    seed: Seed = 1,
    out: Path | None = None,
    workers: Count | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Studies sources of a campaign's errors, one by one and together.

    A campaign each is flown with wind, white noise, drawn vehicles and systematic sensor errors alone, and
    one with all, every maneuver twice a flight. Said are each source's share of the variance of every scalar,
    and the share that is between flights: what all performances of a flight have in common.

    For example:

        maneuver library sources gtmax --out gtmax-sim.sources.json

        maneuver library sources gtmax --vehicles one --airframe 3 --flights 40

    Args:
        campaign: name or path of the campaign.
        vehicles: population of the vehicles; the campaign's by default, a `fleet` where that is nominal.
        airframe: seed of the airframe of --vehicles one; --seed by default.
        sensors: class of the sensors, rtk or gps; the campaign's by default.
        flights: of each source.
        seed: seed of all random numbers.
        out: file for every scalar of every primitive, as JSON; none by default.
        workers: processes; one for each processor by default.
        force: overwrite OUT.
        json: print every scalar as JSON instead of the table of medians.
    """
    found = find_campaign(campaign)
    check_output_files(out, force=force)
    stated = vehicles or ("fleet" if found.vehicles in {"", "nominal"} else None)
    population = campaign_population(found, stated, airframe=airframe, seed=seed, sensors=sensors)
    with worker_pool(workers or default_workers()) as executor:
        study = study_sources(found, flights=flights, seed=seed, executor=executor, **population)
    text = json_module.dumps(study.document(), indent=1) + "\n"
    if out is not None:
        write_atomically(text.encode(), out, force=force)
    sys.stdout.write(text if json else study.markdown())
    return 0
