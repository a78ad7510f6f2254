"""Tests of goals on the edge of a tolerance."""

from collections.abc import Callable
from dataclasses import replace
from math import cos, pi, sin, sqrt

import pytest

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from flight.se2 import SE2, Twist, wrap_angle
from planner.check.plan_check import plan_problems
from planner.commitment.committed import CommittedPlanner
from planner.kernel import build
from planner.policies.nominal import nominal_planner
from planner.policies.policy import Planner
from planner.policies.worst_case import worst_case_planner
from planner.proof.certify_plan import certify_plan

needs_kernel = pytest.mark.skipif(build.load_kernel() is None, reason="this machine has no C compiler")

STILL = Twist(0.0, 0.0, 0.0)
NOTHING = ManeuverError(0.0, 0.0, 0.0, 0.0)

AHEAD = Library("ahead", "", "", (Trim(1, "ahead", Twist(1.0, 0.0, 0.0), STILL),), ())

WITH_A_TURN = replace(
    AHEAD,
    trims=(*AHEAD.trims, Trim(2, "turn", Twist(1.0, 0.0, 0.4), STILL)),
    maneuvers=(
        Maneuver(1, 1, 2, 1.0, SE2(1.0, 0.0, 0.0), NOTHING),
        Maneuver(2, 2, 1, 1.0, SE2(1.0, 0.0, 0.0), NOTHING),
    ),
)

EDGES: dict[str, tuple[Mission, float]] = {
    "heading": (Mission("heading", SE2.identity(), 1, (10.0, 0.0), 0.5, 0.5, 0.5), 9.5),
    "other side of the heading": (Mission("heading", SE2.identity(), 1, (10.0, 0.0), 0.5, -0.5, 0.5), 9.5),
    "aside": (Mission("aside", SE2.identity(), 1, (10.0, 2.0), 2.0), 10.0),
    "already there": (Mission("there", SE2.identity(), 1, (-0.5, 0.0), 0.5), 0.0),
    "already there, heading too": (Mission("there", SE2.identity(), 1, (-0.5, 0.0), 0.5, 0.3, 0.3), 0.0),
    "exactly there": (Mission("there", SE2.identity(), 1, (0.0, 0.0)), 0.0),
    "a micron": (
        Mission("micron", SE2.identity(), 1, (10.0, 3e-7), 1e-6),
        10.0 - sqrt(1e-12 - 9e-14),
    ),
}

POLICIES: dict[str, Callable[[Library], Planner]] = {
    "nominal": nominal_planner,
    "worst-case": lambda library: worst_case_planner(library, 0.5),
    "committed": lambda library: CommittedPlanner(library, 0.5),
}


def turned(mission: Mission, angle: float) -> Mission:
    """Returns the mission rotated, so that coordinates are inexact."""
    start = SE2(12.3, -45.6, angle)
    goal = start @ SE2(*mission.goal, 0.0)
    heading = None if mission.goal_heading is None else mission.goal_heading + angle
    return replace(mission, start=start, goal=goal.position, goal_heading=heading)


@needs_kernel
@pytest.mark.parametrize("policy", POLICIES)
@pytest.mark.parametrize("library", [AHEAD, WITH_A_TURN], ids=["straight", "with a turn"])
@pytest.mark.parametrize("edge", EDGES)
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_a_goal_on_the_edge_of_its_tolerance_is_reached(
    edge: str, library: Library, policy: str, angle: float
) -> None:
    mission, seconds = EDGES[edge]
    mission = replace(turned(mission, angle) if angle else mission, max_trims=len(library.trims))
    plan = POLICIES[policy](library).plan(mission)
    assert plan.status == "optimal", plan.reason
    if edge == "aside" and library is WITH_A_TURN:
        assert plan.cost < seconds
    else:
        # A touching end is resolved to the root of the slack, committed plans to their gap.
        assert plan.cost == pytest.approx(seconds, abs=5e-4 if policy == "committed" else 1e-4)
    assert plan_problems(plan, library, mission) == ()


def plan_of(mission: Mission) -> Plan:
    return certify_plan(nominal_planner(AHEAD).plan(mission), AHEAD, mission)


@needs_kernel
@pytest.mark.parametrize("edge", EDGES)
def test_a_goal_on_the_edge_is_proved(edge: str) -> None:
    mission, _ = EDGES[edge]
    plan = plan_of(replace(mission, max_trims=1))
    assert plan.status == "optimal", plan.reason
    assert plan_problems(plan, AHEAD, replace(mission, max_trims=1)) == ()


@needs_kernel
@pytest.mark.parametrize(("north", "east"), [(10.0, 2.0), (-2.0, 0.0), (-sqrt(2.0), sqrt(2.0))])
def test_a_goal_beyond_the_edge_is_proved_to_be_out_of_reach(north: float, east: float) -> None:
    within = Mission("edge", SE2.identity(), 1, (north, east), 2.0, max_trims=1)
    assert plan_of(within).status == "optimal"
    assert plan_of(replace(within, tolerance=2.0 - 1e-3)).status == "infeasible"
    assert nominal_planner(AHEAD).plan(replace(within, tolerance=2.0 - 1e-8)).status == "infeasible"


@needs_kernel
def test_a_heading_to_be_met_exactly_is_met_to_rounding() -> None:
    for heading in (0.1, 1.0, -2.0):
        mission = Mission("exactly", SE2.identity(), 1, (6.0, 3.0), 3.0, heading, 0.0, max_trims=2)
        plan = nominal_planner(WITH_A_TURN).plan(mission)
        assert plan.status == "optimal"
        assert wrap_angle(plan.deciding.end.heading - heading) == pytest.approx(0, abs=1e-12)


@needs_kernel
@pytest.mark.parametrize("goal", [(5.0, 0.0), (5 * cos(0.3), 5 * sin(0.3)), (2.5, -2.5)])
def test_a_goal_at_the_edge_of_reach_is_found(goal: tuple[float, float]) -> None:
    """Goal at the far side of a 2.5 m circle: double root."""
    turn = Library("turn", "", "", (Trim(1, "turn", Twist(1.0, 0.0, -0.4), STILL),), ())
    mission = Mission("far side", SE2(0.0, 0.0, pi / 2), 1, goal, max_trims=1)
    end = SE2(0.0, 0.0, pi / 2) @ SE2.exp(Twist(1.0, 0.0, -0.4), 3.0)
    assert nominal_planner(turn).plan(replace(mission, goal=end.position)).cost == pytest.approx(
        3.0, abs=1e-9
    )
    far = max(abs(complex(*goal) - 2.5) - 2.5, 0.0)
    assert (nominal_planner(turn).plan(mission).status == "optimal") == (far < 1e-12)
