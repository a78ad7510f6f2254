"""A plan with the library and the mission that it was made for."""

from dataclasses import replace
from functools import cache

from experiments.thesis.printed_libraries import thesis_gtmax
from flight.automaton.library import Library
from flight.mission.mission import Mission, read_mission
from flight.plan.plan import Plan
from flight.se2 import SE2
from planner.policies.worst_case import worst_case_planner
from planner.proof.certify_plan import certify_plan
from scenarios.find import MISSIONS


@cache
def case() -> tuple[Plan, Library, Mission]:
    """Returns the worst case's plan for a shipped mission."""
    library = thesis_gtmax()
    mission = read_mission(MISSIONS / "gtmax-1.toml")
    plan = worst_case_planner(library, 0.5).plan(mission)
    # As compiled code calls it; a machine without a compiler does not.
    return replace(plan, status="optimal", reason="", lower_bound=plan.cost), library, mission


@cache
def proved_case() -> tuple[Plan, Library, Mission]:
    """Returns a plan of at most two trims with a certificate."""
    library = thesis_gtmax()
    mission = Mission("short", SE2.identity(), 3, (12.0, -9.0), 0.5, max_trims=2)
    return certify_plan(worst_case_planner(library, 0.5).plan(mission), library, mission), library, mission
