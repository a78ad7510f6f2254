"""Tests of the schedule: every maneuver in every flight, the rest random."""

from collections import Counter
from dataclasses import replace
from itertools import pairwise
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import kstest, uniform

from flight.mission.sequence import Sequence
from identification.design.schedule import NoClosedTourError, schedule, tour_edges
from tests.support.synthetic_log import synthetic_library

LIBRARY = synthetic_library()


def tours(flights: int, seed: int = 5) -> tuple[Sequence, ...]:
    rng = np.random.default_rng(seed)
    return schedule(LIBRARY, flights=flights, rng=rng, coasting_range=(1.0, 3.0), wind="calm")


def test_every_flight_uses_every_maneuver_once() -> None:
    for tour in tours(20):
        edges = Counter(maneuver.id for maneuver in LIBRARY.maneuvers_along(tour.trims))
        assert edges == Counter(range(1, 23))


def test_flights_differ_in_order_start_and_heading() -> None:
    drawn = tours(60)
    assert len({tour.trims for tour in drawn}) == 60
    assert {tour.trims[0] for tour in drawn} == set(range(1, 8))
    assert len({tour.start.heading for tour in drawn}) == 60


def test_an_automaton_with_a_trim_of_no_return_is_refused() -> None:
    one_way = replace(LIBRARY, maneuvers=tuple(row for row in LIBRARY.maneuvers if row.from_trim != 1))
    with pytest.raises(NoClosedTourError, match="lead from every trim to every other"):
        schedule(one_way, flights=1, rng=np.random.default_rng(1), coasting_range=(1.0, 3.0), wind="calm")


def test_where_edges_do_not_balance_the_fewest_are_flown_again() -> None:
    """Removes slow forward to hover; the tour repeats fast forward edges."""
    lacking = replace(LIBRARY, maneuvers=LIBRARY.maneuvers[1:])
    rng = np.random.default_rng(1)
    for tour in schedule(lacking, flights=20, rng=rng, coasting_range=(1.0, 3.0), wind="calm"):
        flown = Counter(pairwise(tour.trims))
        assert set(flown) == {(row.from_trim, row.to_trim) for row in lacking.maneuvers}
        assert {edge for edge, times in flown.items() if times > 1} == {(2, 3), (3, 1)}
        assert tour.trims[0] == tour.trims[-1]


@given(st.integers(2, 7), st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_every_automaton_that_hangs_together_has_a_tour_of_all_its_edges(trims: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    ring = [(trim, (trim + 1) % trims) for trim in range(trims)]
    chords = {(int(a), int(b)) for a, b in rng.integers(trims, size=(6, 2)) if a != b}
    edges = [*ring, *sorted(chords - set(ring))]
    toured = tour_edges(edges)
    assert toured[: len(edges)] == edges
    assert set(toured) == set(edges)
    leaving, entering = Counter(left for left, _ in toured), Counter(to for _, to in toured)
    assert leaving == entering
    # A lower bound of any closed tour: the surplus of entries over all trims.
    surplus = Counter(to for _, to in edges)
    surplus.subtract(Counter(left for left, _ in edges))
    assert len(toured) - len(edges) >= sum(count for count in surplus.values() if count > 0)


def test_entry_headings_and_coasting_times_are_evenly_distributed() -> None:
    drawn = tours(300)
    headings = [tour.start.heading for tour in drawn]
    times = [time for tour in drawn for time in tour.coasting_times]
    assert kstest(headings, uniform(-pi, 2 * pi).cdf).pvalue > 0.01
    assert kstest(times, uniform(1.0, 2.0).cdf).pvalue > 0.01
