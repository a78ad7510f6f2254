"""Peak memory and deadlines with large libraries.

Run by `python -m benchmarks.planning.planning_memory 2`; argument: the deadline in seconds.

Each plan is made in a process of its own: 70 trims, 500 maneuvers, sequences of up to eight trims. A library
is by the kinematic equations; in another all maneuvers cost next to nothing, and bounds exclude little.
"""

import subprocess
import sys
from dataclasses import replace
from resource import RUSAGE_SELF, getrusage

from flight.automaton.library import Library
from flight.automaton.maneuver import ManeuverError
from flight.mission.mission import Mission
from flight.se2 import SE2
from planner.commitment.committed import CommittedPlanner
from planner.policies.nominal import nominal_planner
from planner.policies.policy import Planner
from planner.policies.worst_case import worst_case_planner

from .planning_missions import synthetic_library

TRIMS, MANEUVERS, DEPTH, GAMMA = 70, 500, 8, 0.5

NEXT_TO_NOTHING = 1e-3
"""Of the durations and displacements of maneuvers."""

LIBRARIES = ("kinematic", "free")
POLICIES = ("nominal", "worst-case", "committed")

MISSIONS = (
    Mission("near", SE2.identity(), 1, (12.0, -9.0), 0.5, max_trims=DEPTH),
    Mission("far", SE2.identity(), 1, (600.0, -900.0), 1.0, max_trims=DEPTH),
    Mission("turned", SE2.identity(), 1, (40.0, 30.0), 0.5, 3.0, 0.05, max_trims=DEPTH),
)


def main(deadline: float) -> None:
    """Prints a line for each mission, library and policy."""
    for library in LIBRARIES:
        for mission in range(len(MISSIONS)):
            for policy in POLICIES:
                command = [sys.executable, "-m", __spec__.name, str(deadline), library, str(mission), policy]
                print(
                    subprocess.run(command, check=True, capture_output=True, text=True).stdout,
                    end="",
                    flush=True,
                )


def one(deadline: float, library: str, place: int, policy: str) -> None:
    """Prints seconds, memory and the answer of one plan."""
    chosen, mission = large_library(library), MISSIONS[place]
    planner: Planner = CommittedPlanner(chosen, GAMMA, deadline=deadline)
    if policy == "nominal":
        planner = nominal_planner(chosen, deadline=deadline)
    elif policy == "worst-case":
        planner = worst_case_planner(chosen, GAMMA, deadline=deadline)
    plan = planner.plan(mission)
    print(
        f"{library:<10}{mission.name:<8}{policy:<11}{plan.solve_time:6.3f} s "
        f"{getrusage(RUSAGE_SELF).ru_maxrss / 1024:4.0f} MB {plan.status} {plan.cost:.3f} s"
    )


def large_library(kind: str) -> Library:
    """Returns a kinematic library, or one of nearly free maneuvers."""
    library = synthetic_library(TRIMS, MANEUVERS, seed=1)
    if kind == "kinematic":
        return library
    free = tuple(
        replace(
            maneuver,
            duration=NEXT_TO_NOTHING * maneuver.duration,
            displacement=SE2(
                *(NEXT_TO_NOTHING * part for part in (maneuver.displacement.x, maneuver.displacement.y, 0))
            ),
            error=ManeuverError(0.0, 0.0, 0.0, 0.0),
        )
        for maneuver in library.maneuvers
    )
    return replace(library, maneuvers=free)


if __name__ == "__main__":
    if len(sys.argv) > 2:
        one(float(sys.argv[1]), sys.argv[2], int(sys.argv[3]), sys.argv[4])
    else:
        main(float(sys.argv[1]))
