"""Calibration of coverage claims on planted laws.

Campaigns of planted flights: 153 for the bounds, 30 for the values, cut and identified from their logs like
any others. The deviations follow laws whose joint coverage is known exactly, so every primitive's true
coverage is computed, not estimated. Of 200 primitives 10 may be expected to cover less than they claim, and
more than 21 with a probability below 0.001.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count
from statistics import median

import numpy as np
from jaxtyping import Float

from experiments.campaign.fly_campaign import campaign_library
from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flight.automaton.statistics import Statistics
from identification.coverage_trial import maneuver_box, trim_box
from identification.design.schedule import schedule
from identification.identify import identify
from identification.segmentation.flight_evidence import FlightEvidence, extract_evidence
from identification.statistics.box import Box
from identification.statistics.coverage import samples_needed
from scenarios.find import find_campaign
from tests.support.deviation_laws import Law
from tests.support.planted_flights import PlantedDeviations, planted_log

COVERAGE = CONFIDENCE = 0.95
NOMINAL_FLIGHTS = 30
SHRUNKEN = 0.8

# Scales of the planted deviations: metres, seconds and radians; each primitive's are up to twice as large.
TRIM_SCALES = np.array([0.03, 0.03, 0.005])
MANEUVER_SCALES = np.array([0.02, 0.1, 0.1, 0.02])


@dataclass(frozen=True, slots=True, eq=False)
class Primitive:
    """One identified primitive beside what its deviations were drawn from.

    Attributes:
        box: its bounds.
        planted: the values that its deviations were planted around.
        scale: of the deviations of each scalar.
        claimed: coverage that it claims.
    """

    box: Box
    planted: Float[np.ndarray, "scalars"]
    scale: Float[np.ndarray, "scalars"]
    claimed: float

    def true_coverage(self, law: Law) -> float:
        """Returns the probability that all scalars of a new flight are inside the bounds."""
        low, high = self.box.centre - self.box.size, self.box.centre + self.box.size
        return law.inside((low - self.planted) / self.scale, (high - self.planted) / self.scale)

    def relative_sizes(self, law: Law) -> list[float]:
        """Returns each bound over the one that truly covers 95 %, of equal share for every scalar."""
        sizes: list[float] = (self.box.size / self.scale / law.quantile(COVERAGE, len(self.scale))).tolist()
        return sizes


def median_size(law: Law, primitives: Sequence[Primitive]) -> float:
    """Returns the median over all primitives and scalars of the bound over the true quantile."""
    return median(size for primitive in primitives for size in primitive.relative_sizes(law))


def shrunken(primitives: Sequence[Primitive]) -> list[Primitive]:
    """Returns primitives whose bounds are too small."""
    return [replace(row, box=replace(row.box, size=SHRUNKEN * row.box.size)) for row in primitives]


def shuffled(primitives: Sequence[Primitive]) -> list[Primitive]:
    """Returns primitives that have the bounds of others of their kind."""
    changed = []
    for kind in (3, 4):
        alike = [row for row in primitives if len(row.scale) == kind]
        for row, other in zip(alike, alike[1:] + alike[:1], strict=True):
            changed.append(replace(row, box=replace(row.box, size=other.box.size)))
    return changed


def calibration(law: Law, *, nominal_flights: int = NOMINAL_FLIGHTS, seed: int = 1) -> Iterator[Primitive]:
    """Yields the primitives of one campaign after another, all of them different.

    Args:
        law: of the deviations.
        nominal_flights: how many give the values of maneuvers.
        seed: of all campaigns.
    """
    library = campaign_library(find_campaign("gtmax"), "gtmax")
    for campaign in count(0):
        rng = np.random.default_rng((seed, campaign))
        scales = _Scales(library, rng)
        flights = planted_flights(library, law, scales, rng, nominal_flights)
        found = identify(flights[nominal_flights:], nominal=flights[:nominal_flights], name="planted")
        for trim, truth in zip(found.trims, library.trims, strict=True):
            yield _primitive(trim_box(trim), trim_box(truth), scales.trims[trim.id], trim.statistics)
        for row, planted in zip(found.maneuvers, library.maneuvers, strict=True):
            scale = scales.maneuvers[row.id]
            yield _primitive(maneuver_box(row), maneuver_box(planted), scale, row.statistics)


def _primitive(
    box: Box, planted: Box, scale: Float[np.ndarray, "scalars"], claim: Statistics | None
) -> Primitive:
    assert claim is not None, "identified primitives have statistics"
    return Primitive(box, planted.centre, scale, claim.coverage)


class _Scales:
    """The size of every primitive's deviations, drawn once for a campaign."""

    def __init__(self, library: Library, rng: np.random.Generator) -> None:
        self.trims = {trim.id: TRIM_SCALES * rng.uniform(0.5, 2.0, 3) for trim in library.trims}
        self.maneuvers = {row.id: MANEUVER_SCALES * rng.uniform(0.5, 2.0, 4) for row in library.maneuvers}


def planted_flights(
    library: Library, law: Law, scales: _Scales, rng: np.random.Generator, nominal_flights: int
) -> list[FlightEvidence]:
    """Returns the flights of a campaign, those for the values first, cut from their logs."""
    conditions = library.conditions
    assert conditions.coasting_range is not None
    flown = nominal_flights + samples_needed(COVERAGE, support=4, confidence=CONFIDENCE)
    tours = schedule(
        library, flights=flown, rng=rng, coasting_range=conditions.coasting_range, wind=conditions.wind
    )
    text = library_text(library).encode()
    trims = {number: law.draw(rng, flown, 3) * scale for number, scale in scales.trims.items()}
    rows = {number: law.draw(rng, flown, 4) * scale for number, scale in scales.maneuvers.items()}
    flights = []
    for number, tour in enumerate(tours):
        planted = PlantedDeviations(
            {trim: drawn[number] for trim, drawn in trims.items()},
            {row: drawn[number] for row, drawn in rows.items()},
        )
        log = planted_log(library, text, tour, planted, seed=number)
        flights.append(extract_evidence(log, name=f"flight {number}", sha256=f"{number:064x}"))
    return flights
