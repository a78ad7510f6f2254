"""Tests of plans under scaled units of length and time."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.se2 import SE2, Twist
from planner.check.plan_check import plan_problems
from planner.kernel import build
from planner.policies.worst_case import worst_case_planner

pytestmark = pytest.mark.skipif(build.load_kernel() is None, reason="this machine has no C compiler")


def twist(velocity: Twist, length: float, time: float) -> Twist:
    return Twist(velocity.forward * length / time, velocity.side * length / time, velocity.yaw_rate / time)


def scaled(library: Library, length: float, time: float) -> Library:
    """Returns the library with scaled metres and seconds."""
    trims = tuple(
        replace(one, velocity=twist(one.velocity, length, time), error=twist(one.error, length, time))
        for one in library.trims
    )
    maneuvers = tuple(
        replace(
            one,
            duration=one.duration * time,
            displacement=SE2(
                one.displacement.x * length, one.displacement.y * length, one.displacement.heading
            ),
            error=replace(
                one.error,
                duration=one.error.duration * time,
                forward=one.error.forward * length,
                side=one.error.side * length,
            ),
        )
        for one in library.maneuvers
    )
    return replace(library, trims=trims, maneuvers=maneuvers)


def random_library(rng: np.random.Generator) -> Library:
    rates = rng.permutation([0.0, 0.0, 0.4, float(rng.uniform(-0.6, 0.6))])
    trims = tuple(
        Trim(
            place + 1,
            f"{place + 1}",
            Twist(float(rng.uniform(1, 5)), float(rng.choice([0.0, rng.uniform(-2, 2)])), float(rate)),
            Twist(0.1, 0.0, 0.02 if rate else 0.0),
        )
        for place, rate in enumerate(rates)
    )
    pairs = [(one.id, two.id) for one in trims for two in trims if one.id != two.id]
    maneuvers = tuple(
        Maneuver(
            place,
            *pair,
            2.0,
            SE2(*rng.uniform((-1, -1, -0.5), (3, 3, 0.5)).tolist()),
            ManeuverError(-0.1, 0.1, 0.1, 0.02),
        )
        for place, pair in enumerate(pairs, start=1)
    )
    return Library("random", "", "", trims, maneuvers)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(
    ("length", "time"), [(1e-4, 1.0), (1e5, 1.0), (1.0, 1e-4), (1.0, 1e5), (1e9, 1e2), (3e15, 1e8)]
)
def test_a_plan_is_the_same_in_every_unit(length: float, time: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    library = random_library(rng)
    mission = Mission(
        "scaled",
        SE2(3.0, -1.0, float(rng.uniform(-pi, pi))),
        1,
        tuple(rng.uniform(-40, 40, 2).tolist()),
        float(rng.choice([0.0, 2.0])),
        max_trims=3,
    )
    if seed % 2:
        mission = replace(mission, goal_heading=1.0, heading_tolerance=0.2)
    here = worst_case_planner(library, 0.5).plan(mission)
    there = replace(
        mission,
        start=SE2(mission.start.x * length, mission.start.y * length, mission.start.heading),
        goal=(mission.goal[0] * length, mission.goal[1] * length),
        tolerance=mission.tolerance * length,
    )
    plan = worst_case_planner(scaled(library, length, time), 0.5).plan(there)
    assert plan.status == here.status, plan.reason
    assert plan.cost == pytest.approx(here.cost * time, rel=1e-5 if length < 1 else 1e-9)
    assert plan.sequence == here.sequence
    assert plan_problems(plan, scaled(library, length, time), there) == ()


@pytest.mark.parametrize("angle", [1e-2, 1e-5, 1e-8])
@pytest.mark.parametrize("speed", [1e-3, 1.0, 1e6])
def test_straight_trims_that_are_nearly_parallel_divide_the_way(angle: float, speed: float) -> None:
    ahead, aside = Twist(speed, 0.0, 0.0), Twist(speed, speed * angle, 0.0)
    still = Twist(0.0, 0.0, 0.0)
    step = Maneuver(1, 1, 2, 1.0, SE2.identity(), ManeuverError(0.0, 0.0, 0.0, 0.0))
    library = Library("parallel", "", "", (Trim(1, "1", ahead, still), Trim(2, "2", aside, still)), (step,))
    goal = (3e3 * speed, 1e3 * speed * angle)
    mission = Mission("aside", SE2.identity(), 1, goal)
    plan = worst_case_planner(library, 0.0).plan(mission)
    assert plan.status == "optimal"
    assert plan.cost == pytest.approx(3001.0)
    # What the slack is worth in seconds aside.
    slack = mission.destination.slack / (speed * angle)
    assert plan.coasting_times == pytest.approx((2e3, 1e3), abs=slack + 1e-6)
