"""How long re-planning takes in flight: `python -m benchmarks.planning.replanning_speed [MISSIONS]`.

Random missions are flown by the automaton whose primitives have errors of their own, with the shipped loop at
2 Hz; every planning is timed by the processor, so that other work on the machine does not count.
"""

import sys

import numpy as np

from experiments.mission.fly import fly_mission, mission_seed
from experiments.mission.mission_task import MissionTask
from experiments.mission.random_missions import random_missions
from scenarios.find import find_library

LIMIT = 0.020
"""Seconds that 99 % of all plannings are to keep, with 7 trims at depth 4."""


def main(count: int) -> None:
    """Prints the quantiles of planning times, and the bar in parts of the 99th percentile."""
    library = find_library("gtmax-sim")
    for policy in ("nominal", "worst-case"):
        times: list[float] = []
        for mission in random_missions(library, count=count, seed=1, gamma=1.0):
            task = MissionTask(
                mission=mission,
                library=library,
                policy=policy,
                gamma=0.0 if policy == "nominal" else 1.0,
                wind="none",
                seed=mission_seed(1, mission.name, 0),
                plant="random",
            )
            times += fly_mission(task).planning_times
        median, most, slowest = (float(np.quantile(times, share)) for share in (0.5, 0.99, 1.0))
        print(
            f"{policy:<12} {len(times)} plannings: median {1e3 * median:.2f} ms, 99 % {1e3 * most:.2f} ms, "
            f"slowest {1e3 * slowest:.2f} ms; the bar is {LIMIT / most:.1f} times the 99 %"
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 30)
