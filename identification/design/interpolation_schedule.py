"""Test flights through a random sample of interpolated primitives.

A campaign's flight performs every maneuver and enters each trim by every maneuver that leads to it; an
interpolated library has too many for that. A test flight performs each maneuver drawn, and enters each trim
drawn by as many maneuvers, drawn anew for every flight, as the median number that lead to a flown trim. A
test flight is thus one sample of a drawn primitive, as a campaign's flight is of a flown one.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain
from math import pi
from statistics import median_low

import networkx as nx
import numpy as np

from flight.automaton.library import Library
from flight.mission.sequence import Sequence
from flight.se2 import SE2

from .schedule import Edge

# Cost of a step along a drawn primitive on the way to the next one: more than any detour.
_DRAWN, _ANY = 1000, 1


@dataclass(frozen=True, slots=True)
class PrimitiveSample:
    """Ids of the interpolated trims and maneuvers drawn for a test."""

    trims: tuple[int, ...]
    maneuvers: tuple[int, ...]


def draw_sample(library: Library, *, most: int, rng: np.random.Generator) -> PrimitiveSample:
    """Draws interpolated primitives at random without repetition.

    Args:
        library: interpolated library.
        most: largest number of each kind.
        rng: random number generator.
    """
    edges = [(row.id, (row.from_trim, row.to_trim)) for row in library.maneuvers]
    graph = _graph([edge for _, edge in edges])
    # A tour returns to its start, so only the largest strongly connected component can be flown.
    home: set[int] = max(nx.strongly_connected_components(graph), key=len)
    entered = {to for _, (left, to) in edges if left in home}
    trims = [trim.id for trim in library.trims if trim.interpolated and trim.id in home & entered]
    rows = [row.id for row in library.maneuvers if row.interpolated and {row.from_trim, row.to_trim} <= home]
    return PrimitiveSample(*(_draw_ids(ids, most, rng) for ids in (trims, rows)))


def _draw_ids(ids: list[int], most: int, rng: np.random.Generator) -> tuple[int, ...]:
    places = rng.choice(len(ids), min(most, len(ids)), replace=False)
    return tuple(sorted(ids[place] for place in places.tolist()))


def sampled_schedule(
    library: Library,
    drawn: PrimitiveSample,
    *,
    flights: int,
    rng: np.random.Generator,
    coasting_range: tuple[float, float],
    wind: str,
) -> tuple[Sequence, ...]:
    """Returns flights that each perform every primitive drawn.

    Args:
        library: interpolated library.
        drawn: primitives to perform.
        flights: number of flights.
        rng: random number generator for order, coasting times, headings and entries of trims.
        coasting_range: shortest and longest coasting time in seconds; times are drawn uniformly between them.
        wind: wind class to fly in.
    """
    by_id = {row.id: (row.from_trim, row.to_trim) for row in library.maneuvers}
    graph = _graph(list(by_id.values()))
    maneuvers = [by_id[number] for number in drawn.maneuvers]
    for edge in graph.edges:
        graph.edges[edge]["weight"] = _DRAWN if edge in maneuvers or edge[1] in drawn.trims else _ANY
    paths = dict(nx.all_pairs_dijkstra(graph))
    entries = _entries_of_a_flown_trim(library)
    tours = []
    for number in range(flights):
        wanted = list(maneuvers)
        for trim in drawn.trims:
            leading = sorted(graph.in_edges(trim))
            wanted += [leading[place] for place in rng.permutation(len(leading))[:entries].tolist()]
        walk = _walk(list(dict.fromkeys(wanted)), paths, rng)
        times = rng.uniform(*coasting_range, len(walk)).tolist()
        start = SE2(0.0, 0.0, rng.uniform(-pi, pi))
        tours.append(Sequence(f"flight-{number:04d}", start, tuple(walk), tuple(times), wind))
    return tuple(tours)


def _graph(edges: list[Edge]) -> nx.DiGraph[int]:
    graph: nx.DiGraph[int] = nx.DiGraph()
    graph.add_edges_from(edges)
    return graph


def _entries_of_a_flown_trim(library: Library) -> int:
    leading = [row.to_trim for row in library.maneuvers if row.statistics is not None]
    return median_low([leading.count(trim) for trim in set(leading)])


def _walk(
    wanted: list[Edge],
    shortest: dict[int, tuple[dict[int, float], dict[int, list[int]]]],
    rng: np.random.Generator,
) -> list[int]:
    """Returns a walk along all wanted edges, nearest next, in random order."""
    left = [wanted[place] for place in rng.permutation(len(wanted)).tolist()]
    first = left.pop()
    walk = list(first)
    while left:
        lengths, paths = shortest[walk[-1]]
        place = min(range(len(left)), key=lambda place: lengths[left[place][0]])
        edge = left.pop(place)
        walk += chain(paths[edge[0]][1:], edge[1:])
    return walk
