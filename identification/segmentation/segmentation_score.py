"""How well changes of trim are found from the motion alone, held against the command channel."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain

import numpy as np

from .segmentation import ObservedWalk, Segments, TrimEntry

TOLERANCE = 1.0
"""Seconds by which a boundary may be off and still count as found."""

Edge = tuple[int, int]


@dataclass(frozen=True, slots=True)
class EdgeScore:
    """What became of one maneuver's entries; of both kinds of its boundaries where `edge` is None.

    Attributes:
        edge: ids of the trims left and led to.
        commanded: how many there are.
        found: how many of them were found within the tolerance, between the same trims.
        spurious: how many more the motion seemed to show.
        late: mean lateness of those found, seconds; 0 where there is none.
        spread: standard deviation of their lateness, seconds.
        furthest: largest absolute lateness, seconds.
    """

    edge: Edge | None
    commanded: int
    found: int
    spurious: int
    late: float
    spread: float
    furthest: float


@dataclass(frozen=True, slots=True)
class Boundaries:
    """Entries and ends of the maneuvers of one flight, with the trims that they lie between."""

    entries: tuple[tuple[float, Edge], ...]
    ends: tuple[tuple[float, Edge], ...]


def boundaries_of(walk: ObservedWalk, segments: Segments) -> Boundaries:
    """Returns where a flight's maneuvers begin and end; those that did not settle have no end."""
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
    """Returns the scores of all entries, of all ends, and of the entries of each edge.

    Args:
        flights: for each flight the boundaries that were commanded, and those that the motion shows.
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


# Edge, lateness; a miss has the lateness of infinity, a spurious boundary that of minus infinity.
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
        spread=float(found.std(ddof=1)) if len(found) > 1 else 0.0,
        furthest=float(np.abs(found).max()) if len(found) else 0.0,
    )


def _edge(entry: TrimEntry) -> Edge:
    return entry.from_trim, entry.to_trim
