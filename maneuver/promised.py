"""What is promised of plans: times that most flights keep, found by flying, that stand beside a library."""

import sys
from dataclasses import replace
from math import inf

from flight.library import Library
from flight.library_file import library_hash
from flight.mission import Mission
from flight.plan import Plan
from flight.time_promise import TimePromise, read_times, times_path
from planner.check import PROVED_OPTIMALITY
from planner.loop_settings import Settings
from planner.nominal import Nominal
from planner.policy import Planner
from planner.remainder import Step
from planner.worst_case import WorstCase

from .files import library_path
from .random_missions import FARTHEST, NEAREST, TOLERANCE


def promised_times(name: str, library: Library) -> tuple[TimePromise, ...]:
    """Returns the promises that stand beside a library; says so where they are of another one.

    Args:
        name: name or path of the library.
        library: what is there.

    Raises:
        BadFileError: the promises' file is broken.
    """
    path = library_path(name)
    found = read_times(path, library_hash=library_hash(library))
    if found is None:
        print(f"{times_path(path).name} was found with another library: no time is promised", file=sys.stderr)
    return found or ()


def with_promise(
    plan: Plan, mission: Mission, planner: Planner, library: Library, promises: tuple[TimePromise, ...]
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
        promises: that stand beside the library.
    """
    wanted = (mission.goal_heading, mission.goal_trim) != (None, None)
    flown = (plan.policy, plan.gamma, library.conditions.wind)
    own = [one for one in promises if (one.policy, one.gamma, one.wind) == flown]
    far = not NEAREST <= mission.start.distance_to(mission.goal) <= FARTHEST
    if not plan.found or not own or wanted or far or mission.tolerance < TOLERANCE:
        return plan
    loop = Settings()
    thinking = Step(mission.start_trim, loop.latency.configured)
    start = thinking.exit(mission.start, library, 0.0)
    aimed = planner.plan(replace(mission, start=start, tolerance=loop.aim * mission.tolerance))
    if not aimed.found or (plan.status == "optimal" and aimed.status != "optimal"):
        # A search that was stopped foretells what it would not foretell again.
        return plan
    time = own[0].factor * (thinking.duration + aimed.cost)
    return replace(plan, time_promise=replace(own[0], time=time))


def broken_promise(
    plan: Plan, mission: Mission, library: Library, promises: tuple[TimePromise, ...]
) -> tuple[str, ...]:
    """Returns where a plan's promise is not what stands beside the library; nothing where none stands there.

    The time is planned again, unless the plan is none that would come again.

    Args:
        plan: with a promise.
        mission: that it answers.
        library: planned with.
        promises: that stand beside the library.
    """
    said = plan.time_promise
    if said is None or not promises:
        return ()
    own = (said.policy, said.gamma) == (plan.policy, plan.gamma)
    if not own or replace(said, time=None) not in promises:
        return (f"time_promise: nothing like it stands beside {library.name} for such a plan: {said.source}",)
    if plan.status != "optimal" or plan.policy not in {"nominal", "worst-case"}:
        return ()
    planner = Nominal(library) if plan.policy == "nominal" else WorstCase(library, plan.gamma)
    again = with_promise(replace(plan, time_promise=None), mission, planner, library, promises).time_promise
    time, stated = (again and again.time) or inf, said.time or inf
    if abs(stated - time) <= said.factor * PROVED_OPTIMALITY:
        return ()
    depth = f"planned again with at most {mission.max_trims} trims it is {time:.3f} s"
    return (f"time_promise.time: {depth}, got {stated:.3f} s",)
