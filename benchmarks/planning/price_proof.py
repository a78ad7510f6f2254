"""Proof of the price of robustness: `python -m benchmarks.planning.price_proof 20 1`.

Arguments: missions, seed. The price planner's gamma is compared with a dense scan of the worst-case time at
400 levels. At that gamma and at every scanned level below it the time must be within alpha times the nominal
optimum; and some level just above must exceed it, unless gamma is 1. Also counted: missions proved for all
smaller levels, and for all but the last thousandth.
"""

import sys
from math import inf

import numpy as np

from flight.automaton.library import Library
from flight.mission.mission import Mission
from planner.policies.certified_gamma import certified_gamma
from planner.policies.nominal import nominal_planner
from planner.policies.price_of_robustness import ALL_BUT, GAMMA_RESOLUTION, PriceOfRobustness
from planner.policies.worst_case import worst_case_planner
from planner.walks.kinematics import NegativeDurationError

from .planning_missions import random_mission, shipped_libraries

SCANNED = 400
ROUNDING = 1e-6
"""Seconds by which two searches of the same problem may differ."""


def main(missions: int, seed: int) -> int:
    """Prints the counts; returns the number of faults."""
    rng = np.random.default_rng(seed)
    every = shipped_libraries()
    exceeded, short, gaps, done = 0, 0, 0, 0
    left: list[float] = []
    while done < missions:
        library = every[done % len(every)]
        mission = random_mission(rng, library, int(rng.integers(2, 5)))
        alpha = float(rng.uniform(1.0, 1.6))
        nominal = nominal_planner(library).plan(mission)
        if not nominal.found:
            continue
        done += 1
        limit = alpha * nominal.cost + 1e-9
        gamma = PriceOfRobustness(library, alpha).plan(mission).gamma
        left.append(gamma - certified_gamma(library, mission, limit=limit, gamma=gamma))
        costs = {level: worst(library, mission, level) for level in np.linspace(0, 1, SCANNED + 1).tolist()}
        broken = [level for level, cost in costs.items() if cost > limit + ROUNDING]
        first = min(broken, default=inf)
        exceeded += worst(library, mission, gamma) > limit + ROUNDING
        gaps += first < gamma
        above = worst(library, mission, min(gamma + 2 * GAMMA_RESOLUTION, 1.0))
        short += gamma < 1 and above <= limit - ROUNDING
    print(
        f"{missions} missions: at its gamma the time exceeds alpha {exceeded} times, at a smaller level "
        f"{gaps} times; just above its gamma the time is still within alpha {short} times"
    )
    whole, nearly = sum(one <= 0 for one in left), sum(one <= ALL_BUT for one in left)
    print(f"proved for all smaller levels {whole} times, for all but {ALL_BUT:g} below {nearly} times")
    return exceeded + short + gaps


def worst(library: Library, mission: Mission, gamma: float) -> float:
    """Returns the worst-case time in seconds; infinite without a plan."""
    try:
        return worst_case_planner(library, gamma).plan(mission).cost
    except NegativeDurationError:
        return inf


if __name__ == "__main__":
    arguments = [int(one) for one in sys.argv[1:]]
    sys.exit(1 if main(*(arguments + [20, 1][len(arguments) :])) else 0)
