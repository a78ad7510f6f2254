"""Tests of the reference planner: known optima, small steps, negative controls."""

from cmath import exp
from dataclasses import replace
from math import inf, pi, sqrt

import numpy as np
import pytest

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from flight.se2 import SE2, Twist
from planner.policies.nominal import nominal_planner
from tests.oracles.coasting_flow import fly
from tests.oracles.coasting_problem import all_walks, coasting_problems
from tests.oracles.committed_times import CommittedWalk
from tests.oracles.least_time import least_times
from tests.oracles.plan_judgement import flown_beyond, judge
from tests.support.planning.odd_missions import odd_case

EXACT = ManeuverError(0.0, 0.0, 0.0, 0.0)
HERE = SE2.identity()


def library(*velocities: tuple[float, float, float], steps: tuple[tuple[float, ...], ...] = ()) -> Library:
    """Trims 1, 2, ... joined in a row by maneuvers: duration, forward, side, heading change."""
    trims = tuple(
        Trim(number, "", Twist(*velocity), Twist(0.0, 0.0, 0.0))
        for number, velocity in enumerate(velocities, start=1)
    )
    moved = steps or ((0.0, 0.0, 0.0, 0.0),) * (len(trims) - 1)
    maneuvers = tuple(
        Maneuver(number, number, number + 1, step[0], SE2(*step[1:]), EXACT)
        for number, step in enumerate(moved, start=1)
    )
    return Library("reference", "", "", trims, maneuvers)


def least(one: Library, mission: Mission) -> float:
    walks = all_walks(one, mission)
    return float(least_times(one, mission, walks, 0.0, rng=np.random.default_rng(1)).cost.min(initial=inf))


AHEAD = (1.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("goal", "tolerance", "heading", "seconds"),
    [
        ((10.0, 0.0), 0.0, None, 10.0),
        ((10.0, 0.0), 0.5, None, 9.5),
        ((10.0, 2.0), 2.0, None, 10.0),
        ((-0.5, 0.0), 0.5, None, 0.0),
        ((10.0, 0.0), 0.5, (0.5, 0.5), 9.5),
        ((10.0, 0.0), 0.5, (0.5, 0.4), inf),
        ((10.0, 2.0), 1.9, None, inf),
    ],
)
def test_one_straight_coast_takes_what_a_ruler_says(
    goal: tuple[float, float], tolerance: float, heading: tuple[float, float] | None, seconds: float
) -> None:
    mission = Mission("straight", HERE, 1, goal, tolerance, max_trims=1)
    if heading is not None:
        mission = replace(mission, goal_heading=heading[0], heading_tolerance=heading[1])
    assert least(library(AHEAD), mission) == pytest.approx(seconds, abs=1e-12)


def test_a_turn_and_a_straight_coast_follow_the_tangent() -> None:
    # A circle of 6 m to the right, then straight on to a point abeam of its centre at 10 m.
    mission = Mission("tangent", HERE, 1, (10.0, 6.0), max_trims=2)
    turn = np.arccos(6 / 10)
    expected = (pi / 2 - turn) * 2.0 + sqrt(10**2 - 6**2) / 3
    assert least(library((3.0, 0.0, 0.5), (3.0, 0.0, 0.0)), mission) == pytest.approx(expected, abs=1e-9)


def test_a_turn_and_two_straight_coasts_are_shared_out() -> None:
    one = library(
        (3.0, 0.0, -0.4),
        (3.0, 0.0, 0.0),
        (-2.0, 0.0, 0.0),
        steps=(
            (2.0, 1.3003303548017833, 0.11372624087499039, -0.6749093461705712),
            (2.0, 2.290282280338653, 1.003321233580687, 0.35848091391652726),
        ),
    )
    goal = (-3.800585569445308, -11.406050611805465)
    mission = Mission("shared", HERE, 1, goal, 1.0, goal_trim=3, max_trims=3)
    assert least(one, mission) == pytest.approx(15.570738, abs=1e-5)


def test_coasts_at_one_yaw_rate_and_an_exact_heading_share_the_turn() -> None:
    one = library(
        (1.5888076732541556, 1.0, 0.3),
        (2.602675641346975, 0.0, 0.3),
        (-1.0, 0.0, 0.3),
        steps=((1.0, 0.0, -1.8373000695343864, 1.119718890440231), (0.0, 0.0, 0.02496306699768791, 0.0)),
    )
    mission = Mission(
        "one rate",
        SE2(0.0, 0.0, -0.9147405836481046),
        1,
        (6.017825671404803, 10.536178517942208),
        0.5,
        goal_heading=4.124208854854541,
        heading_tolerance=0.0,
        max_trims=3,
    )
    assert least(one, mission) == pytest.approx(14.064102, abs=1e-5)


@pytest.mark.parametrize("seed", range(5))
def test_the_flow_is_what_small_steps_lead_to(seed: int) -> None:
    rng = np.random.default_rng(seed)
    one = library(*((float(rng.uniform(-3, 3)), float(rng.normal()), rate) for rate in (0.0, 0.4, -1.1)))
    problem = coasting_problems(one, [(1, 2, 3)], 0.0)[3]
    times = rng.uniform(0, 4, 3)
    ends = fly(problem, times[None], (1 - 2j, 0.7))
    position, heading, count = 1 - 2j, 0.7, 4000
    for trim, time in zip(one.trims, times.tolist(), strict=True):
        velocity, step = complex(trim.velocity.forward, trim.velocity.side), time / count
        for _ in range(count):
            position += exp(1j * (heading + 0.5 * trim.velocity.yaw_rate * step)) * velocity * step
            heading += trim.velocity.yaw_rate * step
    assert ends.position[0] == pytest.approx(position, abs=1e-5)
    assert ends.heading[0] == pytest.approx(heading, abs=1e-9)
    mission = Mission("flown", SE2(1.0, -2.0, 0.7), 1, (position.real + 1, position.imag))
    beyond, _, _ = flown_beyond(one, mission, (1, 2, 3), tuple(times.tolist()), 0.0)
    assert beyond == pytest.approx(1.0, abs=1e-5)


def test_plans_that_are_slower_or_end_elsewhere_are_judged_wrong() -> None:
    seen = set()
    for number in range(30):
        case = odd_case(3, number)
        plan = nominal_planner(case.library).plan(case.mission)
        if not plan.found:
            continue
        for wrong in (circled(plan, case.library), mistaken(plan), shifted(plan), denied(plan)):
            found = judge(wrong, case.library, case.mission, rng=np.random.default_rng(number))
            assert found.fault == (wrong != plan), wrong
            seen.add(found.kind.split(",")[0])
    assert {"slower", "cost is not the sum of its times", "ends outside the disc", "false infeasible"} <= seen


def circled(plan: Plan, library: Library) -> Plan:
    """A plan with a full circle more, where a trim turns within minutes; it ends as before."""
    scenario = plan.scenarios[0]
    for place, trim in enumerate(plan.sequence):
        rate = abs(library.trim(trim).velocity.yaw_rate)
        if rate > 1e-2:
            times = list(scenario.coasting_times)
            times[place] += 2 * pi / rate
            cost = scenario.cost + 2 * pi / rate
            return replace(
                plan, scenarios=(replace(scenario, coasting_times=tuple(times), cost=cost),), lower_bound=cost
            )
    return plan


def mistaken(plan: Plan) -> Plan:
    """A plan that states a second too much."""
    scenario = plan.scenarios[0]
    return replace(plan, scenarios=(replace(scenario, cost=scenario.cost + 1),))


def shifted(plan: Plan) -> Plan:
    """A plan that coasts a second longer in its last trim."""
    scenario = plan.scenarios[0]
    times = (*scenario.coasting_times[:-1], scenario.coasting_times[-1] + 1)
    return replace(plan, scenarios=(replace(scenario, coasting_times=times),))


def denied(plan: Plan) -> Plan:
    """The word that there is no plan."""
    return replace(plan, status="infeasible", scenarios=(), sequence=(), maneuvers=(), lower_bound=None)


def test_committed_times_serve_every_level() -> None:
    error = Twist(0.1, 0.0, 0.0)
    one = Library("committed", "", "", (Trim(1, "", Twist(1.0, 0.0, 0.0), error),), ())
    walk = CommittedWalk(one, Mission("ahead", HERE, 1, (10.0, 0.0), 2.0, max_trims=1), (1,), 1.0)
    # The slowest level needs 8 m at 0.9 m/s, and the fastest goes no further than 12 m at 1.1 m/s.
    assert walk.fastest((10.0,)).cost == pytest.approx(8 / 0.9, abs=1e-6)
    assert walk.check((12.1 / 1.1,)).cost == inf
    assert walk.check((11.9 / 1.1,)).cost == pytest.approx(11.9 / 1.1)
