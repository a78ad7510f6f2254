"""Dependence between primitives: variance shared by a flight, successive maneuvers."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from identification.segmentation.flight_evidence import FlightEvidence

from .digits import rounded
from .samples import MANEUVER_SCALARS, maneuver_row

LARGEST_CORRELATION = 0.2
"""Correlation of successive maneuvers above which they do not count as independent."""


@dataclass(frozen=True, slots=True)
class Dependence:
    """Dependence of maneuvers on one another.

    Attributes:
        between_flights: share of variance between flights, for each of `MANEUVER_SCALARS`.
        successive: largest absolute correlation of two values of successive maneuvers, less what their
            flight shares.
        scalars: names of those two, the earlier maneuver's first.
    """

    between_flights: tuple[float, ...]
    successive: float
    scalars: tuple[str, str]


def dependence(flights: Sequence[FlightEvidence]) -> Dependence | None:
    """Returns the dependence of settled maneuvers; None for too few.

    Deviations are from the maneuver's mean, in its standard deviations.
    """
    scaled = _scaled_rows(flights)
    rows = [np.array(flight) for flight in scaled if len(flight) > 1]
    if len(rows) < 2:
        return None
    count = np.mean([len(flight) for flight in rows])
    means = np.array([flight.mean(axis=0) for flight in rows])
    total = np.concatenate(rows).var(axis=0)
    # The variance of a mean of n values is (share + (1 - share) / n) of theirs.
    share = (count * (means**2).mean(axis=0) / np.where(total > 0, total, 1.0) - 1) / (count - 1)
    pairs = [pair for flight in rows for pair in pairwise(flight - flight.mean(axis=0))]
    before, after = (np.array([pair[place] for pair in pairs]) for place in (0, 1))
    sizes = np.outer(before.std(axis=0), after.std(axis=0))
    found = before.T @ after / len(pairs) / np.where(sizes > 0, sizes, 1.0)
    first, second = np.unravel_index(int(np.abs(found).argmax()), found.shape)
    return Dependence(
        tuple(rounded(max(float(one), 0.0)) for one in share),
        rounded(float(abs(found[first, second]))),
        (MANEUVER_SCALARS[first], MANEUVER_SCALARS[second]),
    )


def _scaled_rows(flights: Sequence[FlightEvidence]) -> list[list[Float[np.ndarray, "4"]]]:
    """Returns each flight's deviations in standard deviations, in order."""
    known: defaultdict[int, list[tuple[float, ...]]] = defaultdict(list)
    for flight in flights:
        for part in flight.segments.maneuvers:
            if part.settled:
                known[part.id].append(maneuver_row(part))
    means = {number: np.mean(rows, axis=0) for number, rows in known.items()}
    spreads = {number: np.std(rows, axis=0) for number, rows in known.items()}
    return [
        [
            (np.array(maneuver_row(part)) - means[part.id])
            / np.where(spreads[part.id] > 0, spreads[part.id], 1.0)
            for part in flight.segments.maneuvers
            if part.settled
        ]
        for flight in flights
    ]
