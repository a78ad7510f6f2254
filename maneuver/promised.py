"""What is promised of plans: times that most flights keep, found by flying, that stand beside a library."""

import sys
from dataclasses import replace
from pathlib import Path

from flight.library import Library
from flight.library_file import library_hash
from flight.mission import Mission
from flight.plan import Plan
from flight.time_promise import TimePromise, read_times, times_path

from .files import library_path
from .random_missions import TOLERANCE


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


def with_promise(plan: Plan, mission: Mission, promises: tuple[TimePromise, ...]) -> Plan:
    """Returns a plan with what share of flights keeps what time, where that was found for such missions.

    The missions flown for it want no heading and no trim at the goal, and had one tolerance: a smaller one
    takes longer.
    """
    wanted = (mission.goal_heading, mission.goal_trim) != (None, None)
    if not plan.found or wanted or mission.tolerance < TOLERANCE:
        return plan
    own = [one for one in promises if (one.policy, one.gamma) == (plan.policy, plan.gamma)]
    return replace(plan, time_promise=own[0]) if own else plan


def promise_file(name: str) -> Path:
    """Returns where the promises of a library stand."""
    return times_path(library_path(name))
