"""What to fly: every edge of the automaton in every flight, in an order and with times drawn by chance."""

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
) -> tuple[Sequence, ...]:
    """Returns one sequence a flight; flights are the independent units of the statistics.

    Each flight is a closed tour of the automaton that uses every maneuver, so every maneuver is flown in
    every flight. Where as many maneuvers leave each trim as lead to it, it uses each exactly once (an
    Eulerian circuit); elsewhere some are flown again, the fewest that a tour takes (the route problem of a
    postman in one-way streets). Start trim, order, coasting times and heading are random.

    Args:
        library: names the trims and the maneuvers; its numbers are not used.
        flights: how many.
        rng: the campaign's own random numbers.
        coasting_range: shortest and longest coasting time in seconds, drawn uniformly between.
        wind: wind class to fly in.

    Raises:
        NoClosedTourError: there are no maneuvers, or from some trim with a maneuver there is no way back.
    """
    edges = tour_edges([(maneuver.from_trim, maneuver.to_trim) for maneuver in library.maneuvers])
    return tuple(
        _tour(edges, name=f"flight-{number:04d}", rng=rng, coasting_range=coasting_range, wind=wind)
        for number in range(flights)
    )


def tour_edges(edges: list[Edge]) -> list[Edge]:
    """Returns the edges of a shortest closed tour: all of them, and the fewest again that close it.

    What is to be flown again is a flow of least cost from the trims that more edges lead to than leave, to
    those that more leave than lead to (Edmonds and Johnson, Mathematical Programming 5, 1973).

    Raises:
        NoClosedTourError: there are none, or they do not lead from each trim to every other.
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
    # The circuit that the graph library finds follows the order in which the edges were added.
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
