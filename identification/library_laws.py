"""Joint laws of a library's primitives, with samples from the same flights."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from flight.automaton.joint_law import MOST_DEVIATIONS
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from identification.segmentation.flight_evidence import FlightEvidence
from identification.statistics.entry_model import choose_terms
from identification.statistics.maneuver_law import identify_entry, identify_maneuver_law, performances
from identification.statistics.trim_law import identify_trim_law


def add_laws(
    trims: Sequence[Trim],
    maneuvers: Sequence[Maneuver],
    *,
    flown: Library,
    bounding: Sequence[FlightEvidence],
    nominal: Sequence[FlightEvidence],
    confidence: float,
) -> tuple[tuple[Trim, ...], tuple[Maneuver, ...]]:
    """Returns trims and maneuvers with their joint laws.

    Lost flights are left out; a primitive with fewer than two samples has no law.

    Args:
        trims: identified trims.
        maneuvers: identified maneuvers.
        flown: library of the flights, whose commands entry velocities are compared with.
        bounding: flights for the bounds.
        nominal: flights for the values.
        confidence: confidence of coverages.
    """
    parts = [[flight for flight in part if not flight.lost] for part in (bounding, nominal)]
    flights = [*parts[0], *parts[1]]
    chosen = _thinned(len(flights))
    found = {row.id: [performances(row, part, flown) for part in (flights, *parts)] for row in maneuvers}
    learnt = 2 if nominal else 0
    terms = choose_terms([samples[learnt].entries for samples in found.values()])
    laws = []
    for row in maneuvers:
        known, bounds, values = found[row.id]
        entry = identify_entry(
            known,
            values,
            bounds,
            terms=terms,
            chosen=chosen,
            discarded=_discarded(row),
            confidence=confidence,
        )
        laws.append(replace(row, law=identify_maneuver_law(known, chosen, entry)))
    held = tuple(
        replace(
            trim,
            law=identify_trim_law(
                trim,
                bounding=parts[0],
                nominal=parts[1],
                chosen=chosen,
                discarded=_discarded(trim),
                confidence=confidence,
            ),
        )
        for trim in trims
    )
    return held, tuple(laws)


def _discarded(part: Trim | Maneuver) -> int:
    return 0 if part.statistics is None else part.statistics.discarded


def _thinned(count: int) -> list[int]:
    """Returns evenly spaced places of at most `MOST_DEVIATIONS` flights."""
    if not count:
        return []
    places = np.linspace(0, count - 1, min(count, MOST_DEVIATIONS)).round()
    return list(map(int, places))
