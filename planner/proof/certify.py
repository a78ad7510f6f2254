"""Certificates of optimality: dual bounds over boxes of coasting times.

A walk need be refuted at one uncertainty level only: there its least time, and so its worst one, is no better
than the plan. Levels are tried in turn; a level with a faster solution is dropped at once.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, isfinite

import numpy as np
from jaxtyping import Int

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.certificate import Certificate, InfeasibilityCertificate
from planner.walks.kinematics import walk_motion
from planner.walks.walk import Walk, count_walks, walks

from .branching_trees import BranchingTrees, root_boxes
from .dual_bound import WalkProblems
from .multipliers import MultiplierSearch

GAP = 9e-4
"""Seconds between a plan's cost and the lower bound that is proved."""

MOST_WALKS = 10_000
"""Walks that a certificate covers."""

EFFORTS = (300, 3000, 30000)
"""Boxes that a walk at one level may take, in the rounds of trying its levels."""


@dataclass(frozen=True, slots=True)
class ProofFailure:
    """Reason for a missing certificate.

    Attributes:
        walk: the one that was not refuted; empty where there are too many walks.
        reached: True if it reaches the goal in less time at every level; if not, the effort was exhausted.
        walks: number of walks.
    """

    walk: Walk
    reached: bool = False
    walks: int = 0


def certify(
    library: Library,
    mission: Mission,
    gammas: Sequence[float],
    lower_bound: float,
) -> Certificate | ProofFailure:
    """Proves that no walk has a worst time below a bound.

    Args:
        library: the primitives.
        mission: from where to where, and how deep.
        gammas: the uncertainty levels.
        lower_bound: seconds; infinite to prove that there is no plan at all.

    Raises:
        UnknownTrimError: the library lacks the start or goal trim.
    """
    start, depth, goal_trim = mission.start_trim, mission.max_trims, mission.goal_trim
    count = count_walks(library, start, max_trims=depth, goal_trim=goal_trim)
    if count > MOST_WALKS:
        return ProofFailure((), walks=count)
    every = walks(library, start, max_trims=depth, goal_trim=goal_trim)
    if not every:
        return Certificate(mission.max_trims, ())
    levels = [
        WalkProblems.of([walk_motion(library, walk, gamma) for walk in every], mission) for gamma in gammas
    ]
    order = _levels_by_bound(levels, lower_bound)
    trees: dict[int, tuple[int, str]] = {}
    reached = np.zeros((len(every), len(gammas)), dtype=bool)
    ways: dict[tuple[int, int], tuple[float, ...]] = {}
    for effort in EFFORTS:
        for turn in range(len(gammas)):
            for level in range(len(gammas)):
                rows = np.array(
                    [
                        row
                        for row in range(len(every))
                        if row not in trees and order[row, turn] == level and not reached[row, level]
                    ],
                    dtype=int,
                )
                if not len(rows):
                    continue
                branching = BranchingTrees(levels[level], lower_bound)
                branching.branch(rows, effort)
                reached[rows, level] |= branching.reached[rows]
                ways |= {(row, level): times for row, times in branching.ways.items()}
                for row in rows[~branching.left[rows]].tolist():
                    trees[row] = level, branching.text(row, len(every[row]))
        lost = [row for row in range(len(every)) if row not in trees and reached[row].all()]
        if lost:
            return _fastest_known(lost, every, ways, len(gammas))
        if len(trees) == len(every):
            break
    else:
        return ProofFailure(next(walk for row, walk in enumerate(every) if row not in trees))
    return Certificate(
        mission.max_trims,
        tuple(
            InfeasibilityCertificate(walk, gammas[trees[row][0]], trees[row][1])
            for row, walk in enumerate(every)
        ),
    )


def _fastest_known(
    rows: list[int], every: tuple[Walk, ...], ways: dict[tuple[int, int], tuple[float, ...]], levels: int
) -> ProofFailure:
    """Returns the known walk below the bound with the least coasting time."""
    best = min(rows, key=lambda row: max(sum(ways[row, level][: len(every[row])]) for level in range(levels)))
    return ProofFailure(every[best], reached=True)


def _levels_by_bound(levels: list[WalkProblems], target: float) -> Int[np.ndarray, "walks levels"]:
    """Returns each walk's levels, ordered by decreasing bound of the root box."""
    excess = []
    for level in levels:
        problems = level.straightened(target)
        low, high = root_boxes(problems, target)
        search = MultiplierSearch(problems, low, high, target)
        search.run(np.zeros(len(low), dtype=complex))
        excess.append(search.excess)
    return np.argsort(-np.stack(excess, axis=1), axis=1, kind="stable")


def provable_bound(cost: float) -> float:
    """Returns the lower bound to prove for a plan's cost."""
    return cost - GAP if isfinite(cost) else inf
