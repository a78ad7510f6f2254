"""Whether nothing beats committed plans: `python -m benchmarks.planning.committed_proof 100 1`.

So many missions, with that seed, of at most three trims over the three shipped libraries; some want a
heading, a last trim, the goal exactly, or to be where they are. Every plan goes through the independent check
and is flown at 10,001 levels. Brute force is IPOPT on the CasADi statement of every sequence, from many
random starts: what it reaches, in seconds, or in metres of tolerance where there is no plan, must not be
better than what was planned.
"""

import sys
from dataclasses import dataclass, field, replace
from math import inf
from time import process_time

import numpy as np

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from planner.check.plan_check import problems
from planner.commitment.committed import Committed
from planner.walks.kinematics import motion
from planner.walks.walk import walks
from tests.oracles.statements import Question

from .planning_missions import random_mission, shipped_libraries

LEVELS = (0.05, 0.1, 0.3, 0.5, 0.8, 1.0)
STARTS = 6
FLOWN = 10_001
AGREEMENT = 1e-3
"""Seconds or metres by which brute force may be better."""


@dataclass(slots=True)
class Counts:
    """What went wrong, and how far brute force came."""

    statuses: dict[str, int] = field(default_factory=dict)
    failed: int = 0
    missed: int = 0
    slower: list[float] = field(default_factory=list)
    wider: list[float] = field(default_factory=list)
    overlooked: int = 0
    seconds: list[float] = field(default_factory=list)


def main(missions: int, seed: int) -> int:
    """Prints the counts; returns how much is wrong."""
    rng = np.random.default_rng(seed)
    every, counts = shipped_libraries(), Counts()
    for _ in range(missions):
        library, gamma = every[int(rng.integers(3))], float(rng.choice(LEVELS))
        mission = random_mission(rng, library, int(rng.choice([2, 3])))
        mission = varied(replace(mission, tolerance=float(rng.choice([0.5, 1.0, 3.0, 8.0]))), library, rng)
        compare(library, mission, gamma, rng, counts)
    print(f"{missions} missions: {counts.statuses}; {counts.failed} failed the check, {counts.missed} missed")
    print(
        f"brute force was faster by {max(counts.slower, default=-inf):.6f} s at most, found a tolerance "
        f"smaller by {max(counts.wider, default=-inf):.6f} m at most, "
        f"and a plan where none was seen {counts.overlooked} times"
    )
    print(f"planning: median {np.median(counts.seconds):.2f} s, slowest {max(counts.seconds):.2f} s")
    worse = [gap for gap in (*counts.slower, *counts.wider) if gap > AGREEMENT]
    return counts.failed + counts.missed + counts.overlooked + len(worse)


def varied(mission: Mission, library: Library, rng: np.random.Generator) -> Mission:
    """Returns a mission, sometimes with a last trim, no tolerance, one trim, or nowhere to go."""
    chance = rng.random(4)
    if chance[0] < 0.2:
        mission = replace(mission, goal_trim=int(rng.choice([trim.id for trim in library.trims])))
    if chance[1] < 0.05:
        mission = replace(mission, tolerance=0.0)
    if chance[2] < 0.05:
        mission = replace(mission, max_trims=1)
    if chance[3] < 0.1:
        mission = replace(mission, goal=mission.start.position)
    return mission


def compare(
    library: Library, mission: Mission, gamma: float, rng: np.random.Generator, counts: Counts
) -> None:
    """Plans a mission, and looks for something better."""
    began = process_time()
    planner = Committed(library, gamma)
    plan = planner.plan(mission)
    counts.seconds.append(process_time() - began)
    counts.statuses[plan.status] = counts.statuses.get(plan.status, 0) + 1
    counts.failed += bool(problems(plan, library, mission)) or "failed its check" in plan.reason
    known = plan if plan.found else plan.at_smallest_tolerance
    if known is not None:
        counts.missed += largest_miss(library, known, mission) > known.tolerance
    cost, miss = brute_force(library, mission, gamma, rng, planner.horizon(mission))
    if "-v" in sys.argv:
        print(mission, gamma, plan.status, plan.cost, cost, known and known.tolerance, miss)
    if plan.found:
        counts.slower.append(plan.cost - cost)
    else:
        counts.overlooked += cost < inf
        smallest = inf if known is None else known.tolerance
        counts.wider.append(smallest - miss if miss < inf else 0.0)


def largest_miss(library: Library, plan: Plan, mission: Mission) -> float:
    """Returns the largest miss in metres over many levels."""
    levels = np.linspace(-plan.gamma, plan.gamma, FLOWN).tolist()
    ends = (motion(library, plan.sequence, one).end(mission.start, plan.coasting_times) for one in levels)
    return max(end.distance_to(mission.goal) for end in ends)


def brute_force(
    library: Library, mission: Mission, gamma: float, rng: np.random.Generator, horizon: float
) -> tuple[float, float]:
    """Returns the least time within the tolerance and the least tolerance that IPOPT finds."""
    cost, miss = inf, inf
    for walk in walks(library, mission.start_trim, max_trims=mission.max_trims, goal_trim=mission.goal_trim):
        steps = library.maneuvers_along(walk)
        error = abs(sum(step.error.duration for step in steps))
        fixed = sum(step.duration for step in steps) + gamma * error
        question = Question(library, walk, mission, gamma, horizon - fixed)
        for _ in range(STARTS):
            near = question.smallest_tolerance(tuple(rng.exponential(6.0, len(walk)).tolist()))
            if near is None:
                continue
            miss = min(miss, near[1])
            if near[1] <= mission.destination.reach:
                times = question.committed(near[0])
                cost = min(cost, fixed + sum(near[0] if times is None else times))
    return cost, miss


if __name__ == "__main__":
    arguments = [int(one) for one in sys.argv[1:] if one != "-v"]
    sys.exit(1 if main(*(arguments + [100, 1][len(arguments) :])) else 0)
