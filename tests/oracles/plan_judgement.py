"""Comparison of plans with the independent reference."""

from dataclasses import dataclass, replace
from math import fsum, inf, isfinite

import mpmath
import numpy as np

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan

from .coasting_problem import all_walks
from .goal_region import FORGIVEN, FORGIVEN_SHARE, ROUNDING, GoalRegion, slack
from .least_time import natural_units, worst_of_each

SLOWER = 1e-6
"""Share of the reference's cost by which a plan may cost more."""

BLURRED = 1e-7
"""Share of the natural units of metres and seconds below resolution."""

INSIDE = 1e-5
"""Share of a tolerance inside which a reference is away from the edge."""

RESOLVED = 0.1
"""Share of the slack that rounding must not exceed for a plan to be demanded."""

DIGITS = 40


@dataclass(frozen=True, slots=True)
class Reference:
    """Reference plan for every level, evaluated with 40 digits.

    Attributes:
        cost: seconds at the level that takes longest; infinite without a plan.
        walk: trim ids.
        times: seconds in each trim, level by level.
        rounding: metres by which double precision may miss the ends.
    """

    cost: float
    walk: tuple[int, ...] = ()
    times: tuple[tuple[float, ...], ...] = ()
    rounding: float = 0.0


@dataclass(frozen=True, slots=True)
class Judgement:
    """A plan beside its reference.

    Attributes:
        kind: `same`, `reference slower`, `no plan`, or the fault.
        fault: whether the plan is wrong, or its status.
        reference: the best plan known.
        plan: what was planned.
    """

    kind: str
    fault: bool
    reference: Reference
    plan: Plan


def levels_of(plan: Plan) -> tuple[float, ...]:
    """Returns the levels that a plan is for, the slowest first."""
    if plan.policy == "nominal" or plan.gamma == 0:
        return (0.0,)
    costs = {one.gamma: one.cost for one in plan.scenarios}
    return tuple(sorted((0.0, -plan.gamma, plan.gamma), key=lambda gamma: -costs.get(gamma, 0.0)))


def judge(
    plan: Plan,
    library: Library,
    mission: Mission,
    *,
    rng: np.random.Generator,
    known: tuple[tuple[int, ...], tuple[float, ...]] | None = None,
) -> Judgement:
    """Compares a nominal or worst-case plan with the reference.

    Args:
        plan: from a search that was not stopped.
        library: the primitives.
        mission: from where to where.
        rng: of the grids.
        known: walk and times that end at the goal at level 0.
    """
    wrong = end_problem(plan, library, mission)
    if wrong:
        return Judgement(wrong, True, Reference(inf), plan)
    best = reference(plan, library, mission, rng=rng, known=known)
    _metres, seconds = natural_units(library, mission)
    blur = BLURRED * seconds
    least = best.cost * (1 + SLOWER) + blur
    if plan.status == "unknown" and best.rounding > RESOLVED * slack(mission):
        return Judgement("unknown, ends below resolution", False, best, plan)
    if plan.cost > least:
        kind = {"infeasible": "false infeasible", "unknown": "plan not found"}.get(plan.status, "slower")
        return Judgement(kind + _where(plan, library, mission, blur, rng), True, best, plan)
    if isfinite(best.cost) and (plan.lower_bound or 0.0) > least:
        return Judgement("lower bound above a plan", True, best, plan)
    if plan.status in ("feasible", "unknown"):
        kind = f"{plan.status} without a stop"
    elif not plan.found:
        kind = "no plan"
    else:
        kind = "reference slower" if best.cost > plan.cost * (1 + SLOWER) + blur else "same"
    return Judgement(kind, False, best, plan)


def _where(plan: Plan, library: Library, mission: Mission, blur: float, rng: np.random.Generator) -> str:
    """Returns whether a better plan needs the edge of a tolerance."""
    narrow = replace(
        mission,
        tolerance=mission.tolerance * (1 - INSIDE),
        heading_tolerance=mission.heading_tolerance * (1 - INSIDE),
    )
    inner = reference(plan, library, narrow, rng=rng)
    if inner.cost * (1 + SLOWER) + blur >= plan.cost:
        return ", at an edge"
    return "" if mission.tolerance > 0 else ", goal met exactly"


def reference(
    plan: Plan,
    library: Library,
    mission: Mission,
    *,
    rng: np.random.Generator,
    known: tuple[tuple[int, ...], tuple[float, ...]] | None = None,
) -> Reference:
    """Returns the reference's best plan, pruned by the given plan's cost."""
    gammas = levels_of(plan)
    walks = all_walks(library, mission)
    ceiling = plan.cost * (1 + 10 * SLOWER) + 1e-300 if plan.found else inf
    costs, times = worst_of_each(library, mission, walks, gammas, ceiling=ceiling, rng=rng)
    found = Reference(inf)
    for place in np.argsort(costs):
        if not isfinite(costs[place]):
            break
        walk = walks[place]
        every = tuple(tuple(one[place, : len(walk)].tolist()) for one in times)
        levels = list(zip(every, gammas, strict=True))
        if all(ends_inside(library, mission, walk, held, gamma) for held, gamma in levels):
            ways = [flown_beyond(library, mission, walk, held, gamma)[2] for held, gamma in levels]
            found = Reference(float(costs[place]), walk, every, ROUNDING * max(ways))
            break
    if known is None or gammas != (0.0,) or known[0] not in walks:
        return found
    if ends_inside(library, mission, *known, 0.0):
        cost = fsum((*known[1], *(one.duration for one in library.maneuvers_along(known[0]))))
        found = min(found, Reference(cost, known[0], (known[1],)), key=lambda one: one.cost)
    return found


def ends_inside(
    library: Library,
    mission: Mission,
    walk: tuple[int, ...],
    times: tuple[float, ...],
    gamma: float,
    *,
    slack: float = ROUNDING,
) -> bool:
    """Returns True if the end, in 40 digits, is within rounding."""
    beyond, turned, way = flown_beyond(library, mission, walk, times, gamma)
    metres, _ = natural_units(library, mission)
    if ROUNDING * way > BLURRED * metres:
        return False
    return beyond <= slack * way and turned <= slack * (way / metres + 10)


def flown_beyond(
    library: Library, mission: Mission, walk: tuple[int, ...], times: tuple[float, ...], gamma: float
) -> tuple[float, float, float]:
    """Returns excess metres and radians of an end, and path length.

    Integrated in 40 digits, step by step: x' = exp(i heading) v.
    """
    with mpmath.workdps(DIGITS):
        position, heading = mpmath.mpc(mission.start.x, mission.start.y), mpmath.mpf(mission.start.heading)
        way = abs(position) + abs(complex(*mission.goal)) + mission.tolerance
        steps = (None, *library.maneuvers_along(walk))
        for trim, step, time in zip(walk, steps, times, strict=True):
            if step is not None:
                moved = step.at(gamma).displacement
                position += mpmath.expj(heading) * mpmath.mpc(moved.x, moved.y)
                heading += moved.heading
                way += abs(complex(moved.x, moved.y))
            held = library.trim(trim).at(gamma)
            velocity, rate = mpmath.mpc(held.forward, held.side), mpmath.mpf(held.yaw_rate)
            turn = rate * time
            chord = velocity * time if turn == 0 else velocity * (mpmath.expj(turn) - 1) / (1j * rate)
            position += mpmath.expj(heading) * chord
            heading += turn
            way += abs(complex(held.forward, held.side)) * time
        beyond = abs(position - mpmath.mpc(*mission.goal)) - mission.tolerance
        region = GoalRegion.of(mission)
        turned = mpmath.mpf(-1)
        if region.heading is not None:
            off = heading - region.heading
            off -= 2 * mpmath.pi * mpmath.nint(off / (2 * mpmath.pi))
            turned = abs(off) - region.width
        return float(beyond), float(turned), float(way)


def end_problem(plan: Plan, library: Library, mission: Mission) -> str:
    """Returns the fault in a plan's ends or costs; empty without."""
    for one in plan.scenarios:
        beyond, turned, way = flown_beyond(library, mission, plan.sequence, one.coasting_times, one.gamma)
        if beyond > 1.001 * max(slack(mission), FORGIVEN_SHARE * way):
            return "ends outside the disc"
        if turned > 1.001 * FORGIVEN:
            return "ends with another heading"
        durations = [step.at(one.gamma).duration for step in library.maneuvers_along(plan.sequence)]
        total = fsum((*one.coasting_times, *durations))
        if abs(total - one.cost) > 1e-12 * abs(total) or min(one.coasting_times) < 0:
            return "cost is not the sum of its times"
    return ""
