"""How fast the planner is, against CasADi and IPOPT: `python -m benchmarks.planning_speed`.

Wall-clock of one core, the planner called as users call it, its tables warm; what the first call adds is
printed beside. The reference solves every sequence at every level once, from one start.
"""

from time import perf_counter

import numpy as np

from flight.library import Library
from flight.mission import Mission
from planner.coasting import solve
from planner.kernel.exact import ExactSearch
from planner.walk_table import tabulate
from planner.worst_case import WorstCase

from .planning_missions import random_mission, shipped_libraries, synthetic_library

GAMMA = 0.5
GAMMAS = (0.0, -GAMMA, GAMMA)
FEW_NODES = 3000


def main() -> None:
    """Prints the times."""
    library = shipped_libraries()[1]
    seconds, first = planning(library, 4, missions=200)
    report("7 trims, depth 4", seconds, first)
    reference = [ipopt(library, mission) for mission in sample(library, 4, 3, seed=9)]
    print(f"  CasADi and IPOPT, every sequence and gamma once: {np.median(reference):.3f} s a mission,")
    print(f"  {np.median(reference) / np.median(seconds):.0f} x the planner")
    for name, one in zip(("kinematic", "gtmax"), shipped_libraries()[:2], strict=True):
        seconds, first = planning(one, 8, missions=20)
        report(f"7 trims, depth 8, thesis-{name}", seconds, first)
    large = synthetic_library(70, 500, seed=1)
    seconds, first = planning(large, 6, missions=8)
    report("70 trims, 500 maneuvers, depth 6", seconds, first)
    anytime(large)


def sample(library: Library, depth: int, count: int, *, seed: int) -> list[Mission]:
    """Returns missions at random."""
    rng = np.random.default_rng(seed)
    return [random_mission(rng, library, depth) for _ in range(count)]


def planning(library: Library, depth: int, *, missions: int) -> tuple[list[float], float]:
    """Returns seconds of each worst-case plan with its tables warm, and of the slowest first one."""
    planner = WorstCase(library, GAMMA)
    warm: list[float] = []
    cold: list[float] = []
    for mission in sample(library, depth, missions, seed=4):
        for times in (cold, warm):
            began = perf_counter()
            planner.plan(mission)
            times.append(perf_counter() - began)
    return warm, max(cold)


def ipopt(library: Library, mission: Mission) -> float:
    """Returns seconds that IPOPT takes over every sequence and gamma, from one start each."""
    tables = tabulate(library, GAMMAS, mission.start_trim, mission.max_trims, None)
    for table in tables:
        solve(table.motions[0], mission, [1.0] * table.batch.trims)
    began = perf_counter()
    for table in tables:
        for motion in table.motions:
            solve(motion, mission, [1.0] * table.batch.trims)
    return perf_counter() - began


def anytime(library: Library) -> None:
    """Prints how good a plan is that a few nodes give."""
    search = ExactSearch(library, GAMMAS)
    gaps, spent = [], []
    for mission in sample(library, 6, 8, seed=4):
        best = search.answer(mission)
        began = perf_counter()
        early = search.answer(mission, max_nodes=FEW_NODES)
        spent.append(perf_counter() - began)
        if best.walk:
            gaps.append(max(early.costs, default=np.inf) / max(best.costs) - 1)
    print(
        f"  stopped after {FEW_NODES} nodes ({1e3 * max(spent):.0f} ms at most): "
        f"{100 * max(gaps):.2f} % above the optimum at most"
    )


def report(what: str, seconds: list[float], first: float) -> None:
    """Prints one row."""
    middle, most = 1e3 * np.median(seconds), 1e3 * max(seconds)
    print(f"{what}: median {middle:.2f} ms, slowest {most:.1f} ms, first call {1e3 * first:.0f} ms")


if __name__ == "__main__":
    main()
