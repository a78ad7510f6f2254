"""Tests of slow turns: exact at 0.1 and 1e-9 rad/s."""

from dataclasses import replace
from math import inf, pi

import numpy as np
import pytest

from experiments.thesis.printed_libraries import thesis_gtmax
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.plan.certificate import Certificate
from flight.se2 import SE2, Twist
from planner.check.certificate_check import certificate_problems
from planner.kernel.exact import ExactSearch
from planner.policies.nominal import nominal_planner
from planner.policies.worst_case import worst_case_planner
from planner.proof.certify import certify
from planner.proof.certify_plan import certify_plan
from planner.walks.goal_condition import reaches_goal
from planner.walks.kinematics import walk_motion
from planner.walks.walk import trims_of_walks, walks

STILL = Twist(0.0, 0.0, 0.0)
CERTAIN = ManeuverError(0.0, 0.0, 0.0, 0.0)

FAR = Mission(
    "18 km",
    SE2(0.0, 0.0, -2.0274672477455464),
    3,
    (-8016.109846178343, -16324.344201472735),
    0.9144,
    max_trims=3,
    goal_heading=-2.2362638111751263,
    heading_tolerance=0.3,
)

FARTHER = Mission(
    "16 km",
    SE2(0.0, 0.0, -1.1174551866327418),
    2,
    (731.2543488556502, -16278.410287835408),
    3.0,
    max_trims=4,
    goal_heading=0.12142923139658279,
    heading_tolerance=0.05,
)

KNOWN = (
    (FAR, 0.001, (3, 6, 3), 5979.7034),
    (replace(FAR, name="heading free", goal_heading=None), 0.001, (3, 6, 3), 5979.7034),
    (FARTHER, 0.003, (2, 5, 2, 5), 19554.7),
)
"""Missions, gammas, and ways there that an independent search found, with their worst seconds."""


def library_of(*rates: float, speeds: tuple[float, ...], turns: tuple[float, ...]) -> Library:
    """Returns trims of these yaw rates and speeds, all joined both ways."""
    trims = tuple(
        Trim(number, f"trim {number}", Twist(speed, 0.0, rate), STILL)
        for number, (rate, speed) in enumerate(zip(rates, speeds, strict=True), start=1)
    )
    pairs = [(one, other) for one in trims for other in trims if one is not other]
    return Library(
        "slow",
        "by hand",
        "",
        trims,
        tuple(
            Maneuver(number, one.id, other.id, 2.0, SE2(one.velocity.forward + 1.0, 0.5, turn), CERTAIN)
            for number, ((one, other), turn) in enumerate(zip(pairs, turns, strict=True), start=1)
        ),
    )


def random_rate(rng: np.random.Generator) -> float:
    """Returns 0, a slow or a fast yaw rate."""
    kind = rng.random()
    if kind < 0.15:
        return 0.0
    size = 10 ** rng.uniform(-9, -2) if kind < 0.7 else rng.uniform(0.03, 0.4)
    return float(rng.choice([-1, 1]) * size)


@pytest.mark.parametrize(("mission", "gamma", "walk", "seconds"), KNOWN)
def test_a_plan_of_hours_is_no_slower_than_a_way_that_is_known(
    mission: Mission, gamma: float, walk: tuple[int, ...], seconds: float
) -> None:
    plan = worst_case_planner(thesis_gtmax(), gamma).plan(mission)
    assert plan.status == "optimal"
    assert plan.cost <= seconds, walk


def test_a_straight_trim_that_errs_by_a_hair_is_planned_with_to_the_tolerances_edge() -> None:
    """The 18 km of `FAR`, with times of another search."""
    library, walk, times = thesis_gtmax(), (3, 6, 3), (1729.0350925, 7.3674557, 4237.2986192)
    numbers = walk_motion(library, walk, -0.001)
    mission = replace(FAR, tolerance=FAR.tolerance + 1e-3)
    assert reaches_goal(numbers.end(mission.start, times), mission)
    assert max(ExactSearch(library, (-0.001,)).answer(mission).costs) <= numbers.cost(times)


@pytest.mark.parametrize("seed", range(60))
def test_a_plan_is_never_slower_than_a_way_that_was_flown(seed: int) -> None:
    """Goals at random walks' ends, 1 m to 20 km away."""
    rng = np.random.default_rng([31, seed])
    for _ in range(10):
        rates = [random_rate(rng) for _ in range(3)]
        if rng.random() < 0.3:
            rates[2] = rates[0]
        speeds = tuple(float(speed) for speed in rng.choice([rng.uniform(0.5, 30), 5.0, 12.0], 3))
        library = library_of(*rates, speeds=speeds, turns=tuple(rng.uniform(-0.6, 0.6, 6)))
        every = walks(library, 1, max_trims=3)
        walk = every[int(rng.integers(len(every)))]
        numbers = walk_motion(library, walk, 0.0)
        longest = 10 ** rng.uniform(0, 3.2)
        times = tuple(
            float(min(rng.exponential(longest), 6.0 / max(abs(twist.yaw_rate), 1e-12)) * (rng.random() < 0.8))
            for twist in numbers.velocities
        )
        start = SE2(3.0, -4.0, float(rng.uniform(-pi, pi)))
        end = numbers.end(start, times)
        tolerance = float(rng.choice([0.0, 0.01, 1.0, 3.0]))
        mission = Mission("flown", start, 1, end.position, tolerance, max_trims=3)
        if rng.random() < 0.3:
            width = float(rng.choice([0.0, 0.01, 0.3]))
            mission = replace(mission, goal_heading=end.heading, heading_tolerance=width)
        answer = ExactSearch(library, (0.0,)).answer(mission)
        if answer.exhausted:
            assert max(answer.costs, default=inf) <= numbers.cost(times) + 1e-4, (
                library,
                mission,
                walk,
                times,
            )


@pytest.mark.parametrize("start_trim", range(1, 8))
def test_the_trims_of_all_walks_are_known_without_listing_the_walks(start_trim: int) -> None:
    library = thesis_gtmax()
    for max_trims in range(1, 5):
        for goal_trim in (None, 1, 7):
            every = walks(library, start_trim, max_trims=max_trims, goal_trim=goal_trim)
            expected = {trim for walk in every for trim in walk}
            found = trims_of_walks(library, start_trim, max_trims=max_trims, goal_trim=goal_trim)
            assert found == expected


@pytest.mark.parametrize(("slow", "status"), [(3, "infeasible"), (1, "unknown")])
def test_only_a_slow_turn_that_a_walk_can_hold_leaves_a_doubt(slow: int, status: str) -> None:
    """Unreachable slow trims leave an infeasible mission proved."""
    library = library_of(0.0, 0.1, 0.1, speeds=(5.0, 5.0, 5.0), turns=(0.0,) * 6)
    rates = {slow: 1e-9}
    library = replace(
        library,
        trims=tuple(
            replace(
                trim, velocity=replace(trim.velocity, yaw_rate=rates.get(trim.id, trim.velocity.yaw_rate))
            )
            for trim in library.trims
        ),
    )
    aside = Mission("aside", SE2.identity(), 1, (0.0, 20.0), 0.5, max_trims=1)
    plan = nominal_planner(library).plan(aside)
    assert plan.status == status
    assert ("trim 1 turns so slowly" in plan.reason) == (status == "unknown")


@pytest.mark.parametrize("rate", [1e-17, 1e-12, -1e-9, 1e-8, -1e-6])
@pytest.mark.parametrize("tolerance", [0.0, 3.0])
def test_a_turn_too_slow_to_show_is_certified_as_a_straight_line(rate: float, tolerance: float) -> None:
    library = library_of(0.1, 0.0, rate, speeds=(3.0, 2.0, 3.0), turns=(0.0, 0.1, 0.0, -0.1, 0.2, 0.0))
    mission = Mission("short", SE2.identity(), 1, (11.0, -6.0), tolerance, max_trims=2)
    plan = certify_plan(nominal_planner(library).plan(mission), library, mission)
    assert plan.status == "optimal", plan.reason


def test_certificates_are_valid_where_slow_turns_count_as_straight_lines() -> None:
    library = library_of(0.1, 0.0, 1e-9, speeds=(3.0, 2.0, 3.0), turns=(0.0, 0.1, 0.0, -0.1, 0.2, 0.0))
    mission = Mission("short", SE2.identity(), 1, (11.0, -6.0), 0.5, max_trims=2)
    plan = nominal_planner(library).plan(mission)
    proof = certify(library, mission, (0.0,), plan.cost - 1e-3)
    assert isinstance(proof, Certificate)
    assert not certificate_problems(proof, library, mission, gammas=(0.0,), lower_bound=plan.cost - 1e-3)
    assert certificate_problems(proof, library, mission, gammas=(0.0,), lower_bound=plan.cost + 1e-3)
    assert not isinstance(certify(library, mission, (0.0,), plan.cost + 1e-3), Certificate)
