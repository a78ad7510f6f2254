"""Whether plans keep their word and nothing beats them: `python -m benchmarks.planning_proof 1000 1`.

So many missions, with that seed: at random over the three shipped libraries, nominal and for the worst case.
Every plan goes through the independent check; every tenth mission of at most three trims is also solved by
brute force: every sequence at every level by IPOPT, from many random starts.
"""

import sys
from math import inf

import numpy as np

from flight.library import Library
from flight.mission import Mission
from flight.plan import Plan
from planner.check import problems
from planner.coasting import solve
from planner.walk_table import tabulate
from planner.worst_case import WorstCase

from .planning_missions import random_mission, shipped_libraries

LEVELS = (0.0, 0.05, 0.1, 0.3, 0.5, 0.8, 1.0)
STARTS = 12
AGREEMENT = 1e-4
"""Seconds by which brute force may be faster."""


def main(missions: int, seed: int) -> int:
    """Prints the counts; returns how much is wrong."""
    rng = np.random.default_rng(seed)
    every = shipped_libraries()
    planners = {(place, gamma): WorstCase(one, gamma) for place, one in enumerate(every) for gamma in LEVELS}
    counts = {"failed the check": 0, "above brute force": 0, "called infeasible wrongly": 0}
    statuses: dict[str, int] = {}
    brute = 0
    for number in range(missions):
        place, gamma = int(rng.integers(3)), float(rng.choice(LEVELS))
        mission = random_mission(rng, every[place], int(rng.choice([2, 3, 4, 5])))
        plan = planners[place, gamma].plan(mission)
        statuses[plan.status] = statuses.get(plan.status, 0) + 1
        counts["failed the check"] += (
            bool(problems(plan, every[place], mission)) or "failed its check" in plan.reason
        )
        if number % 10 == 0 and mission.max_trims <= 3:
            brute += 1
            cost = brute_force(every[place], mission, plan, rng)
            counts["above brute force"] += plan.found and cost < plan.cost - AGREEMENT
            counts["called infeasible wrongly"] += not plan.found and cost < inf
    print(f"{missions} missions: {statuses}; {brute} by brute force; {counts}")
    return sum(counts.values())


def brute_force(library: Library, mission: Mission, plan: Plan, rng: np.random.Generator) -> float:
    """Returns the least worst time that IPOPT finds over every sequence."""
    gammas = (0.0, -plan.gamma, plan.gamma) if plan.gamma else (0.0,)
    best = inf
    for table in tabulate(library, gammas, mission.start_trim, mission.max_trims, mission.goal_trim):
        for place in range(len(table.walks)):
            worst = 0.0
            for motion in table.motions[place * len(gammas) : (place + 1) * len(gammas)]:
                cost = inf
                for _ in range(STARTS):
                    times = solve(motion, mission, rng.exponential(5.0, table.batch.trims).tolist())
                    cost = cost if times is None else min(cost, motion.cost(times))
                worst = max(worst, cost)
                if worst >= best:
                    break
            best = min(best, worst)
    return best


if __name__ == "__main__":
    arguments = [int(one) for one in sys.argv[1:]]
    sys.exit(1 if main(*(arguments + [1000, 1][len(arguments) :])) else 0)
