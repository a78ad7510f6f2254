"""Time bounds of plans, found by flights and stored beside a library."""

import sys
from dataclasses import replace

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from flight.errors import BadFileError
from flight.mission.mission import MAX_TRIMS, Mission
from flight.plan.plan import Plan
from flight.plan.time_bound import TimeBound, read_time_bounds, time_bounds_path
from planner.check.plan_check import PROVED_OPTIMALITY
from planner.closed_loop.remaining_plan import PlanStep
from planner.closed_loop.settings import Settings
from planner.policies.policy import Planner
from scenarios.find import library_path

from .policies import CERTIFIABLE, planner_of
from .random_missions import FARTHEST, NEAREST, TOLERANCE

PATIENCE = 10.0
"""Search time for a lower bound of the predicted time, s; the bound holds whenever the search stops."""


def stated_time_bounds(name: str, library: Library) -> tuple[TimeBound, ...]:
    """Returns the time bounds beside a library; none with a warning.

    Args:
        name: name or path of the library.
        library: the library.
    """
    path = library_path(name)
    try:
        found = read_time_bounds(path, library_hash=library_hash(library))
    except BadFileError as error:
        print(f"{error}; no time bound is stated", file=sys.stderr)
        return ()
    if found is None:
        print(
            f"{time_bounds_path(path).name} is for another library: no time bound is stated",
            file=sys.stderr,
        )
    return found or ()


def with_time_bound(
    plan: Plan, mission: Mission, planner: Planner, library: Library, time_bounds: tuple[TimeBound, ...]
) -> Plan:
    """Returns the plan with its time bound, where one applies.

    Bounds were found for missions without goal heading and goal trim, `NEAREST` to `FARTHEST` away, in the
    library's wind and with one tolerance; smaller tolerances take longer. The closed loop aims inside the
    tolerance and has planning latency.

    Args:
        plan: plan for the mission.
        mission: the mission.
        planner: planner of the plan.
        library: library of the plan.
        time_bounds: time bounds beside the library.
    """
    own = _time_bound_of(plan, mission, library, time_bounds)
    if own is None:
        return plan
    latency, aimed_at = _planned_mission(mission, library)
    aimed = planner.plan(aimed_at)
    if not aimed.found:
        return plan
    return replace(plan, time_promise=replace(own, time=own.factor * (latency + aimed.cost)))


def time_bound_problems(
    plan: Plan, mission: Mission, library: Library, time_bounds: tuple[TimeBound, ...]
) -> tuple[str, ...]:
    """Returns the problems of a plan's time bound.

    Its time must be at least the factor times a lower bound of the predicted time, for any length of
    sequence; a longer time is valid.

    Args:
        plan: plan with a time bound.
        mission: mission of the plan.
        library: library of the plan.
        time_bounds: time bounds beside the library.
    """
    bound = plan.time_promise
    if bound is None:
        return ()
    problems = _mismatches(plan, bound, mission, library, time_bounds)
    if problems or not time_bounds or bound.time is None or plan.policy not in CERTIFIABLE:
        return problems
    planner = planner_of(plan.policy, library, gamma=plan.gamma, deadline=PATIENCE)
    latency, aimed_at = _planned_mission(replace(mission, max_trims=MAX_TRIMS), library)
    least = bound.factor * (latency + (planner.plan(aimed_at).lower_bound or 0.0))
    if bound.time >= least - bound.factor * PROVED_OPTIMALITY:
        return ()
    return (
        f"time_promise.time: expected at least {least:.3f} s (factor times the predicted time), "
        f"got {bound.time:.3f} s",
    )


def _mismatches(
    plan: Plan, bound: TimeBound, mission: Mission, library: Library, time_bounds: tuple[TimeBound, ...]
) -> tuple[str, ...]:
    """Returns a problem if the bound is not the library's."""
    if (bound.policy, bound.gamma) != (plan.policy, plan.gamma):
        expected = f"a bound for {plan.policy} plans at gamma {plan.gamma:g}"
        return (f"time_promise: expected {expected}, got {bound.policy} at gamma {bound.gamma:g}",)
    if time_bounds and replace(bound, time=None) != _time_bound_of(plan, mission, library, time_bounds):
        return (f"time_promise: expected a time bound of {library.name} for this plan, got {bound.source}",)
    return ("time_promise.time: is missing",) if time_bounds and bound.time is None else ()


def _time_bound_of(
    plan: Plan, mission: Mission, library: Library, time_bounds: tuple[TimeBound, ...]
) -> TimeBound | None:
    """Returns the time bound that applies to the plan, if any."""
    constrained = (mission.goal_heading, mission.goal_trim) != (None, None)
    far = not NEAREST <= mission.start.distance_to(mission.goal) <= FARTHEST
    if not plan.found or constrained or far or mission.tolerance < TOLERANCE:
        return None
    flown = (plan.policy, plan.gamma, library.conditions.wind)
    return next((one for one in time_bounds if (one.policy, one.gamma, one.wind) == flown), None)


def _planned_mission(mission: Mission, library: Library) -> tuple[float, Mission]:
    """Returns the planning latency in seconds, and the mission planned after it."""
    loop = Settings()
    latency = PlanStep(mission.start_trim, loop.latency.configured)
    start = latency.exit(mission.start, library, 0.0)
    return latency.duration, replace(mission, start=start, tolerance=loop.aim * mission.tolerance)
