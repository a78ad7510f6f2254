"""Committed plans against brute force.

Missions of at most three trims over the three shipped libraries; some want a
heading, a last trim, the goal exactly, or to be where they are. Every plan goes through the independent check
and is flown at 10,001 levels. Brute force is IPOPT on the CasADi statement of every sequence, from many
random starts: what it reaches, in seconds, or in metres of tolerance where there is no plan, must not be
better than what was planned.
"""

from dataclasses import dataclass, field, replace
from math import inf
from time import process_time

import numpy as np

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from planner.check.plan_check import plan_problems
from planner.commitment.committed import CommittedPlanner
from planner.walks.kinematics import walk_motion
from planner.walks.walk import walks
from tests.oracles.statements import Question
from tests.support.planning.random_missions import random_mission, shipped_libraries

LEVELS = (0.05, 0.1, 0.3, 0.5, 0.8, 1.0)
STARTS = 6
FLOWN = 10_001
AGREEMENT = 1e-3
"""Seconds or metres by which brute force may be better."""


@dataclass(slots=True)
class Counts:
    """Counts of faults and of what brute force found."""

    statuses: dict[str, int] = field(default_factory=dict)
    failed: int = 0
    missed: int = 0
    slower: list[float] = field(default_factory=list)
    wider: list[float] = field(default_factory=list)
    overlooked: int = 0
    seconds: list[float] = field(default_factory=list)

    @property
    def wrong(self) -> int:
        """Number of plans that failed, missed, or were beaten by brute force."""
        beaten = [gap for gap in (*self.slower, *self.wider) if gap > AGREEMENT]
        return self.failed + self.missed + self.overlooked + len(beaten)

    def lines(self) -> tuple[str, ...]:
        """Returns the figures in words."""
        return (
            f"{self.statuses}; {self.failed} failed the check, {self.missed} missed",
            f"brute force was faster by {max(self.slower, default=-inf):.6f} s at most, found a tolerance "
            f"smaller by {max(self.wider, default=-inf):.6f} m at most, "
            f"and a plan where none was seen {self.overlooked} times",
            f"planning: median {np.median(self.seconds):.2f} s, slowest {max(self.seconds):.2f} s",
        )


def committed_against_brute_force(missions: int, *, seed: int) -> Counts:
    """Returns what came of so many missions drawn with a seed."""
    rng = np.random.default_rng(seed)
    every, counts = shipped_libraries(), Counts()
    for _ in range(missions):
        library, gamma = every[int(rng.integers(3))], float(rng.choice(LEVELS))
        mission = random_mission(rng, library, int(rng.choice([2, 3])))
        mission = varied(replace(mission, tolerance=float(rng.choice([0.5, 1.0, 3.0, 8.0]))), library, rng)
        compare(library, mission, gamma, rng, counts)
    return counts


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
    planner = CommittedPlanner(library, gamma)
    plan = planner.plan(mission)
    counts.seconds.append(process_time() - began)
    counts.statuses[plan.status] = counts.statuses.get(plan.status, 0) + 1
    counts.failed += bool(plan_problems(plan, library, mission)) or "failed its check" in plan.reason
    known = plan if plan.found else plan.at_smallest_tolerance
    if known is not None:
        counts.missed += largest_miss(library, known, mission) > known.tolerance
    cost, miss = brute_force(library, mission, gamma, rng, planner.horizon(mission))
    if plan.found:
        counts.slower.append(plan.cost - cost)
    else:
        counts.overlooked += cost < inf
        smallest = inf if known is None else known.tolerance
        counts.wider.append(smallest - miss if miss < inf else 0.0)


def largest_miss(library: Library, plan: Plan, mission: Mission) -> float:
    """Returns the largest miss in metres over many levels."""
    levels = np.linspace(-plan.gamma, plan.gamma, FLOWN).tolist()
    ends = (
        walk_motion(library, plan.sequence, one).end(mission.start, plan.coasting_times) for one in levels
    )
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
