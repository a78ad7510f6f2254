"""The search over walks: complete with any room, in any library, within limits."""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from math import inf
from time import process_time

import numpy as np
import pytest

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.se2 import SE2, Twist
from planner.kernel.exact import ExactSearch, least_costs
from planner.kernel.tables import tables
from planner.policies.worst_case import worst_case_planner
from planner.walks.search_result import SearchResult
from planner.walks.walk import count_walks, walks
from tests.support.planning.random_missions import random_mission, synthetic_library

from .alike_libraries import alike_library, near_mission
from .little_kernel import little_kernel

pytestmark = pytest.mark.kernel

GAMMAS = (0.0, -0.5, 0.5)


@contextmanager
def little_room() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("planner.kernel.exact.load_kernel", little_kernel)
        yield


def cost_of(found: SearchResult) -> float:
    return max(found.costs, default=inf)


def least_of_all(library: Library, gammas: tuple[float, ...], mission: Mission) -> float:
    """Returns the least worst-case cost, every walk solved on its own."""
    start, depth, goal_trim = mission.start_trim, mission.max_trims, mission.goal_trim
    levels = [tables(library, (gamma,), start, depth, goal_trim) for gamma in gammas]
    worst = [
        np.max([least_costs(table, mission) for table in same], axis=0).min()
        for same in zip(*levels, strict=True)
    ]
    return float(min(worst, default=inf))


@pytest.mark.parametrize("size", [0.0, 1e-13, 1e-9, 1e-6, 1e-4, 1e-2])
@pytest.mark.parametrize("seed", range(6))
def test_what_is_known_of_walks_that_are_alike_leaves_out_none_that_is_best(seed: int, size: float) -> None:
    rng = np.random.default_rng([seed, int(1e9 * size)])
    library = alike_library(rng, trims=3, size=size)
    mission = near_mission(rng, trims=3, max_trims=5)
    gammas = GAMMAS[: 1 + 2 * (seed % 2)]
    exact = least_of_all(library, gammas, mission)
    with little_room():
        found = ExactSearch(library, gammas).answer(mission)
    assert found.exhausted
    assert cost_of(found) == pytest.approx(exact, rel=1e-9, abs=1e-9)
    assert cost_of(ExactSearch(library, gammas).answer(mission)) == pytest.approx(exact, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_goals_that_maneuvers_alone_lead_to_are_reached_as_fast(seed: int) -> None:
    rng = np.random.default_rng(seed)
    library = alike_library(rng, trims=3, size=0.3)
    mission = near_mission(rng, trims=3, max_trims=5)
    end, trim = mission.start, mission.start_trim
    for _ in range(4):
        onward = int(rng.integers(1, 4))
        end, trim = end @ library.maneuver(trim, onward).displacement, onward
    heading = None if mission.goal_heading is None else end.heading
    mission = replace(mission, goal=end.position, goal_heading=heading)
    exact = least_of_all(library, (0.0,), mission)
    with little_room():
        found = ExactSearch(library, (0.0,)).answer(mission)
    assert found.exhausted
    assert cost_of(found) == pytest.approx(exact, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_bounds_hold_wherever_the_search_of_similar_walks_is_stopped(seed: int) -> None:
    rng = np.random.default_rng(seed)
    library = alike_library(rng, trims=3, size=1e-4)
    mission = near_mission(rng, trims=3, max_trims=5)
    best = cost_of(ExactSearch(library, GAMMAS).answer(mission))
    bounds = []
    for nodes in range(50, 1000, 50):
        stopped = ExactSearch(library, GAMMAS).answer(mission, max_nodes=nodes)
        assert stopped.lower_bound <= best * (1 + 1e-9)
        assert cost_of(stopped) >= best * (1 - 1e-9)
        bounds.append(stopped.lower_bound)
    assert bounds[-1] >= bounds[0]


@pytest.mark.parametrize("seed", range(20))
def test_walks_that_come_depth_first_are_as_many(seed: int) -> None:
    """With room for 40 walks most are followed depth first."""
    rng = np.random.default_rng(seed)
    library = synthetic_library(8, 40, seed=seed)
    mission = random_mission(rng, library, 6)
    if seed % 4 == 0:
        mission = replace(mission, goal_trim=int(rng.integers(1, 9)))
    known = ExactSearch(library, GAMMAS).answer(mission)
    with little_room():
        found = ExactSearch(library, GAMMAS).answer(mission)
    assert found.exhausted
    assert cost_of(found) == pytest.approx(cost_of(known), rel=1e-9)


def test_maneuvers_that_cost_nothing_make_no_search_long() -> None:
    """128 walks of 8 trims are one; each alone takes 256 sets of times at each of three levels."""
    error = Twist(0.1, 0.1, 0.02)
    trims = (
        Trim(1, "right", Twist(2.0, 0.0, 0.3), error),
        Trim(2, "left", Twist(2.0, 0.0, -0.3), error),
        Trim(3, "ahead", Twist(2.0, 0.0, 0.0), replace(error, yaw_rate=0.01)),
    )
    pairs = [(one.id, other.id) for one in trims for other in trims]
    nothing = SE2.identity(), ManeuverError(0.0, 0.0, 0.0, 0.0)
    between = tuple(Maneuver(number, *pair, 0.0, *nothing) for number, pair in enumerate(pairs, start=1))
    library = Library("free", "maneuvers that cost nothing", "", trims, between)
    mission = Mission("m", SE2.identity(), 1, (30.0, 10.0), 0.0, max_trims=8)
    planner = worst_case_planner(library, 0.5)
    began = process_time()
    plan = planner.plan(mission)
    # 0.4 s; 13 s without what is known of other walks.
    assert process_time() - began < 4.0
    assert plan.status == "optimal"
    assert plan.cost == pytest.approx(16.2370530677, abs=1e-8)


@pytest.mark.parametrize("seed", range(12))
def test_the_most_promising_walks_come_with_a_bound_of_the_others(seed: int) -> None:
    rng = np.random.default_rng(seed)
    library = synthetic_library(8, 30, seed=seed)
    mission = replace(random_mission(rng, library, 4), goal_heading=None)
    every = walks(library, mission.start_trim, max_trims=4)
    search = ExactSearch(library, GAMMAS)
    chosen, rest = search.promising_walks(mission, limit=inf, most=len(every))
    assert rest == inf
    assert len(set(chosen)) == len(chosen)
    assert set(chosen) <= set(every)
    few, bound = search.promising_walks(mission, limit=inf, most=10)
    assert few == chosen[:10]
    costs = {
        tuple(walk): cost
        for table in tables(library, (0.0,), mission.start_trim, 4, None)
        for walk, cost in zip(table.walks.tolist(), least_costs(table, mission).tolist(), strict=True)
    }
    assert all(costs[walk] >= bound - 1e-9 or walk in few for walk in chosen)
    assert all(costs[walk] == inf for walk in set(every) - set(chosen))
    near, limit = search.promising_walks(mission, limit=bound, most=len(every))
    assert limit == bound
    assert set(near) <= set(few)


@pytest.mark.parametrize("goal_trim", [None, 3])
def test_walks_are_counted_without_a_list(goal_trim: int | None) -> None:
    library = synthetic_library(8, 30, seed=2)
    for depth in range(1, 6):
        listed = walks(library, 1, max_trims=depth, goal_trim=goal_trim)
        assert count_walks(library, 1, max_trims=depth, goal_trim=goal_trim) == len(listed)


def test_a_search_that_stops_among_short_walks_bounds_long_ones_too() -> None:
    """The goal trim is six maneuvers away, so a stopped first pass knows no walk to it."""
    library = synthetic_library(7, 7, seed=1)
    mission = Mission("far trim", SE2.identity(), 1, (40.0, 5.0), 3.0, max_trims=8, goal_trim=7)
    best = ExactSearch(library, (0.0,)).answer(mission)
    assert best.exhausted
    assert len(best.walk) == 7
    for nodes in range(1, 4):
        stopped = ExactSearch(library, (0.0,)).answer(mission, max_nodes=nodes)
        assert stopped.lower_bound <= cost_of(best)
    assert ExactSearch(library, (0.0,)).answer(mission, deadline=0.0).lower_bound <= cost_of(best)


@pytest.mark.parametrize("seed", range(8))
def test_bounds_of_stopped_searches_hold_with_little_room(seed: int) -> None:
    rng = np.random.default_rng(seed)
    library = synthetic_library(8, 40, seed=seed)
    mission = random_mission(rng, library, 6)
    best = cost_of(ExactSearch(library, GAMMAS).answer(mission))
    with little_room():
        for nodes in (1, 5, 20, 100, 400):
            stopped = ExactSearch(library, GAMMAS).answer(mission, max_nodes=nodes)
            assert stopped.lower_bound <= best * (1 + 1e-9)
            assert cost_of(stopped) >= best * (1 - 1e-9)


def test_more_trims_than_the_kernel_has_room_for_are_refused() -> None:
    library = synthetic_library(4, 8, seed=1)
    mission = Mission("deep", SE2.identity(), 1, (4.0, 0.0), 0.0, max_trims=13)
    with pytest.raises(ValueError, match="max_trims must be <= 12, got 13"):
        ExactSearch(library, (0.0,)).promising_walks(mission, limit=inf, most=5)


def test_the_little_kernel_is_not_the_one_that_plans() -> None:
    assert isinstance(little_kernel(), ctypes.CDLL)
    with little_room():
        library = synthetic_library(60, 200, seed=1)
        hub = Library("hub", "", "", library.trims, _star(library))
        with pytest.raises(MemoryError):
            ExactSearch(hub, (0.0,)).answer(Mission("m", SE2.identity(), 1, (9.0, 0.0), 1.0))


def _star(library: Library) -> tuple[Maneuver, ...]:
    """Returns maneuvers from the first trim to all others: more than little room holds."""
    like = library.maneuvers[0]
    others = enumerate(library.trims[1:], start=1)
    return tuple(replace(like, id=number, from_trim=1, to_trim=trim.id) for number, trim in others)
