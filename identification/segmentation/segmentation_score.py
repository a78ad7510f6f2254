"""Score of segmentation by motion against the commands."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain

import numpy as np

from .segmentation import ObservedWalk, Segments, TrimEntry

TOLERANCE = 1.0
"""Largest time error in seconds of a boundary that counts as found."""

Edge = tuple[int, int]


@dataclass(frozen=True, slots=True)
class EdgeScore:
    """Score of one edge's boundaries, or of all where `edge` is None.

    Attributes:
        edge: ids of the trims left and reached.
        commanded: number of commanded boundaries.
        found: number of them found within the tolerance, between the same trims.
        spurious: number of boundaries found without a command.
        late: mean delay of those found, seconds; 0 where there is none.
        standard_deviation: standard deviation of their delay, seconds.
        furthest: largest absolute delay, seconds.
    """

    edge: Edge | None
    commanded: int
    found: int
    spurious: int
    late: float
    standard_deviation: float
    furthest: float


@dataclass(frozen=True, slots=True)
class Boundaries:
    """Times and edges of a flight's maneuver entries and ends."""

    entries: tuple[tuple[float, Edge], ...]
    ends: tuple[tuple[float, Edge], ...]


def boundaries_of(walk: ObservedWalk, segments: Segments) -> Boundaries:
    """Returns a flight's boundaries; unsettled maneuvers have no end."""
    pairs = list(zip(walk.entries, segments.maneuvers, strict=True))
    return Boundaries(
        entries=tuple((entry.time, _edge(entry)) for entry, _ in pairs),
        ends=tuple(
            (segment.start + segment.duration, _edge(entry)) for entry, segment in pairs if segment.settled
        ),
    )


def score_boundaries(
    flights: Iterable[tuple[Boundaries, Boundaries]],
) -> tuple[EdgeScore, EdgeScore, tuple[EdgeScore, ...]]:
    """Returns the scores of all entries, all ends, and each edge's entries.

    Args:
        flights: commanded and found boundaries of each flight.
    """
    known = list(flights)
    entries = [_match_boundaries(commanded.entries, shown.entries) for commanded, shown in known]
    ends = [_match_boundaries(commanded.ends, shown.ends) for commanded, shown in known]
    edges = sorted({edge for commanded, shown in known for _, edge in (*commanded.entries, *shown.entries)})
    return (
        _edge_score(None, entries),
        _edge_score(None, ends),
        tuple(
            _edge_score(edge, [[row for row in rows if row[0] == edge] for rows in entries]) for edge in edges
        ),
    )


# Edge, delay; infinity for a missed boundary, minus infinity for a spurious one.
_Row = tuple[Edge, float]


def _match_boundaries(
    commanded: tuple[tuple[float, Edge], ...], shown: tuple[tuple[float, Edge], ...]
) -> list[_Row]:
    """Pairs boundaries between the same trims, nearest first."""
    near = sorted(
        (abs(late - time), i, j)
        for i, (time, edge) in enumerate(commanded)
        for j, (late, other) in enumerate(shown)
        if edge == other and abs(late - time) <= TOLERANCE
    )
    partner: dict[int, int] = {}
    for _, i, j in near:
        if i not in partner and j not in partner.values():
            partner[i] = j
    rows = [
        (edge, shown[partner[i]][0] - time if i in partner else np.inf)
        for i, (time, edge) in enumerate(commanded)
    ]
    taken = set(partner.values())
    return rows + [(edge, -np.inf) for j, (_, edge) in enumerate(shown) if j not in taken]


def _edge_score(edge: Edge | None, flights: list[list[_Row]]) -> EdgeScore:
    lateness = np.array([late for _, late in chain.from_iterable(flights)])
    found = lateness[np.isfinite(lateness)]
    spurious = int((lateness == -np.inf).sum())
    return EdgeScore(
        edge=edge,
        commanded=len(lateness) - spurious,
        found=len(found),
        spurious=spurious,
        late=float(found.mean()) if len(found) else 0.0,
        standard_deviation=float(found.std(ddof=1)) if len(found) > 1 else 0.0,
        furthest=float(np.abs(found).max()) if len(found) else 0.0,
    )


def _edge(entry: TrimEntry) -> Edge:
    return entry.from_trim, entry.to_trim
