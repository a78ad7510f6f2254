"""Campaign schedule: every maneuver in every flight, random order and times."""

from __future__ import annotations

from itertools import pairwise
from math import pi

import networkx as nx
import numpy as np

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.sequence import Sequence
from flight.se2 import SE2

Edge = tuple[int, int]


class NoClosedTourError(FlightError):
    """The automaton has no closed walk that uses every maneuver."""


def schedule(
    library: Library,
    *,
    flights: int,
    rng: np.random.Generator,
    coasting_range: tuple[float, float],
    wind: str,
    repetitions: int = 1,
) -> tuple[Sequence, ...]:
    """Returns one sequence per flight, the independent unit of the statistics.

    Each flight is a closed tour of the automaton that uses every maneuver. Where as many maneuvers leave each
    trim as lead to it, each is used exactly once (an Eulerian circuit); otherwise the fewest possible are
    repeated (the directed Chinese postman problem). Start trim, order, coasting times and heading are random.

    Args:
        library: trims and maneuvers; its values and errors are not used.
        flights: number of flights.
        rng: the campaign's random number generator.
        coasting_range: shortest and longest coasting time in seconds; times are drawn uniformly between them.
        wind: wind class to fly in.
        repetitions: of the whole tour, in one order that is random too.

    Raises:
        NoClosedTourError: there are no maneuvers, or the automaton is not strongly connected.
    """
    once = tour_edges([(maneuver.from_trim, maneuver.to_trim) for maneuver in library.maneuvers])
    edges = once * repetitions
    return tuple(
        _tour(edges, name=f"flight-{number:04d}", rng=rng, coasting_range=coasting_range, wind=wind)
        for number in range(flights)
    )


def tour_edges(edges: list[Edge]) -> list[Edge]:
    """Returns the edges of a shortest closed tour, repeated ones last.

    The repeated edges are a minimum-cost flow from trims with more incoming edges to trims with more outgoing
    edges (Edmonds and Johnson, Mathematical Programming 5, 1973).

    Raises:
        NoClosedTourError: there are no edges, or the graph is not strongly connected.
    """
    graph: nx.DiGraph[int] = nx.DiGraph()
    graph.add_edges_from(edges, weight=1)
    if not edges or not nx.is_strongly_connected(graph):
        raise NoClosedTourError(
            f"expected an automaton in which maneuvers lead from every trim to every other; got {edges}"
        )
    for trim in graph:
        graph.nodes[trim]["demand"] = graph.out_degree(trim) - graph.in_degree(trim)
    again = nx.min_cost_flow(graph)
    extra = [(left, to) for left in again for to, times in again[left].items() for _ in range(times)]
    return [*edges, *extra]


def _tour(
    edges: list[Edge],
    *,
    name: str,
    rng: np.random.Generator,
    coasting_range: tuple[float, float],
    wind: str,
) -> Sequence:
    # The circuit found depends on the order in which the edges are added.
    graph: nx.MultiDiGraph[int] = nx.MultiDiGraph()
    graph.add_edges_from(edges[place] for place in rng.permutation(len(edges)))
    start = edges[rng.integers(len(edges))][0]
    circuit = list(nx.eulerian_circuit(graph, source=start))
    assert all(before[1] == after[0] for before, after in pairwise(circuit))
    trims = (start, *(to_trim for _, to_trim in circuit))
    return Sequence(
        name=name,
        start=SE2(0.0, 0.0, rng.uniform(-pi, pi)),
        trims=trims,
        coasting_times=tuple(rng.uniform(*coasting_range, len(trims)).tolist()),
        wind=wind,
    )
