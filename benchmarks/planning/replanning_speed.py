"""Replanning speed in flight: `python -m benchmarks.planning.replanning_speed [MISSIONS]`.

Random missions are flown by the automaton with independent errors of primitives, in the shipped loop at 2 Hz;
plannings are timed in CPU seconds, so that other load does not count.
"""

import sys

import numpy as np

from experiments.mission.fly import fly_mission, mission_seed
from experiments.mission.mission_task import MissionTask
from experiments.mission.random_missions import random_missions
from scenarios.find import find_library

LIMIT = 0.020
"""Limit in seconds for 99 % of all plannings, with 7 trims at depth 4."""


def main(count: int) -> None:
    """Prints planning-time quantiles, and the limit over the 99th percentile."""
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
            f"slowest {1e3 * slowest:.2f} ms; the limit is {LIMIT / most:.1f} times the 99 %"
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 30)
