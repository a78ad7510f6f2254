"""What to fly: every edge of the automaton once a flight, in an order and with times drawn by chance."""

from __future__ import annotations

from itertools import pairwise
from math import pi

import networkx as nx
import numpy as np

from flight.errors import FlightError
from flight.library import Library
from flight.se2 import SE2
from flight.sequence import Sequence


class NoClosedTourError(FlightError):
    """The automaton has no closed walk that uses every maneuver exactly once."""


def schedule(
    library: Library,
    *,
    flights: int,
    rng: np.random.Generator,
    coasting_range: tuple[float, float],
    wind: str,
) -> tuple[Sequence, ...]:
    """Returns one sequence a flight; flights are the independent units of the statistics.

    Each flight is a closed tour of the automaton that uses every maneuver exactly once (an Eulerian circuit),
    so every maneuver is flown equally often. Start trim, order, coasting times and heading are random.

    Args:
        library: names the trims and the maneuvers; its numbers are not used.
        flights: how many.
        rng: the campaign's own random numbers.
        coasting_range: shortest and longest coasting time in seconds, drawn uniformly between.
        wind: wind class to fly in.

    Raises:
        NoClosedTourError: some trim is left by more or fewer maneuvers than lead to it, or the automaton is
            not connected.
    """
    return tuple(
        _tour(library, name=f"flight-{number:04d}", rng=rng, coasting_range=coasting_range, wind=wind)
        for number in range(flights)
    )


def _tour(
    library: Library, *, name: str, rng: np.random.Generator, coasting_range: tuple[float, float], wind: str
) -> Sequence:
    # The circuit that the graph library finds follows the order in which the edges were added.
    edges = [(maneuver.from_trim, maneuver.to_trim) for maneuver in library.maneuvers]
    graph: nx.DiGraph[int] = nx.DiGraph()
    graph.add_edges_from(edges[place] for place in rng.permutation(len(edges)))
    if not edges or not nx.is_eulerian(graph):
        raise NoClosedTourError(
            "expected an automaton in which as many maneuvers leave each trim as lead to it, all connected; "
            f"got maneuvers {edges}"
        )
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
