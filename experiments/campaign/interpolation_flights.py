"""Test flights of an interpolated library, and their report."""

import sys
from dataclasses import asdict
from json import dumps
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from identification.data_sheet import describe_claim
from identification.design.interpolation_schedule import PrimitiveSample, draw_sample, sampled_schedule
from identification.interpolation_trial import InterpolationTrial, PrimitiveTrial, interpolation_trials
from identification.segmentation.flight_evidence import FlightEvidence
from sim.loop.specification import DEFAULT_ALTITUDE, FlightSpecification

from .fly_campaign import INTERPOLATION_TESTING, specify_tours

SAMPLE = 40
"""Default number of trims, and of maneuvers, drawn."""


EMPTY_SAMPLE = PrimitiveSample((), ())

_KINDS = {
    "trim": "trims, interpolated or entered by interpolated maneuvers",
    "maneuver": "interpolated maneuvers",
}


def claimed_flight_count(library: Library) -> int:
    """Returns the number of flights that the claims cover."""
    return min(claim.flights for claim in library.interpolated)


def all_interpolated(library: Library) -> PrimitiveSample:
    """Returns all interpolated primitives of a library."""
    return PrimitiveSample(
        tuple(trim.id for trim in library.trims if trim.interpolated),
        tuple(row.id for row in library.maneuvers if row.interpolated),
    )


def sampled_flights(
    library: Library,
    coasting_range: tuple[float, float],
    *,
    most: int,
    seed: int,
    flights: int,
    wind: str,
) -> tuple[PrimitiveSample, tuple[FlightSpecification, ...]]:
    """Returns a random sample of primitives and test flights through it.

    Args:
        library: interpolated library.
        coasting_range: coasting times of its flown primitives, seconds.
        most: largest number of primitives of each kind.
        seed: seed of all random numbers.
        flights: number of flights.
        wind: wind class.
    """
    stream = np.random.SeedSequence(seed, spawn_key=(INTERPOLATION_TESTING.schedule_stream,))
    rng = np.random.default_rng(stream)
    drawn = draw_sample(library, most=most, rng=rng)
    tours = sampled_schedule(
        library, drawn, flights=flights, rng=rng, coasting_range=coasting_range, wind=wind
    )
    altitude = library.conditions.altitude or DEFAULT_ALTITUDE
    return drawn, specify_tours(tours, library.name, seed=seed, altitude=altitude, role=INTERPOLATION_TESTING)


def judge_interpolated(
    library: Library, drawn: PrimitiveSample, flights: list[FlightEvidence], *, json: bool
) -> bool:
    """Prints the test of drawn primitives; returns True if refuted."""
    primitives, trials = interpolation_trials(library, drawn, flights)
    refuted = any(trial.refuted for trial in trials)
    if json:
        document: dict[str, Any] = {
            "library": library.name,
            "sha256": library_hash(library),
            "flights": len(flights),
            "seeds": sorted(flight.header.seed for flight in flights),
            "refuted": refuted,
            "interpolated": [asdict(trial) for trial in trials],
            "primitives": [asdict(one) for one in primitives],
        }
        sys.stdout.write(dumps(document, indent=2) + "\n")
    else:
        _print_trials(library, primitives, trials, len(flights))
    return refuted


def _print_trials(
    library: Library,
    primitives: tuple[PrimitiveTrial, ...],
    trials: tuple[InterpolationTrial, ...],
    flights: int,
) -> None:
    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=110)
    outside = [one for one in primitives if not one.kept]
    if outside:
        table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
        table.add_column("left its bounds", no_wrap=True)
        for name in ("flights", "inside", "unsettled"):
            table.add_column(name, justify="right")
        for one in outside:
            table.add_row(
                f"{one.kind} {one.id}", *(str(number) for number in (one.flights, one.inside, one.unsettled))
            )
        console.print(table)
    for trial in trials:
        own = [one for one in primitives if one.kind == trial.kind]
        inside, shown = sum(one.inside for one in own), sum(one.flights for one in own)
        console.print(f"{_KINDS[trial.kind]}: {describe_claim(trial.claim)}", soft_wrap=True)
        console.print(
            f"  {trial.kept} of {trial.drawn} drawn primitives have all of {flights} flights inside "
            f"({trial.kept / trial.drawn:.3f}, 95 %: {trial.low:.3f}-{trial.high:.3f}), {inside} of {shown} "
            f"samples inside ({inside / shown:.3f}); p = {trial.p_value:.2g}: "
            f"{'REFUTED' if trial.refuted else 'not refuted'}",
            soft_wrap=True,
        )
    source = library.provenance.get("grown_from", {}).get("name", "the flown library")
    console.print(f"Flown primitives are not tested here; test {source} for them.", soft_wrap=True)
