"""What is promised of plans: times that most flights keep, found by flying, that stand beside a library."""

import sys
from dataclasses import replace

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
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
"""Seconds of search for what the loop foretells at least; its lower bound holds whenever it is stopped."""


def stated_time_bounds(name: str, library: Library) -> tuple[TimeBound, ...]:
    """Returns the promises that stand beside a library; says so where they are of another one.

    Args:
        name: name or path of the library.
        library: what is there.

    Raises:
        BadFileError: the promises' file is broken.
    """
    path = library_path(name)
    found = read_time_bounds(path, library_hash=library_hash(library))
    if found is None:
        print(
            f"{time_bounds_path(path).name} was found with another library: no time bound is stated",
            file=sys.stderr,
        )
    return found or ()


def with_time_bound(
    plan: Plan, mission: Mission, planner: Planner, library: Library, time_bounds: tuple[TimeBound, ...]
) -> Plan:
    """Returns a plan with the time that most flights keep, where that was found for such missions.

    The missions flown for it want no heading and no trim at the goal, lie `NEAREST` to `FARTHEST` away, were
    flown in the library's wind and had one tolerance: a smaller one takes longer. The loop that flew them
    aims inside the tolerance, and flies on while it thinks.

    Args:
        plan: answers the mission.
        mission: as it was asked.
        planner: that answered.
        library: planned with.
        time_bounds: that stand beside the library.
    """
    own = _time_bound_of(plan, mission, library, time_bounds)
    if own is None:
        return plan
    thinking, aimed_at = _planned_mission(mission, library)
    aimed = planner.plan(aimed_at)
    if not aimed.found:
        return plan
    return replace(plan, time_promise=replace(own, time=own.factor * (thinking + aimed.cost)))


def time_bound_problems(
    plan: Plan, mission: Mission, library: Library, time_bounds: tuple[TimeBound, ...]
) -> tuple[str, ...]:
    """Returns where a plan's promise is not what stands beside the library; nothing where none stands there.

    Its time may be no shorter than what the loop foretells at least, whatever the longest sequence that was
    asked for; a longer one promises less, and is no lie.

    Args:
        plan: with a promise.
        mission: that it answers.
        library: planned with.
        time_bounds: that stand beside the library.
    """
    said = plan.time_promise
    if said is None:
        return ()
    wrong = _mismatches(plan, said, mission, library, time_bounds)
    if wrong or not time_bounds or said.time is None or plan.policy not in CERTIFIABLE:
        return wrong
    planner = planner_of(plan.policy, library, gamma=plan.gamma, deadline=PATIENCE)
    thinking, aimed_at = _planned_mission(replace(mission, max_trims=MAX_TRIMS), library)
    least = said.factor * (thinking + (planner.plan(aimed_at).lower_bound or 0.0))
    if said.time >= least - said.factor * PROVED_OPTIMALITY:
        return ()
    return (f"time_promise.time: the bound is at least {least:.3f} s, got {said.time:.3f} s",)


def _mismatches(
    plan: Plan, said: TimeBound, mission: Mission, library: Library, time_bounds: tuple[TimeBound, ...]
) -> tuple[str, ...]:
    """Returns whether a promise is of other plans, or none that stands beside the library."""
    if (said.policy, said.gamma) != (plan.policy, plan.gamma):
        got = f"{said.policy} plans at gamma {said.gamma:g}"
        return (f"time_promise: is of {got}, this is a {plan.policy} plan at gamma {plan.gamma:g}",)
    if time_bounds and replace(said, time=None) != _time_bound_of(plan, mission, library, time_bounds):
        return (f"time_promise: no such bound is stated for {library.name} for such a plan: {said.source}",)
    return ("time_promise.time: is missing",) if time_bounds and said.time is None else ()


def _time_bound_of(
    plan: Plan, mission: Mission, library: Library, time_bounds: tuple[TimeBound, ...]
) -> TimeBound | None:
    """Returns what is promised of such plans and missions, if anything is."""
    wanted = (mission.goal_heading, mission.goal_trim) != (None, None)
    far = not NEAREST <= mission.start.distance_to(mission.goal) <= FARTHEST
    if not plan.found or wanted or far or mission.tolerance < TOLERANCE:
        return None
    flown = (plan.policy, plan.gamma, library.conditions.wind)
    return next((one for one in time_bounds if (one.policy, one.gamma, one.wind) == flown), None)


def _planned_mission(mission: Mission, library: Library) -> tuple[float, Mission]:
    """Returns the seconds that the loop thinks, and the mission that it then plans."""
    loop = Settings()
    thinking = PlanStep(mission.start_trim, loop.latency.configured)
    start = thinking.exit(mission.start, library, 0.0)
    return thinking.duration, replace(mission, start=start, tolerance=loop.aim * mission.tolerance)
