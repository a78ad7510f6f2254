"""Wind in which maneuver errors are Table 10's: `python -m benchmarks.identification.wind_of_table_10 24 1`.

Arguments: flights, seed; then winds at 20 ft in m/s. In each wind the campaign `gtmax` is flown with half as
many other flights for the values, by its maneuver-end rule of `gtmax`, and identified. The table has the
geometric mean of identified over printed errors: of maneuvers (Table 10 of the thesis, suspect rows left
out), of each of their numbers, and of trims (Table 9). The wind class `gtmax` is chosen from it: the mean of
maneuvers is to be 0.7 to 1.2.
"""

import sys
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from itertools import chain
from math import exp, log
from statistics import mean

from experiments.campaign.fly_campaign import BOUNDING, CENTRING, campaign_library, specify_campaign
from flight.automaton.library import Library
from flightlog.identity.fingerprint import fingerprint
from identification.identify import identify
from identification.segmentation.flight_evidence import FlightEvidence, extract_evidence
from runtime.executor import default_workers, worker_pool
from scenarios.find import find_campaign, find_library
from sim.campaign_flight import fly_specification
from sim.loop.specification import FlightSpecification
from sim.wind.wind_class import wind_class

CAMPAIGN = find_campaign("gtmax")
PRINTED = find_library("thesis-gtmax")
WINDS = ("2", "3", "4", "5", "6")
NUMBERS = ("forward", "side", "heading_change", "duration")


def flown_evidence(library: Library, specification: FlightSpecification) -> FlightEvidence:
    """Returns the evidence of a flight."""
    log = fly_specification(specification, library)
    return extract_evidence(log, name=specification.name, sha256=fingerprint(log))


def identified_in(wind: str, *, flights: int, seed: int) -> Library:
    """Returns the library of a campaign in a wind."""
    conditions = replace(campaign_library(CAMPAIGN, "gtmax").conditions, wind=wind)
    library = replace(campaign_library(CAMPAIGN, "gtmax"), conditions=conditions)
    nominal, bounding = (
        specify_campaign(CAMPAIGN, library, seed=seed, flights=count, wind=wind, role=role)
        for role, count in ((CENTRING, flights // 2), (BOUNDING, flights))
    )
    with worker_pool(default_workers()) as executor:
        found = list(executor.map(partial(flown_evidence, library), nominal + bounding))
    return identify(found[len(nominal) :], name=wind, nominal=found[: len(nominal)])


def maneuver_ratios(library: Library, number: str) -> list[float]:
    """Returns identified over printed error of each sound row of Table 10."""
    rows = [row for row in PRINTED.maneuvers if not row.notes.startswith("suspect")]
    found = {row.id: row.error for row in library.maneuvers}
    return [abs(getattr(found[row.id], number) / getattr(row.error, number)) for row in rows]


def trim_ratios(library: Library) -> list[float]:
    """Returns identified over printed error of each number of Table 9."""
    return [
        abs(getattr(library.trim(trim.id).error, number) / getattr(trim.error, number))
        for trim in PRINTED.trims
        for number in ("forward", "side", "yaw_rate")
    ]


def geometric_mean(ratios: Iterable[float]) -> float:
    """Returns the geometric mean."""
    return exp(mean(map(log, ratios)))


def main() -> None:
    """Prints the table."""
    flights, seed = (int(word) for word in sys.argv[1:3])
    print("W20 m/s   mean m/s   maneuvers   forward   side   heading   duration   trims   timed out or lost")
    for wind in sys.argv[3:] or WINDS:
        library = identified_in(wind, flights=flights, seed=seed)
        by_number = {number: maneuver_ratios(library, number) for number in NUMBERS}
        figures = [geometric_mean(chain.from_iterable(by_number.values()))]
        figures += [geometric_mean(ratios) for ratios in by_number.values()]
        figures.append(geometric_mean(trim_ratios(library)))
        known, provenance = wind_class(wind), library.provenance
        failed = len(provenance["lost"]) + sum(map(len, provenance["unsettled"].values()))
        print(
            f"{known.wind_at_20_ft:7.2f}{known.mean_wind(CAMPAIGN.altitude):11.2f}",
            *(f"{figure:10.2f}" for figure in figures),
            f"{failed:10d}",
            flush=True,
        )


if __name__ == "__main__":
    main()
