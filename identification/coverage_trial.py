"""Whether a library keeps its promise: new flights against the coverage that each primitive claims."""

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
    """A library says of no primitive on how many flights it rests and what it covers."""

    def __init__(self, library: str) -> None:
        super().__init__(f"library {library}: no primitive has statistics, so there is no claim to test")


@dataclass(frozen=True, slots=True)
class CoverageTrial:
    """The claim of one primitive beside what new flights did.

    Attributes:
        kind: of the primitive.
        id: of the trim or maneuver.
        claimed: share of future flights that all its bounds hold at once.
        flights: new flights that show it, lost and unsettled ones included.
        inside: flights in which all numbers stayed inside the bounds.
        unsettled: flights in which it did not settle or that were lost; they count as outside.
        low: lower end of the exact (Clopper-Pearson) 95 % interval of the share inside; 0 without a flight.
        high: upper end; 1 without a flight.
        doubt: probability of so few inside if the claim were true, after Holm's correction for the number
            of primitives; 1 without a flight.
        refuted: whether that is too improbable.
    """

    kind: Literal["trim", "maneuver"]
    id: int
    claimed: float
    flights: int
    inside: int
    unsettled: int
    low: float
    high: float
    doubt: float
    refuted: bool


def coverage_trials(
    library: Library, flights: Sequence[FlightEvidence], *, level: float = 0.05
) -> tuple[CoverageTrial, ...]:
    """Returns a trial for each primitive that claims a coverage, in the library's order.

    All claims together are wrongly refuted with a probability of at most `level` (Holm, Scand. J. Statist. 6,
    1979), if all are true; a claim with a confidence of 95 % is itself untrue for one primitive in twenty.

    Args:
        library: whose claims are tested.
        flights: new ones, judged by the library's rule and by the state that its errors are of.
        level: of the test.

    Raises:
        NoClaimError: no primitive has statistics.
        InconsistentLogsError: a flight is one of those that the library was found from, or was flown with
            other trims, maneuvers or another rule.
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
    doubts = [float(binom.cdf(inside, count, claim)) for _, _, claim, count, inside, _ in counted]
    return tuple(
        CoverageTrial(
            kind="trim" if kind == "trim" else "maneuver",
            id=number,
            claimed=claim,
            flights=count,
            inside=inside,
            unsettled=unsettled,
            **clopper_pearson_interval(inside, count),
            doubt=doubt,
            refuted=doubt < level,
        )
        for (kind, number, claim, count, inside, unsettled), doubt in zip(
            counted, adjust_p_values(doubts), strict=True
        )
    )


def adjust_p_values(doubts: Sequence[float]) -> list[float]:
    """Returns p-values corrected for their number (Holm 1979): compare them with the level for all."""
    corrected = [0.0] * len(doubts)
    largest = 0.0
    for rank, place in enumerate(np.argsort(doubts, kind="stable").tolist()):
        largest = max(largest, min(1.0, (len(doubts) - rank) * doubts[place]))
        corrected[place] = largest
    return corrected


def trim_box(trim: Trim) -> Box:
    """Returns what a trim's bounds hold: forward, side, yaw rate."""
    velocity, error = trim.velocity, trim.error
    centre = np.array([velocity.forward, velocity.side, velocity.yaw_rate])
    size = np.abs([error.forward, error.side, error.yaw_rate])
    return Box(centre, size, len(centre))


def maneuver_box(row: Maneuver) -> Box:
    """Returns what a maneuver's bounds hold: duration, forward, side, heading change."""
    moved, error = row.displacement, row.error
    centre = np.array([row.duration, moved.x, moved.y, moved.heading])
    size = np.abs([error.duration, error.forward, error.side, error.heading_change])
    return Box(centre, size, len(centre))


def count_inside(
    library: Library, part: Trim | Maneuver, flights: Sequence[FlightEvidence]
) -> tuple[int, int, int]:
    """Returns how many flights show a primitive, in how many it stayed inside, in how many it was lost."""
    box, samples = _box_and_samples(library, part, flights)
    return samples.count, int(box.contains(samples.low, samples.high).sum()), len(samples.discarded)


def _box_and_samples(
    library: Library, part: Trim | Maneuver, flights: Sequence[FlightEvidence]
) -> tuple[Box, Samples]:
    if isinstance(part, Maneuver):
        return maneuver_box(part), maneuver_samples(flights, part.id)
    bins = [trim.averaged[0].shortest for trim in library.trims if trim.averaged]
    averaged = library.conditions.trim_error_kind == "averaged" and bins
    # A grown trim has no bins of its own; the shortest coast flown is the library's.
    hull = averaged_hull(min(bins)) if averaged else instantaneous_hull
    return trim_box(part), trim_samples(flights, part.id, hull=hull)


def clopper_pearson_interval(inside: int, count: int) -> dict[str, float]:
    """Returns the ends, `low` and `high`, of the exact (Clopper-Pearson) 95 % interval of a share."""
    if not count:
        return {"low": 0.0, "high": 1.0}
    found = binomtest(inside, count).proportion_ci(INTERVAL_CONFIDENCE, method="exact")
    return {"low": float(found.low), "high": float(found.high)}


def check_consistency(library: Library, flights: Sequence[FlightEvidence]) -> None:
    """Refuses flights that cannot judge a library.

    Raises:
        InconsistentLogsError: a flight is one of those that the library was found from, comes twice, or was
            flown with other trims, maneuvers or another rule.
    """
    known = set(library.provenance.get("logs_by_seed", {}).values())
    seen: dict[str, str] = {}
    for flight in flights:
        if flight.sha256 in known:
            raise InconsistentLogsError(
                f"{flight.name}: expected new flights; {library.name} was identified from this one"
            )
        if flight.sha256 in seen:
            raise InconsistentLogsError(f"{flight.name} is the same flight as {seen[flight.sha256]}")
        seen[flight.sha256] = flight.name
        if _automaton(flight.library) != _automaton(library):
            raise InconsistentLogsError(
                f"{flight.name}: expected the trims, maneuvers and maneuver-end rule of {library.name}, "
                f"it was flown with others, of {flight.library.name}"
            )


def _automaton(library: Library) -> object:
    """Returns what a flight must share with a library to be judged by it."""
    trims = [(trim.id, trim.velocity) for trim in library.trims]
    edges = [(row.id, row.from_trim, row.to_trim) for row in library.maneuvers]
    return trims, edges, library.conditions.maneuver_end
