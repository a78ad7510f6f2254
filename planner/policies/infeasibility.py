"""Reasons of infeasible missions, and the depth that has a plan."""

from collections.abc import Callable
from dataclasses import replace
from math import degrees, pi, remainder
from time import perf_counter

from flight.automaton.library import Library
from flight.mission.mission import MAX_TRIMS, Mission
from flight.plan.plan import Plan
from planner.walks.goal_condition import wants_heading

PATIENCE = 0.3
"""Seconds for the look at longer walks."""

MOST_HEADINGS = 10_000
"""Largest number of distinct headings without a turn; beyond, none is called impossible."""

ROUNDING = 1e-9
"""Least difference between two distinct sums of turns, rad."""


def unreachable_end(library: Library, mission: Mission) -> str:
    """Returns the end condition that no walk meets; empty if none.

    Args:
        library: the primitives.
        mission: the wanted last trim and heading, and the longest walk.
    """
    start, goal_trim = mission.start_trim, mission.goal_trim
    longest = f"no walk of at most {mission.max_trims} trims from trim {start}"
    if goal_trim is not None:
        fewest = fewest_trims(library, start, goal_trim)
        if fewest is None:
            return f"no maneuvers lead from trim {start} to trim {goal_trim}"
        if fewest > mission.max_trims:
            return f"{longest} ends in trim {goal_trim}; the shortest has {fewest}"
    if mission.goal_heading is None or not wants_heading(mission) or _turns_to_goal(library, mission):
        return ""
    end = "" if goal_trim is None else f" in trim {goal_trim}"
    return f"{longest} ends{end} at heading {degrees(mission.goal_heading):.4g}°"


def fewest_trims(library: Library, start: int, goal: int) -> int | None:
    """Returns the number of trims in the shortest walk; None without one."""
    reached, count = {start}, 1
    while goal not in reached:
        onward = reached | {after for trim in reached for after in library.successors(trim)}
        if onward == reached:
            return None
        reached, count = onward, count + 1
    return count


def longer_walk(
    mission: Mission, plan_within: Callable[[Mission, float], Plan], *, patience: float = PATIENCE
) -> str:
    """Returns the depth with a plan, in words; empty if unknown.

    Args:
        mission: without a plan at its own depth.
        plan_within: plans a mission within seconds.
        patience: seconds for all depths together.
    """
    until = perf_counter() + patience
    for depth in range(mission.max_trims + 1, MAX_TRIMS + 1):
        left = until - perf_counter()
        if left <= 0:
            return ""
        deeper = replace(mission, max_trims=depth)
        plan = plan_within(deeper, left)
        if plan.found:
            return f"with {depth} trims there is one: --max-trims {depth}"
        if plan.status != "infeasible":
            return ""
    return f"nor is there one of at most {MAX_TRIMS} trims" if mission.max_trims < MAX_TRIMS else ""


def _turns_to_goal(library: Library, mission: Mission) -> bool:
    """Returns True where a walk can turn to the wanted heading.

    A coast in a trim that turns may last until any heading; without one the maneuvers alone turn. The library
    without its errors decides: every plan must reach the goal with it.
    """
    turning = {trim.id for trim in library.trims if trim.velocity.yaw_rate != 0}
    turns = {(one.from_trim, one.to_trim): one.at(0.0).displacement.heading for one in library.maneuvers}
    heading = (mission.goal_heading or 0.0) - mission.start.heading
    reach = mission.destination.heading_reach + MAX_TRIMS * ROUNDING

    def ends(trim: int) -> bool:
        return mission.goal_trim in {None, trim}

    # Trims with the heading changes of the walks that lead there; None where any heading is possible.
    states: set[tuple[int, float | None]] = {(mission.start_trim, 0.0)}
    for _ in range(mission.max_trims):
        states = {(trim, None if trim in turning else turned) for trim, turned in states}
        if any(
            ends(trim) and (turned is None or abs(remainder(turned - heading, 2 * pi)) <= reach)
            for trim, turned in states
        ):
            return True
        if len(states) > MOST_HEADINGS:
            return True
        states = {
            (after, None if turned is None else round((turned + turns[trim, after]) / ROUNDING) * ROUNDING)
            for trim, turned in states
            for after in library.successors(trim)
        }
    return False
