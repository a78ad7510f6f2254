"""Tests of certificates: proved bounds hold, false ones are refused."""

from dataclasses import replace
from functools import cache
from math import cos, inf, pi, sin
from pathlib import Path

import numpy as np
import pytest

import libraries
from experiments.thesis.printed_libraries import thesis_gtmax, thesis_kinematic
from flight.automaton.library import Library
from flight.automaton.library_file import read_library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission, read_mission
from flight.plan.certificate import Certificate, read_tree, write_tree
from flight.plan.plan import Plan, plan_text, read_plan
from flight.se2 import SE2, Twist
from maneuver.app import run
from planner.check.certificate_check import certificate_problems
from planner.check.certified_bound import Leaves
from planner.check.certified_bound import dual_bound as proved_bound
from planner.check.interval_walk import interval_walk
from planner.check.plan_check import plan_problems
from planner.policies.nominal import nominal_planner
from planner.policies.price_of_robustness import PriceOfRobustness
from planner.policies.worst_case import worst_case_planner
from planner.proof.certify import certify
from planner.proof.certify_plan import NotProvableError, certify_plan
from planner.proof.dual_bound import Multipliers, WalkProblems, dual_bound
from planner.walks.kinematics import walk_motion
from planner.walks.walk import walks
from scenarios.find import MISSIONS

LIBRARIES = ("thesis-kinematic", "thesis-gtmax", "gtmax-sim")


@cache
def shipped(place: int) -> Library:
    return read_library(libraries.FOLDER / f"{LIBRARIES[place]}.json")


@cache
def gtmax() -> tuple[Plan, Library, Mission]:
    library, mission = thesis_gtmax(), read_mission(MISSIONS / "gtmax-1.toml")
    return certify_plan(worst_case_planner(library, 0.5).plan(mission), library, mission), library, mission


def a_walk(rng: np.random.Generator) -> tuple[Library, tuple[int, ...], float, tuple[float, ...], Mission]:
    """Returns a random walk with its times, library and mission."""
    library = shipped(int(rng.integers(3)))
    gamma = float(rng.choice([0.0, 0.3, -1.0, 1.0]))
    start = int(rng.choice([trim.id for trim in library.trims]))
    every = walks(library, start, max_trims=4)
    walk = every[int(rng.integers(len(every)))]
    times = tuple(float(time) for time in rng.exponential(4.0, len(walk)) * (rng.random(len(walk)) < 0.7))
    pose = SE2(float(rng.uniform(-5, 5)), 2.0, float(rng.uniform(-3, 3)))
    end = walk_motion(library, walk, gamma).end(pose, times)
    tolerance, angle = float(rng.choice([0.0, 0.5, 3.0])), float(rng.uniform(-pi, pi))
    aside = float(rng.uniform(0, 1)) * tolerance
    goal = end.x + aside * cos(angle), end.y + aside * sin(angle)
    mission = Mission("there", pose, start, goal, tolerance)
    if rng.random() < 0.3:
        width = float(rng.uniform(0, 1))
        wanted = end.heading + float(rng.uniform(-1, 1)) * width + 2 * pi * float(rng.integers(-2, 3))
        mission = replace(mission, goal_heading=wanted, heading_tolerance=width)
    return library, walk, gamma, times, mission


def around(
    rng: np.random.Generator, times: tuple[float, ...], longest: list[float]
) -> tuple[np.ndarray, ...]:
    """Returns a box around the times, some of its sides far away."""
    wide = 10 ** rng.uniform(-3, 1, (2, len(times)))
    low = np.maximum(np.array(times) - wide[0], 0.0)
    high = np.array(times) + wide[1]
    high = np.where(np.isinf(longest) & (rng.random(len(times)) < 0.2), inf, high)
    return low[None], high[None]


@pytest.mark.parametrize("seed", range(300))
def test_no_multipliers_refute_a_box_from_which_the_goal_is_reached(seed: int) -> None:
    rng = np.random.default_rng(seed)
    library, walk, gamma, times, mission = a_walk(rng)
    numbers = interval_walk(library, walk, gamma)
    low, high = around(rng, times, [place.longest for place in numbers.places])
    cost = walk_motion(library, walk, gamma).cost(times)
    for kappa in (0.0, 1.0):
        vector = rng.normal(0, 0.5, 2)
        shares = np.where(
            [place.rate is None for place in numbers.places], times, rng.normal(1, 1, len(walk))
        )
        leaf = Leaves(low, high, np.array([kappa]), vector[:1], vector[1:], shares[None])
        found = proved_bound(numbers, leaf, mission)[0]
        assert found <= kappa * cost + 1e-12
        by = Multipliers(np.array([kappa]), np.array([complex(*vector)]), shares[None])
        guessed = dual_bound(WalkProblems.of([walk_motion(library, walk, gamma)], mission), low, high, by)[0]
        assert guessed == pytest.approx(found, abs=1e-5)


def test_the_bound_of_a_single_point_is_the_cost() -> None:
    rng = np.random.default_rng(1)
    library, walk, gamma, times, mission = a_walk(rng)
    point = np.array([times])
    leaf = Leaves(point, point, np.ones(1), np.zeros(1), np.zeros(1), np.zeros((1, len(walk))))
    found = proved_bound(interval_walk(library, walk, gamma), leaf, mission)[0]
    assert found == pytest.approx(walk_motion(library, walk, gamma).cost(times), abs=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_plans_are_proved_and_a_millisecond_more_is_not(seed: int) -> None:
    rng = np.random.default_rng(seed)
    library, gamma = shipped(seed % 3), float(rng.choice([0.1, 0.5, 1.0]))
    mission = Mission(
        "proved",
        SE2.identity(),
        int(rng.choice([trim.id for trim in library.trims])),
        (float(rng.uniform(-30, 30)), float(rng.uniform(-30, 30))),
        float(rng.choice([0.0, 0.5])),
        max_trims=3,
    )
    plan = certify_plan(worst_case_planner(library, gamma).plan(mission), library, mission)
    assert plan.status == "optimal"
    assert plan.certificate is not None
    assert plan.lower_bound is not None
    assert plan.cost - 1e-3 <= plan.lower_bound <= plan.cost
    assert plan_problems(plan, library, mission) == ()
    levels, above = (0.0, -gamma, gamma), plan.cost + 1e-4
    assert certificate_problems(plan.certificate, library, mission, gammas=levels, lower_bound=above)


def test_a_certificate_survives_its_file(tmp_path: Path) -> None:
    plan, library, mission = gtmax()
    path = tmp_path / "plan.json"
    path.write_text(plan_text(plan))
    again = read_plan(path)
    assert again.certificate == plan.certificate
    assert plan_problems(again, library, mission) == ()


def test_a_tree_survives_its_text() -> None:
    plan, _, _ = gtmax()
    assert plan.certificate is not None
    for one in plan.certificate.refutations:
        assert write_tree(read_tree(one.tree)) == one.tree


@pytest.mark.parametrize(
    "token", ["2<", "<3", "2:1,1;0", "1:1;0", "1:nan,0;0", "0:-1.9e153,1;1", "1:1,1", "x", "1:1,1;"]
)
def test_a_torn_tree_is_refused(token: str) -> None:
    with pytest.raises(ValueError, match="expected a node such as"):
        read_tree(f"0<1.0 {token}")


def test_where_there_is_no_way_that_is_proved_too() -> None:
    # Behind the start, with one trim that flies straight on.
    mission = Mission("behind", SE2.identity(), 2, (-10.0, 1.0), 0.5, max_trims=1)
    library = thesis_kinematic()
    plan = certify_plan(worst_case_planner(library, 0.5).plan(mission), library, mission)
    assert plan.status == "infeasible"
    assert plan_problems(plan, library, mission) == ()
    ahead = replace(mission, goal=(10.0, 0.0))
    assert any("not refuted" in problem for problem in plan_problems(plan, library, ahead))


def test_a_turn_that_its_error_cancels_is_a_straight_line_in_every_proof() -> None:
    """At gamma 1 the trim flies straight past the goal, for as long as it likes."""
    turn = Trim(1, "turn", Twist(7.0, 0.0, 0.1), Twist(0.0, 0.0, -0.1))
    library = Library("cancelled", "", "", (turn,), ())
    mission = Mission("abeam", SE2.identity(), 1, (30.0, 9.0), 0.5, max_trims=1)
    plan = certify_plan(worst_case_planner(library, 1.0).plan(mission), library, mission)
    assert (plan.status, plan.reason) == (
        "infeasible",
        "no walk of at most 1 trims leads to the goal, proved",
    )
    assert plan_problems(plan, library, mission) == ()


def test_a_plan_that_is_not_the_best_is_not_certified() -> None:
    library, mission = thesis_kinematic(), Mission("slow", SE2.identity(), 1, (30.0, 12.0), 0.0)
    best = nominal_planner(library).plan(mission)
    slower = nominal_planner(library).plan(replace(mission, max_trims=2))
    assert slower.cost > best.cost + 0.01
    doubted = certify_plan(slower, library, mission)
    assert doubted.status == "feasible"
    assert doubted.certificate is None
    assert "may be faster" in doubted.reason


def test_a_proof_for_fewer_trims_is_no_proof_for_more() -> None:
    plan, library, mission = gtmax()
    deeper = replace(mission, max_trims=mission.max_trims + 1)
    assert any("covers walks of" in problem for problem in plan_problems(plan, library, deeper))


def test_the_price_of_robustness_has_no_certificate() -> None:
    library, mission = thesis_gtmax(), read_mission(MISSIONS / "gtmax-1.toml")
    plan = replace(PriceOfRobustness(library, 1.0).plan(mission), policy="price-of-robustness")
    with pytest.raises(NotProvableError, match="one of nominal, worst-case"):
        certify_plan(plan, library, mission)


def lonely(*trims: Twist) -> Library:
    """Returns a library of trims of these velocities, in a ring."""
    still = Twist(0.0, 0.0, 0.0)
    every = tuple(Trim(place, f"trim {place}", one, still) for place, one in enumerate(trims, start=1))
    none = ManeuverError(0.0, 0.0, 0.0, 0.0)
    joined = [(one.id, one.id % len(every) + 1) for one in every] if len(every) > 1 else []
    between = tuple(
        Maneuver(number, *ends, 1.0, SE2(0.5, 0.1, 0.2), none) for number, ends in enumerate(joined, start=1)
    )
    return Library("lonely", "made for a test", "", every, between)


HOVER, AHEAD, ASTERN = Twist(0.0, 0.0, 0.0), Twist(2.0, 0.0, 0.0), Twist(-2.0, 0.0, 0.0)
PIVOT, LEFT = Twist(0.0, 0.0, 0.5), Twist(2.0, 0.0, -0.4)


@pytest.mark.parametrize(
    "trims",
    [(HOVER,), (AHEAD,), (PIVOT,), (LEFT,), (HOVER, PIVOT), (AHEAD, ASTERN), (AHEAD, PIVOT), (LEFT, HOVER)],
)
@pytest.mark.parametrize("goal", [(0.0, 0.0), (5.0, 0.0), (-5.0, 0.3), (0.2, 9.0)])
@pytest.mark.parametrize("tolerance", [0.0, 0.6])
def test_odd_libraries_give_a_proof_or_an_unproved_status(
    trims: tuple[Twist, ...], goal: tuple[float, float], tolerance: float
) -> None:
    library = lonely(*trims)
    mission = Mission("odd", SE2.identity(), 1, goal, tolerance, max_trims=3)
    plan = certify_plan(nominal_planner(library).plan(mission), library, mission)
    assert plan.status in {"optimal", "infeasible"}
    assert plan_problems(plan, library, mission) == ()


def test_a_certificate_of_plan_is_verified_by_plan_check(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "plan.json"
    command = ["plan", "kinematic-1", "--library", "thesis-kinematic", "--certify", "--out", str(path)]
    assert run(command) == 0
    assert "certified" in capsys.readouterr().out
    assert run(["plan", "check", str(path)]) == 0
    assert run(["plan", "check", str(path), "--max-trims", "5"]) == 1
    assert "covers walks of at most 4 trims" in capsys.readouterr().out


def test_no_certificate_without_walks() -> None:
    library = lonely(AHEAD, LEFT)
    mission = Mission("elsewhere", SE2.identity(), 1, (3.0, 0.0), 0.1, goal_trim=2, max_trims=1)
    assert certify(library, mission, (0.0,), inf) == Certificate(1, ())
