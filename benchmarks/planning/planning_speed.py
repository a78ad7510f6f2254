"""Planner speed against CasADi and IPOPT: `python -m benchmarks.planning.planning_speed`.

CPU seconds of one core through the public planner with warm tables; the first call is printed separately.
Wall-clock for whole processes. The reference, built once, solves
every sequence at every level once, from one start.
"""

import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from math import inf
from time import process_time

import numpy as np

from flight.automaton.library import Library
from flight.mission.mission import Mission
from planner.kernel.exact import ExactSearch, least_costs
from planner.kernel.tables import tables
from planner.policies.worst_case import worst_case_planner
from planner.walks.kinematics import walk_motion
from planner.walks.search_result import SearchResult

from .ipopt import solve
from .planning_missions import random_mission, shipped_libraries, synthetic_library

GAMMA = 0.5
GAMMAS = (0.0, -GAMMA, GAMMA)
EARLY = 0.05
"""Seconds after which an early plan is compared with the best."""

EARLY_MISSIONS = 120
FEW_NODES = 256
"""Walks at one level that take about a millisecond."""

NEAR = 0.01
"""Share of the optimum by which an early plan may exceed it."""

REFERENCES = 8
"""Missions that IPOPT solves, of about 150 sequence problems each."""

AGREEMENT = 1e-6
"""Seconds by which IPOPT may be faster: its constraints are met to 1e-8 only."""

FIRST_CALL = """
import os
from time import perf_counter
began = perf_counter()
from benchmarks.planning.planning_missions import shipped_libraries
from benchmarks.planning.planning_speed import GAMMA, sample
from planner.policies.worst_case import worst_case_planner
library = shipped_libraries()[1]
worst_case_planner(library, GAMMA).plan(sample(library, 4, 1, seed=4)[0])
print(perf_counter() - began, sum(os.times()[:4]))
"""


@dataclass(slots=True)
class IpoptReference:
    """Times and counts of IPOPT.

    Attributes:
        seconds: of each mission.
        problems: sequences at one level.
        feasible: those that it reached the goal in.
        found: those of them that the exact solver reaches the goal in, no slower.
    """

    seconds: list[float]
    problems: int = 0
    feasible: int = 0
    found: int = 0


def main() -> None:
    """Prints the times."""
    library = shipped_libraries()[1]
    seconds, first = planning(library, 4, missions=200)
    report("7 trims, depth 4", seconds, first)
    compare(library, float(np.median(seconds)))
    for name, one in zip(("kinematic", "gtmax"), shipped_libraries()[:2], strict=True):
        seconds, first = planning(one, 8, missions=40)
        report(f"depth 8, thesis-{name}", seconds, first)
    for seed in (1, 2, 3):
        large = synthetic_library(70, 500, seed=seed)
        seconds, first = planning(large, 6, missions=40)
        report(f"70 trims, 500 maneuvers (seed {seed}), depth 6", seconds, first)
        anytime(large, 6)
    anytime(shipped_libraries()[0], 8)
    for cache in ("empty", "kept"):
        clock, spent = first_call(cache)
        print(
            f"a new process with its first plan, cache {cache}: {clock:.2f} s, of the processor {spent:.2f} s"
        )


def sample(library: Library, depth: int, count: int, *, seed: int) -> list[Mission]:
    """Returns random missions."""
    rng = np.random.default_rng(seed)
    return [random_mission(rng, library, depth) for _ in range(count)]


def planning(library: Library, depth: int, *, missions: int) -> tuple[list[float], float]:
    """Returns seconds per plan with warm tables, and the slowest first."""
    planner = worst_case_planner(library, GAMMA)
    warm: list[float] = []
    cold: list[float] = []
    for mission in sample(library, depth, missions, seed=4):
        for times in (cold, warm):
            began = process_time()
            planner.plan(mission)
            times.append(process_time() - began)
    return warm, max(cold)


def compare(library: Library, median: float) -> None:
    """Prints IPOPT's results on every sequence and gamma, from one start."""
    reference = IpoptReference([])
    for mission in sample(library, 4, REFERENCES, seed=9):
        ipopt(library, mission, reference)
    middle = float(np.median(reference.seconds))
    print(
        f"  CasADi and IPOPT, every sequence and gamma once: {middle:.3f} s, "
        f"{middle / median:.0f} x the planner"
    )
    share = 100 * reference.found / max(reference.feasible, 1)
    print(
        f"  of {reference.problems} such problems IPOPT reached the goal in {reference.feasible}; the exact "
        f"solver in {reference.found} of these ({share:.2f} %), none of them slower"
    )


def ipopt(library: Library, mission: Mission, reference: IpoptReference) -> None:
    """Solves every sequence and gamma from one start by IPOPT."""
    spent = 0.0
    for gamma in GAMMAS:
        for table in tables(library, (gamma,), mission.start_trim, mission.max_trims, mission.goal_trim):
            exact = least_costs(table, mission)
            walks = [tuple(walk) for walk in table.walks.tolist()]
            start = [1.0] * len(walks[0])
            solve(walk_motion(library, walks[0], gamma), mission, start)
            for walk, known in zip(walks, exact.tolist(), strict=True):
                numbers = walk_motion(library, walk, gamma)
                began = process_time()
                times = solve(numbers, mission, start)
                spent += process_time() - began
                cost = inf if times is None else numbers.cost(times)
                reference.problems += 1
                reference.feasible += cost < inf
                reference.found += cost < inf and known <= cost + AGREEMENT
    reference.seconds.append(spent)


def anytime(library: Library, depth: int) -> None:
    """Prints the quality of plans within CPU time limits."""
    search = ExactSearch(library, GAMMAS)
    gaps, slower = [], 0
    for mission in sample(library, depth, EARLY_MISSIONS, seed=6):
        search.answer(mission, max_nodes=1)
        seconds, best = timed(search, mission, None)
        if not best.walk:
            continue
        slower += seconds > EARLY
        early = best if seconds <= EARLY else stopped(search, mission)
        gaps.append(max(early.costs, default=inf) / max(*best.costs, 1e-9) - 1)
    within = sum(gap <= NEAR for gap in gaps)
    print(
        f"  after {1e3 * EARLY:.0f} ms: within {NEAR:.0%} of the optimum in {within} of {len(gaps)}, "
        f"{100 * max(gaps):.2f} % above it at most; {slower} of them take longer"
    )


def timed(search: ExactSearch, mission: Mission, max_nodes: int | None) -> tuple[float, SearchResult]:
    """Returns CPU seconds of a search and its result."""
    began = process_time()
    answer = search.answer(mission, max_nodes=max_nodes)
    return process_time() - began, answer


def stopped(search: ExactSearch, mission: Mission) -> SearchResult:
    """Returns the result of a search stopped after `EARLY` seconds.

    A deadline counts wall-clock time; this counts nodes, a quarter more in each trial.
    """
    nodes = FEW_NODES
    _, answer = timed(search, mission, 1)
    while True:
        seconds, found = timed(search, mission, nodes)
        if seconds > EARLY:
            return answer
        nodes, answer = nodes * 5 // 4, found


def first_call(cache: str) -> tuple[float, float]:
    """Returns clock and CPU seconds of a new process's first planning."""
    with tempfile.TemporaryDirectory() as folder:
        place = {"XDG_CACHE_HOME": folder} if cache == "empty" else {}
        command = [sys.executable, "-c", FIRST_CALL]
        ran = subprocess.run(command, env=os.environ | place, check=True, capture_output=True, text=True)
    clock, spent = map(float, ran.stdout.split())
    return clock, spent


def report(what: str, seconds: list[float], first: float) -> None:
    """Prints one row."""
    middle, most = 1e3 * np.median(seconds), 1e3 * max(seconds)
    print(f"{what}: median {middle:.2f} ms, slowest {most:.1f} ms, first call {1e3 * first:.0f} ms")


if __name__ == "__main__":
    main()
