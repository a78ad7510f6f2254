"""Test of a library's coverage claims with new flights."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.stats import binom, binomtest

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from flight.errors import FlightError
from identification.segmentation.flight_evidence import FlightEvidence
from identification.statistics.box import Box
from identification.statistics.coast_errors import averaged_hull, instantaneous_hull
from identification.statistics.samples import Samples, maneuver_samples, trim_samples

from .identify import InconsistentLogsError

INTERVAL_CONFIDENCE = 0.95


class NoClaimError(FlightError):
    """No primitive of the library has statistics."""

    def __init__(self, library: str) -> None:
        super().__init__(f"library {library}: expected primitives with statistics to test, got none")


@dataclass(frozen=True, slots=True)
class CoverageTrial:
    """Coverage claim of one primitive and its result in new flights.

    Attributes:
        kind: trim or maneuver.
        id: id of the trim or maneuver.
        claimed: claimed share of future flights inside all bounds at once.
        flights: new flights with this primitive, lost and unsettled ones included.
        inside: flights in which all numbers stayed inside the bounds.
        unsettled: flights in which it did not settle or that were lost; they count as outside.
        low: lower end of the exact (Clopper-Pearson) 95 % interval of the share inside; 0 without a flight.
        high: upper end; 1 without a flight.
        p_value: probability of at most this many inside if the claim is true, after Holm's correction for the
            number of primitives; 1 without a flight.
        refuted: True if the p-value is below the level of the test.
    """

    kind: Literal["trim", "maneuver"]
    id: int
    claimed: float
    flights: int
    inside: int
    unsettled: int
    low: float
    high: float
    p_value: float
    refuted: bool


def coverage_trials(
    library: Library, flights: Sequence[FlightEvidence], *, level: float = 0.05
) -> tuple[CoverageTrial, ...]:
    """Tests the coverage claim of each primitive, in the library's order.

    If all claims are true, the probability that any is refuted is at most `level` (Holm, Scand. J. Statist.
    6, 1979); a claim with 95 % confidence is itself false for one primitive in twenty.

    Args:
        library: library with the claims.
        flights: new flights, segmented by the library's rule, with the state that its errors refer to.
        level: level of the test.

    Raises:
        NoClaimError: no primitive has statistics.
        InconsistentLogsError: the library was identified from a flight, or a flight has other trims,
            maneuvers or another rule.
    """
    check_consistency(library, flights)
    claims = [
        (kind, part, part.statistics.coverage)
        for kind, parts in (("trim", library.trims), ("maneuver", library.maneuvers))
        for part in parts
        if part.statistics is not None
    ]
    if not claims:
        raise NoClaimError(library.name)
    counted = [(kind, part.id, claim, *count_inside(library, part, flights)) for kind, part, claim in claims]
    p_values = [float(binom.cdf(inside, count, claim)) for _, _, claim, count, inside, _ in counted]
    return tuple(
        CoverageTrial(
            kind="trim" if kind == "trim" else "maneuver",
            id=number,
            claimed=claim,
            flights=count,
            inside=inside,
            unsettled=unsettled,
            **clopper_pearson_interval(inside, count),
            p_value=p_value,
            refuted=p_value < level,
        )
        for (kind, number, claim, count, inside, unsettled), p_value in zip(
            counted, adjust_p_values(p_values), strict=True
        )
    )


def adjust_p_values(p_values: Sequence[float]) -> list[float]:
    """Returns p-values corrected for multiple tests (Holm 1979)."""
    corrected = [0.0] * len(p_values)
    largest = 0.0
    for rank, place in enumerate(np.argsort(p_values, kind="stable").tolist()):
        largest = max(largest, min(1.0, (len(p_values) - rank) * p_values[place]))
        corrected[place] = largest
    return corrected


def trim_box(trim: Trim) -> Box:
    """Returns the box of a trim's bounds: forward, side, yaw rate."""
    velocity, error = trim.velocity, trim.error
    centre = np.array([velocity.forward, velocity.side, velocity.yaw_rate])
    size = np.abs([error.forward, error.side, error.yaw_rate])
    return Box(centre, size, len(centre))


def maneuver_box(row: Maneuver) -> Box:
    """Returns the box of a maneuver's bounds: duration and displacement."""
    moved, error = row.displacement, row.error
    centre = np.array([row.duration, moved.x, moved.y, moved.heading])
    size = np.abs([error.duration, error.forward, error.side, error.heading_change])
    return Box(centre, size, len(centre))


def count_inside(
    library: Library, part: Trim | Maneuver, flights: Sequence[FlightEvidence]
) -> tuple[int, int, int]:
    """Returns a primitive's flights: all, inside the bounds, discarded."""
    box, samples = _box_and_samples(library, part, flights)
    return samples.count, int(box.contains(samples.low, samples.high).sum()), len(samples.discarded)


def _box_and_samples(
    library: Library, part: Trim | Maneuver, flights: Sequence[FlightEvidence]
) -> tuple[Box, Samples]:
    if isinstance(part, Maneuver):
        return maneuver_box(part), maneuver_samples(flights, part.id)
    bins = [trim.averaged[0].shortest for trim in library.trims if trim.averaged]
    averaged = library.conditions.trim_error_kind == "averaged" and bins
    # An interpolated trim has no bins; the shortest coast flown is that of the library.
    hull = averaged_hull(min(bins)) if averaged else instantaneous_hull
    return trim_box(part), trim_samples(flights, part.id, hull=hull)


def clopper_pearson_interval(inside: int, count: int) -> dict[str, float]:
    """Returns `low` and `high` of a share's exact 95 % interval."""
    if not count:
        return {"low": 0.0, "high": 1.0}
    found = binomtest(inside, count).proportion_ci(INTERVAL_CONFIDENCE, method="exact")
    return {"low": float(found.low), "high": float(found.high)}


def check_consistency(library: Library, flights: Sequence[FlightEvidence]) -> None:
    """Checks that flights can test a library.

    Raises:
        InconsistentLogsError: the library was identified from a flight, a flight comes twice, or a flight has
            other trims, maneuvers or another rule.
    """
    known = set(library.provenance.get("logs_by_seed", {}).values())
    seen: dict[str, str] = {}
    for flight in flights:
        if flight.sha256 in known:
            raise InconsistentLogsError(
                f"{flight.name}: expected a new flight, got one from which {library.name} was identified"
            )
        if flight.sha256 in seen:
            raise InconsistentLogsError(
                f"expected different flights, {flight.name} is the same flight as {seen[flight.sha256]}"
            )
        seen[flight.sha256] = flight.name
        if _automaton(flight.library) != _automaton(library):
            raise InconsistentLogsError(
                f"{flight.name}: expected the trims, maneuvers and maneuver-end rule of {library.name}, "
                f"got those of {flight.library.name}"
            )


def _automaton(library: Library) -> object:
    """Returns trims, edges and rule, which flights and library must share."""
    trims = [(trim.id, trim.velocity) for trim in library.trims]
    edges = [(row.id, row.from_trim, row.to_trim) for row in library.maneuvers]
    return trims, edges, library.conditions.maneuver_end
