"""Validity of random plans: `python -m benchmarks.planning.planning_proof 10000 1000 50 1`.

Arguments: missions, those also by brute force, those with a certificate, the seed. Missions are
random over the three shipped libraries, nominal and for the worst case: every start trim, headings
at the goal, goal trims, 1 to 80 m, tolerances of 0 to a tenth of the way. Every plan goes through the
independent check. Brute force tries every sequence at every level by Newton's method from many random starts.
"""

import sys
from collections import Counter
from dataclasses import replace
from math import inf

import numpy as np

from benchmarks.upper_limit import upper_limit
from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from planner.check.plan_check import plan_problems
from planner.policies.worst_case import worst_case_planner
from planner.proof.certify_plan import certify_plan

from .brute_force import brute_force
from .planning_missions import random_mission, shipped_libraries

LEVELS = (0.0, 0.05, 0.1, 0.3, 0.5, 0.8, 1.0)
DEPTHS = (1, 2, 3, 4, 5)
BRUTE_DEPTH = 4
STARTS = 150
AGREEMENT = 1e-4
"""Seconds by which brute force may be faster."""


def main(missions: int, brute: int, proofs: int, seed: int) -> int:
    """Prints the counts; returns the number of faults."""
    rng = np.random.default_rng(seed)
    every = shipped_libraries()
    planners = {
        (place, gamma): worst_case_planner(one, gamma) for place, one in enumerate(every) for gamma in LEVELS
    }
    statuses: Counter[str] = Counter()
    wrong: Counter[str] = Counter()
    tried: Counter[str] = Counter()
    for number in range(missions):
        place, gamma = int(rng.integers(3)), float(rng.choice(LEVELS))
        library, mission = every[place], _mission(rng, every[place])
        plan = planners[place, gamma].plan(mission)
        statuses[plan.status] += 1
        tried["failed the check"] += 1
        wrong["failed the check"] += bool(plan_problems(plan, library, mission)) or "its check" in plan.reason
        if tried["above brute force"] < brute and mission.max_trims <= BRUTE_DEPTH:
            gammas = (0.0, -gamma, gamma) if gamma else (0.0,)
            cost = brute_force(library, mission, gammas, rng, starts=STARTS)
            _compare(plan, library, mission, cost, (tried, wrong))
        if tried["not certified"] < proofs and mission.max_trims <= BRUTE_DEPTH:
            tried["not certified"] += 1
            wrong["not certified"] += certify_plan(plan, library, mission).certificate is None
        if (number + 1) % 100 == 0:
            print(f"{number + 1} missions, {dict(tried)}, {dict(wrong)}", file=sys.stderr)
    print(f"{missions} missions: {dict(statuses)}")
    print(f"  brute force found the same cost within {AGREEMENT:g} s {tried['same']} times")
    for what in ("failed the check", "above brute force", "false infeasible", "not certified"):
        limit = 100 * upper_limit(wrong[what], tried[what])
        print(f"  {what}: {wrong[what]} of {tried[what]}; at most {limit:.3g} % with 95 % confidence")
    return wrong.total()


def _mission(rng: np.random.Generator, library: Library) -> Mission:
    mission = random_mission(rng, library, int(rng.choice(DEPTHS)))
    if rng.random() < 0.1:
        mission = replace(mission, goal_trim=int(rng.choice([trim.id for trim in library.trims])))
    return mission


def _compare(
    plan: Plan, library: Library, mission: Mission, cost: float, counts: tuple[Counter[str], Counter[str]]
) -> None:
    """Counts plans that brute force improves."""
    tried, wrong = counts
    for what in ("above brute force", "false infeasible"):
        tried[what] += 1
    tried["same"] += abs(cost - plan.cost) <= AGREEMENT or cost == plan.cost
    above = plan.found and cost < plan.cost - AGREEMENT
    lost = not plan.found and cost < inf
    wrong["above brute force"] += above
    wrong["false infeasible"] += lost
    if above or lost:
        print(f"{plan.status} {plan.cost} s, brute force {cost} s: {library.name} {plan.gamma} {mission}")


if __name__ == "__main__":
    arguments = [int(one) for one in sys.argv[1:]]
    sys.exit(1 if main(*(arguments + [10000, 1000, 50, 1][len(arguments) :])) else 0)
