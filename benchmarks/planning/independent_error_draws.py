"""Random independent errors against their bounds.

Run by `python -m benchmarks.planning.independent_error_draws 100 1`.

Arguments: missions, seed. Missions of up to four trims over the three shipped libraries, planned for the
worst case, with independent errors of primitives, then of scalars. For each, 4,000 random errors, half of
them corners, are compared with the bounds of time and miss. Also printed: bounds over the worst found, and
CPU times.
"""

import sys
from dataclasses import dataclass, field, replace
from math import inf
from time import process_time
from typing import get_args

import numpy as np

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from planner.independent_errors.error_path import ErrorGranularity, error_path
from planner.independent_errors.independent_errors import IndependentErrorBounds, bound_independent_errors
from planner.kernel.exact import least_costs
from planner.policies.worst_case import worst_case_planner
from planner.walks.goal_condition import goal_from_start

from .planning_missions import random_mission, shipped_libraries

LEVELS = (0.1, 0.3, 0.5, 0.8, 1.0)
DRAWS = 4000
LONGEST = 4
ROUNDING = 1e-6
"""Seconds and metres by which two searches of the same problem may differ."""


@dataclass(slots=True)
class DrawCounts:
    """Counts for one granularity of errors."""

    slower: int = 0
    further: int = 0
    never: int = 0
    unbounded: int = 0
    times: list[float] = field(default_factory=list)
    misses: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)


def main(missions: int, seed: int) -> int:
    """Prints the counts; returns the number of violated bounds."""
    rng = np.random.default_rng(seed)
    every = shipped_libraries()
    counts: dict[ErrorGranularity, DrawCounts] = {each: DrawCounts() for each in get_args(ErrorGranularity)}
    done = 0
    while done < missions:
        library, gamma = every[int(rng.integers(3))], float(rng.choice(LEVELS))
        mission = random_mission(rng, library, int(rng.integers(2, LONGEST + 1)))
        mission = replace(mission, heading_tolerance=max(mission.heading_tolerance, 0.1))
        plan = worst_case_planner(library, gamma).plan(mission)
        if not plan.found or plan.cost == 0:
            continue
        done += 1
        for each, count in counts.items():
            began = process_time()
            found = bound_independent_errors(
                library, mission, plan.sequence, plan.coasting_times, gamma=gamma, each=each
            )
            count.seconds.append(process_time() - began)
            note(count, found, compared(library, mission, plan, each, rng))
    for each, count in counts.items():
        show(each, count)
    return sum(count.slower + count.further for count in counts.values())


def compared(
    library: Library, mission: Mission, plan: Plan, each: ErrorGranularity, rng: np.random.Generator
) -> tuple[float, float]:
    """Returns the most seconds and metres of randomly drawn errors."""
    path = error_path(library, plan.sequence, plan.gamma, each)
    drawn = rng.uniform(-1, 1, (DRAWS, len(path.names)))
    drawn[::2] = np.sign(drawn[::2])
    costs = least_costs(path.table(drawn), mission)
    ends = path.at(drawn).end(np.tile(plan.coasting_times, (DRAWS, 1)))
    return float(costs.max()), float(np.abs(ends - goal_from_start(mission)).max())


def note(count: DrawCounts, found: IndependentErrorBounds, drawn: tuple[float, float]) -> None:
    """Counts one plan."""
    time, miss = found.slowest_bound, found.furthest_bound
    count.slower += drawn[0] > time.bound + ROUNDING
    count.further += drawn[1] > miss.bound + ROUNDING
    count.misses.append(miss.bound / max(miss.found, drawn[1]))
    worst = max(time.found, drawn[0])
    if worst == inf:
        count.never += 1
    elif time.bound == inf:
        count.unbounded += 1
    else:
        count.times.append(time.bound / worst)


def show(each: ErrorGranularity, count: DrawCounts) -> None:
    """Prints the counts of one granularity of errors."""
    total = len(count.misses)
    print(f"{each}: of {total} plans {count.slower} slower and {count.further} further than their bounds")
    print(
        f"  time: {count.never} with errors that make the goal unreachable, {count.unbounded} without a bound"
    )
    if count.times:
        shares = ", ".join(f"{np.quantile(count.times, share):.3f}" for share in (0.5, 0.75, 0.9, 1.0))
        print(f"  bound over worst found, median, 75 %, 90 %, most: {shares}")
    print(f"  miss: bound over worst found, most: {max(count.misses):.3f}")
    print(f"  took {np.median(count.seconds):.2f} s in the median, {max(count.seconds):.1f} s at most")


if __name__ == "__main__":
    arguments = [int(one) for one in sys.argv[1:]]
    sys.exit(1 if main(*(arguments + [100, 1][len(arguments) :])) else 0)
