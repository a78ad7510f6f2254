"""Comparison of committed plans with the reference and other policies."""

from math import inf, isfinite

import numpy as np

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan

from .coasting_problem import all_walks
from .committed_times import CommittedTimes, CommittedWalk
from .goal_region import slack
from .least_time import natural_units, worst_of_each
from .plan_judgement import BLURRED, SLOWER, Judgement, Reference

GAP = 6e-4
"""Seconds by which committed plans may be slower than the best: 5e-4 is the stated gap."""

WALKS = 3
"""Walks on which committed times are sought, the most promising first."""

WITHIN = "no coasting times that take at most"
"""Begin of the reason that denies plans up to a horizon."""


def judge_committed(
    plan: Plan, library: Library, mission: Mission, *, horizon: float, rng: np.random.Generator
) -> Judgement:
    """Compares a committed plan, or its absence, with the reference.

    Args:
        plan: of the committed policy, for a level above 0.
        library: the primitives.
        mission: with a tolerance above 0.
        horizon: seconds that a plan may take.
        rng: of the grids.
    """
    if plan.found:
        most = 1.001 * slack(mission)
        if CommittedWalk(library, mission, plan.sequence, plan.gamma).misses(plan.coasting_times, most):
            return Judgement("misses at some level", True, Reference(inf), plan)
    best = committed_reference(plan, library, mission, rng=rng)
    most = best.cost * (1 + SLOWER) + GAP
    if plan.status == "optimal" and plan.cost > most:
        return Judgement("slower", True, best, plan)
    if isfinite(best.cost) and (plan.lower_bound or 0.0) > most:
        return Judgement("lower bound above a plan", True, best, plan)
    if plan.status == "infeasible" and isfinite(best.cost):
        return Judgement("false infeasible", True, best, plan)
    if plan.reason.startswith(WITHIN) and best.cost < horizon:
        return Judgement("plan within the horizon denied", True, best, plan)
    return Judgement(plan.status, False, best, plan)


def committed_reference(
    plan: Plan, library: Library, mission: Mission, *, rng: np.random.Generator
) -> Reference:
    """Returns the fastest committed times found on the fastest walks."""
    gammas = (0.0, -plan.gamma, plan.gamma)
    walks = all_walks(library, mission)
    ceiling = plan.cost * (1 + SLOWER) + 1e-300
    costs, times = worst_of_each(library, mission, walks, gammas, ceiling=ceiling, rng=rng)
    found, on = CommittedTimes(inf), ()
    for place in np.argsort(costs)[:WALKS]:
        if not isfinite(costs[place]):
            break
        walk = walks[place]
        problem = CommittedWalk(library, mission, walk, plan.gamma)
        starts = [tuple(one[place, : len(walk)].tolist()) for one in times]
        starts.append(tuple(np.mean(starts, axis=0).tolist()))
        for start in starts:
            one = problem.fastest(start)
            if one.cost < found.cost:
                found, on = one, walk
    return Reference(found.cost, on, (found.times,))


def contradictions(
    nominal: Plan, worst: Plan, committed: Plan | None, library: Library, mission: Mission
) -> list[str]:
    """Returns where answers to one mission contradict one another.

    Who knows the level is never slower than who does not, and one level is never slower than the worst.
    """
    _, seconds = natural_units(library, mission)
    found = []
    pairs = [("nominal", nominal, "worst case", worst)]
    if committed is not None:
        pairs += [("worst case", worst, "committed", committed), ("nominal", nominal, "committed", committed)]
    for name, fast, other, slow in pairs:
        if not slow.found:
            continue
        if fast.status == "infeasible":
            found.append(f"{name} infeasible, {other} finds a plan")
        blur = slow.cost * 10 * SLOWER + BLURRED * seconds
        if fast.status == "optimal" and fast.cost > slow.cost + blur:
            found.append(f"{name} optimal, {other} is faster")
    return found
