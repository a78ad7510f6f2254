"""Tests of independent errors: enclosures, and maxima away from corners."""

from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest

from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library import Library
from flight.automaton.trim import Trim
from flight.mission.mission import Mission, read_mission
from flight.se2 import SE2, Twist
from planner.independent_errors.bounded_maximum import BoundedBoxes, BoundedMaximum
from planner.independent_errors.box_evaluator import BoxEvaluator
from planner.independent_errors.corners import furthest_corner
from planner.independent_errors.enclosure import enclose_end
from planner.independent_errors.error_path import ErrorGranularity, ErrorPath, error_path
from planner.independent_errors.independent_errors import bound_independent_errors
from planner.independent_errors.worst_miss import worst_miss_bound
from planner.independent_errors.worst_time import worst_time_bound
from planner.kernel.exact import least_costs
from planner.policies.worst_case import worst_case_planner
from planner.walks.goal_condition import goal_from_start
from scenarios.find import MISSIONS
from tests.support.planning.wandering import wandering

WALKS = {"gtmax": (2, 5, 7, 3), "kinematic": (1, 2, 5, 2)}


@pytest.mark.parametrize("each", ["primitive", "scalar"])
@pytest.mark.parametrize("name", WALKS)
def test_the_enclosure_holds_ten_thousand_draws(name: str, each: ErrorGranularity) -> None:
    rng = np.random.default_rng(1)
    path = error_path({"gtmax": thesis_gtmax, "kinematic": thesis_kinematic}[name](), WALKS[name], 1.0, each)
    count = len(path.names)
    for size in (1.0, 0.3, 0.01):
        errors, width = rng.uniform(-1, 1, (1, count)) * (1 - size), np.full((1, count), size)
        times, answer = rng.uniform(0, 6, (1, 4)), rng.normal(0, 0.2, (1, 4, count))
        hull = enclose_end(path, errors, width, times, answer)
        drawn = rng.uniform(-size, size, (10_000, count))
        ends = path.at(errors + drawn).end(times + drawn @ answer[0].T)
        apart = np.abs(ends - hull.middle[0] - drawn @ hull.slope[0])
        assert apart.max() <= hull.radius[0] + 1e-9
        # The negative control: without the radius it is no enclosure.
        assert apart.max() > 1e-5


def test_what_the_enclosure_leaves_out_shrinks_with_the_square_of_the_box() -> None:
    path = error_path(thesis_gtmax(), WALKS["gtmax"], 1.0, "scalar")
    count = len(path.names)
    sizes = np.array([0.4, 0.2, 0.1, 0.05])
    still = np.zeros((1, 4, count))
    radii = [
        float(
            enclose_end(
                path, np.zeros((1, count)), np.full((1, count), size), np.full((1, 4), 3.0), still
            ).radius[0]
        )
        for size in sizes.tolist()
    ]
    slope = np.polyfit(np.log(sizes), np.log(radii), 1)[0]
    assert slope == pytest.approx(2.0, abs=0.2)


def test_the_furthest_corner_is_the_furthest_of_all() -> None:
    rng = np.random.default_rng(0)
    every = np.array(np.meshgrid(*[[-1, 1]] * 6)).reshape(6, -1).T
    for _ in range(50):
        off = complex(*rng.normal(size=2)) * rng.choice([0.0, 1.0, 10.0])
        moves = rng.normal(size=6) + 1j * rng.normal(size=6)
        signs, reach = furthest_corner(np.array([off]), moves[None])
        assert reach[0] == pytest.approx(np.abs(off + every @ moves).max())
        assert abs(off + signs[0] @ moves) == pytest.approx(reach[0])


def test_between_corners_it_can_be_worse_than_at_every_corner() -> None:
    # The ends of half a turn, give or take its rate, lie on a curve: seen from where it curves to, its middle
    # is furthest.
    library = Library("turn", "", "", (Trim(1, "turn", Twist(2, 0, 0.5), Twist(0, 0, 0.2)),), ())
    path = error_path(library, (1,), 1.0, "primitive")
    ends = path.at(np.array([[-1.0], [0.0], [1.0]])).end(np.full((3, 1), 2 * pi))
    bulge = ends[1] - 0.5 * (ends[0] + ends[2])
    goal = complex(ends[1] - 30 * bulge / abs(bulge))
    mission = Mission("here", SE2.identity(), 1, (goal.real, goal.imag), tolerance=1.0)
    corners = np.abs(ends[[0, 2]] - goal)
    bound = worst_miss_bound(path, mission, (2 * pi,))
    assert bound.found > corners.max() + 0.1
    assert bound.found <= bound.bound <= 1.02 * bound.found


@pytest.mark.parametrize("each", ["primitive", "scalar"])
def test_no_draw_misses_by_more_than_the_bound(each: ErrorGranularity) -> None:
    library, mission = thesis_gtmax(), read_mission(MISSIONS / "gtmax-2.toml")
    plan = worst_case_planner(library, 0.5).plan(mission)
    path = error_path(library, plan.sequence, 0.5, each)
    bound = worst_miss_bound(path, mission, plan.coasting_times)
    drawn = np.random.default_rng(3).uniform(-1, 1, (10_000, len(path.names)))
    ends = path.at(drawn).end(np.tile(plan.coasting_times, (len(drawn), 1)))
    assert np.abs(ends - goal_from_start(mission)).max() <= bound.bound
    assert bound.bound <= 1.011 * bound.found


@pytest.mark.parametrize(
    ("name", "gamma", "each", "most", "tight"),
    [
        ("gtmax-1", 0.5, "scalar", 1000, 1.011),
        ("gtmax-1", 1.0, "primitive", 1000, 1.011),
        ("gtmax-2", 0.5, "primitive", 1000, 1.011),
        ("gtmax-2", 1.0, "primitive", 3000, 1.011),
        ("gtmax-2", 1.0, "scalar", 2000, 6.0),
    ],
)
def test_no_draw_takes_longer_than_the_bound(
    name: str, gamma: float, each: ErrorGranularity, most: int, tight: float
) -> None:
    library, mission = thesis_gtmax(), read_mission(MISSIONS / f"{name}.toml")
    plan = worst_case_planner(library, gamma).plan(mission)
    path = error_path(library, plan.sequence, gamma, each)
    bound = worst_time_bound(path, mission, BoundedMaximum(plan.cost, (), inf, 0), most=most)
    slowest = slowest_of(path, mission, np.random.default_rng(4))
    assert slowest <= bound.bound
    assert bound.bound <= tight * max(slowest, bound.found)
    again = least_costs(path.table(np.array([bound.errors])), mission)[0]
    assert again == pytest.approx(bound.found, abs=1e-9)


@pytest.mark.parametrize(
    "change", [{"tolerance": 0.0}, {"tolerance": 0.05}, {"goal_heading": 1.2, "heading_tolerance": 0.3}]
)
def test_exact_goals_and_wanted_headings_have_a_bound_of_their_time(change: dict[str, float]) -> None:
    library = thesis_gtmax()
    mission = replace(read_mission(MISSIONS / "gtmax-1.toml"), **change)  # type: ignore[arg-type]
    plan = worst_case_planner(library, 0.2).plan(mission)
    path = error_path(library, plan.sequence, 0.2, "primitive")
    bound = worst_time_bound(path, mission, BoundedMaximum(plan.cost, (), inf, 0), most=1000)
    slowest = slowest_of(path, mission, np.random.default_rng(6))
    assert slowest <= bound.bound < inf


def slowest_of(path: ErrorPath, mission: Mission, rng: np.random.Generator) -> float:
    """Returns the largest least time over randomly drawn errors."""
    drawn = rng.uniform(-1, 1, (2000, len(path.names)))
    drawn[:500] = np.sign(drawn[:500])
    return float(least_costs(path.table(drawn), mission).max())


def test_single_gamma_corners_and_bound_are_in_order() -> None:
    library, mission = thesis_gtmax(), read_mission(MISSIONS / "gtmax-1.toml")
    plan = worst_case_planner(library, 0.1).plan(mission)
    for each in ("primitive", "scalar"):
        found = bound_independent_errors(
            library, mission, plan.sequence, plan.coasting_times, gamma=0.1, each=each
        )
        assert found.slowest_single.value == pytest.approx(plan.cost, abs=1e-6)
        assert found.slowest_single.value <= found.slowest.value + 1e-9
        assert found.slowest.value <= found.slowest_bound.found + 1e-9
        assert found.slowest_bound.found <= found.slowest_bound.bound
        assert found.furthest_single.value <= found.furthest.value + 1e-9
        assert found.furthest.value <= found.furthest_bound.bound
        assert found.all_tried == (each == "primitive")


@pytest.mark.parametrize(("name", "gamma"), [("gtmax-1", 0.5), ("gtmax-2", 1.0)])
def test_no_draw_in_a_box_takes_longer_than_the_bound_of_the_box(name: str, gamma: float) -> None:
    rng = np.random.default_rng(12)
    library, mission = thesis_gtmax(), read_mission(MISSIONS / f"{name}.toml")
    path = error_path(library, worst_case_planner(library, gamma).plan(mission).sequence, gamma, "scalar")
    answers, count = BoxEvaluator(path, mission), len(path.names)
    width = rng.uniform(0.05, 0.6, (60, 1)) * rng.uniform(0, 1, (60, count))
    middle = (1 - width) * rng.choice([-1.0, 1.0], (60, count))
    boxes = BoundedBoxes(middle - width, middle + width, np.full(60, inf))
    for look in (answers.fine_bounds(boxes, 0.0), answers.coarse_bounds(boxes, 0.0)):
        assert np.isfinite(look.bound).sum() > 20
        for box in np.flatnonzero(np.isfinite(look.bound)).tolist():
            drawn = rng.uniform(-1, 1, (200, count))
            drawn[::2] = np.sign(drawn[::2])
            costs = answers.costs(middle[box] + drawn * width[box])
            assert costs.max() <= look.bound[box] + 1e-6


def test_boxes_that_are_good_enough_count_for_the_bound() -> None:
    """A wide gap needs no halving: the first bound holds."""
    library, mission = thesis_gtmax(), read_mission(MISSIONS / "gtmax-1.toml")
    plan = worst_case_planner(library, 0.3).plan(mission)
    path = error_path(library, plan.sequence, 0.3, "primitive")
    bound = worst_time_bound(path, mission, BoundedMaximum(plan.cost, (), inf, 0), gap=0.5)
    assert bound.boxes == 1
    assert bound.bound > 1.001 * bound.found


def test_times_that_errors_make_negative_prove_nothing() -> None:
    """Short coasts cannot compensate errors; other times must."""
    rng, never = np.random.default_rng(3), 0
    for _ in range(120):
        turns = str(rng.choice(["ts", "st", "sts", "tst"]))
        path = error_path(wandering(rng, turns), tuple(range(1, len(turns) + 1)), 1.0, "scalar")
        count = len(path.names)
        width = rng.uniform(0.05, 0.4) * rng.uniform(0, 1, (1, count))
        middle = (1 - width) * rng.uniform(-1, 1, (1, count))
        goal = complex(path.at(middle).end(rng.uniform(0, 1, (1, len(turns))))[0])
        mission = Mission("near", SE2.identity(), 1, (goal.real, goal.imag), tolerance=0.0)
        answers = BoxEvaluator(path, mission)
        bound = answers.fine_bounds(BoundedBoxes(middle - width, middle + width, np.full(1, inf)), 0.0).bound[
            0
        ]
        drawn = rng.uniform(-1, 1, (300, count))
        drawn[::2] = np.sign(drawn[::2])
        assert answers.costs(middle + drawn * width).max() <= bound + 1e-6
        never += int(bound == inf)
    assert never < 120
