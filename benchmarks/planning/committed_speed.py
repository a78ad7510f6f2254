"""Speed of committed planning: `python -m benchmarks.planning.committed_speed 200 1 30`.

Arguments: missions, seed, deadline in seconds. Missions of two to four trims over the three shipped
libraries. Prints the slow ones (all with -v), the counts of what was proved, and the planning times.
"""

import sys
from dataclasses import replace
from time import perf_counter

import numpy as np

from flight.plan.plan import Plan
from planner.commitment.committed import CommittedPlanner

from .planning_missions import random_mission, shipped_libraries

GAMMAS = (0.05, 0.1, 0.3, 0.5, 0.8, 1.0)
TOLERANCES = (0.5, 1.0, 3.0, 8.0)
SLOW = 10.0
"""Seconds."""


def main(missions: int, seed: int, deadline: float) -> None:
    """Prints the slow missions and the distribution of seconds."""
    rng, every = np.random.default_rng(seed), shipped_libraries()
    CommittedPlanner(every[0], 0.1).plan(random_mission(rng, every[0], 2))
    took: dict[int, list[float]] = {2: [], 3: [], 4: []}
    answers: dict[str, int] = {}
    for number in range(missions):
        library, gamma = every[int(rng.integers(3))], float(rng.choice(GAMMAS))
        mission = random_mission(rng, library, int(rng.choice([2, 3, 4])))
        mission = replace(mission, tolerance=float(rng.choice(TOLERANCES)))
        began = perf_counter()
        plan = CommittedPlanner(library, gamma, deadline=deadline).plan(mission)
        seconds = perf_counter() - began
        took[mission.max_trims].append(seconds)
        known = plan.at_smallest_tolerance or plan
        word = proved(plan)
        answers[word] = answers.get(word, 0) + 1
        if seconds > SLOW or "-v" in sys.argv:
            print(
                f"{number}: {seconds:.1f} s, {library.name}, gamma {gamma:g}, {mission.max_trims} trims, "
                f"{mission.tolerance:g} m, {word}, {known.cost:.3f} s, {known.tolerance:.4f} m",
                flush=True,
            )
    for depth, times in took.items():
        if times:
            share = np.mean(np.array(times) > SLOW)
            print(
                f"{depth} trims: {len(times)} missions, median {np.median(times):.2f} s, "
                f"95 % {np.quantile(times, 0.95):.2f} s, most {max(times):.2f} s, "
                f"{100 * share:.0f} % slower than {SLOW:g} s"
            )
    print(answers)


def proved(plan: Plan) -> str:
    """Returns the status of a plan and its further claims."""
    if plan.status != "unknown":
        return plan.status
    if "in any walk" not in plan.reason:
        return "unknown, nothing proved"
    if "have the wanted heading" in plan.reason:
        return "unknown, none within the horizon at any tolerance"
    wider = plan.at_smallest_tolerance
    if wider is None or "stopped" in wider.reason:
        return "unknown, none within the horizon"
    return "unknown, none within the horizon and the smallest tolerance"


if __name__ == "__main__":
    numbers = [one for one in sys.argv[1:] if one != "-v"]
    main(int(numbers[0]), int(numbers[1]), float(numbers[2]))
