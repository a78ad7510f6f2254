"""The exact search without a compiler: boxes of coasting times, bounded by multipliers.

A plan found otherwise is taken to be the best until a proof of that fails: then the boxes show a way that is
faster, which is improved to its optimum, and the proof begins anew.
"""

from dataclasses import replace
from math import inf

from flight.automaton.library import Library
from flight.mission.mission import Mission
from planner.proof.certify import ProofFailure, certify
from planner.walks.goal_condition import reaches_goal
from planner.walks.kinematics import WalkMotion, walk_motion
from planner.walks.search_result import SearchResult, Times

from .coasting import solve

RESOLUTION = 1e-5
"""Seconds by which another plan may be faster: what a goal met to a micrometre is worth, ten times over."""

ROUNDS = 50


def proved_best(
    answer: SearchResult, library: Library, mission: Mission, gammas: tuple[float, ...], *, until: float = inf
) -> SearchResult:
    """Returns the best answer there is, starting from one; not `exhausted` where the proof does not end.

    Args:
        answer: of another search.
        library: the primitives.
        mission: from where to where.
        gammas: the uncertainty levels.
        until: reading of `time.perf_counter` at which the best so far is returned.
    """
    for _ in range(ROUNDS):
        cost = max(answer.costs, default=inf)
        target = cost - RESOLUTION
        proof = certify(library, mission, gammas, target, until=until)
        if not isinstance(proof, ProofFailure):
            return replace(answer, lower_bound=target, exhausted=True)
        if not proof.reached:
            break
        motions = [walk_motion(library, proof.walk, gamma) for gamma in gammas]
        times = tuple(
            _improved(numbers, mission, known) for numbers, known in zip(motions, proof.times, strict=True)
        )
        costs = tuple(numbers.cost(known) for numbers, known in zip(motions, times, strict=True))
        answer = SearchResult(proof.walk, times, costs, answer.lower_bound)
    return answer


def _improved(numbers: WalkMotion, mission: Mission, times: Times) -> Times:
    """Returns the optimum that coasting times lead to, or themselves."""
    better = solve(numbers, mission, times)
    if better is None or numbers.cost(better) > numbers.cost(times):
        return times
    # Times of nanoseconds are the solver's way of saying none.
    bare = tuple(0.0 if time < 1e-7 else time for time in better)
    return bare if reaches_goal(numbers.end(mission.start, bare), mission) else better
