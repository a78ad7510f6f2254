"""Committed policy: coasting times chosen before gamma is known (thesis, 8.1).

The same times must end within the tolerance, with the heading wanted, at every level from -gamma to gamma; of
all that do, the ones whose slowest level is fastest are taken.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import inf, isfinite
from time import perf_counter

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from flight.mission.mission import Mission
from flight.plan.plan import Plan, Scenario
from planner.check.plan_check import plan_problems
from planner.kernel.automaton import Automaton
from planner.kernel.exact import least_costs
from planner.kernel.tables import tables_of_walks
from planner.policies.nominal import nominal_planner
from planner.policies.worst_case import worst_case_planner
from planner.walks.kinematics import check_durations, check_gamma, walk_motion
from planner.walks.walk import Walk

from .branch_and_bound_times import BranchAndBound, Incumbent
from .committed_task import CommittedTask
from .walk_choice import choose_walks
from .whole_interval import ROUNDING

GAP = 5e-4
"""Seconds, or metres of tolerance, within which nothing better is left."""

MOST_NODES = 500_000
"""Boxes of coasting times that a search may examine."""

LEVELS = 5
"""Levels at which each walk is solved exactly, alone, for a bound."""

HORIZON = 120.0
"""Default horizon of a plan in seconds; twice the nominal plan's where that is more."""

WALKS_AT_ONCE = 64
"""Walks solved between two checks of the deadline."""

SHARE = 0.25
"""Of the time left: for planning without errors, and again for the worst case."""

NOTHING = Incumbent((), None, inf, 0.0, False, 0)

UNFINISHED = "not proved optimal: the search stopped before every box of coasting times was excluded"


@dataclass(frozen=True, slots=True, eq=False)
class _PreparedMission:
    """Walks of a mission with fixed and least times.

    Attributes:
        left_out: seconds that every walk takes at least that is not among them; infinite if all are.
    """

    mission: Mission
    walks: tuple[Walk, ...]
    left_out: float
    fixed: Float[np.ndarray, "walks"]
    bounds: Float[np.ndarray, "walks"]
    search: BranchAndBound
    horizon: float
    worst_case: Plan


class CommittedPlanner:
    """Planner of one set of coasting times for all levels.

    Args:
        library: the primitives.
        gamma: uncertainty level, from 0 (nominal) to 1 (the errors of the library).
        max_nodes: boxes of coasting times that each search may examine.
        deadline: seconds after which the best plan so far is given, with a bound.
        horizon: seconds that a plan may take, maneuvers included; by default 120, or twice the nominal
            plan's where that is more.

    Raises:
        GammaError: the level is outside [0, 1].
        NegativeDurationError: the level turns a maneuver's duration negative.
    """

    def __init__(
        self,
        library: Library,
        gamma: float,
        *,
        max_nodes: int | None = None,
        deadline: float = inf,
        horizon: float | None = None,
    ) -> None:
        check_gamma(gamma)
        for level in (-gamma, gamma):
            check_durations(library, level)
        self._library, self._gamma = library, gamma
        self._levels = tuple(np.linspace(-gamma, gamma, LEVELS).tolist())
        self._hash = library_hash(library)
        self._deadline, self._horizon = deadline, horizon
        self._max_nodes = MOST_NODES if max_nodes is None else max_nodes

    def plan(self, mission: Mission) -> Plan:
        """Returns the fastest committed plan, or the smallest feasible tolerance.

        Raises:
            UnknownTrimError: the library lacks the start or goal trim.
        """
        began = perf_counter()
        if self._gamma == 0:
            nominal = nominal_planner(self._library, deadline=self._deadline)
            return _as_committed(nominal.plan(mission), mission)
        case = self._prepare(mission, began + self._deadline)
        search, horizon = case.search, case.horizon
        starts = self._starts(case)
        fast = self._fastest(case, self._refine_starts(case, starts, minimise_time=True))
        near = NOTHING
        if fast.found is None:
            near = self._refine_starts(case, starts, minimise_time=False)
            enough = search.task.tolerance
            near = search.minimise_miss(near, GAP, limit=horizon, enough=0.0 if fast.complete else enough)
            if case.left_out < horizon:
                near = replace(near, bound=0.0, complete=False)
            if near.value <= enough and near.found is not None:
                seconds = sum(near.found.times) + float(case.fixed[case.walks.index(near.walk)])
                fast = self._fastest(case, replace(near, value=seconds))
        found = fast.found is not None
        plan = self._optimal_plan(case, fast) if found else self._infeasible_plan(case, near, fast)
        return replace(plan, solve_time=perf_counter() - began)

    def _fastest(self, case: _PreparedMission, best: Incumbent) -> Incumbent:
        """Returns the fastest times, with a bound of all walks."""
        fast = case.search.minimise_time(case.bounds, best, GAP, limit=case.horizon)
        enough = min(fast.value - GAP, case.horizon)
        complete = fast.complete and case.left_out >= enough
        return replace(fast, bound=min(fast.bound, case.left_out), complete=complete)

    def horizon(self, mission: Mission, *, deadline: float = inf) -> float:
        """Returns the planning horizon in seconds."""
        if self._horizon is not None:
            return self._horizon
        nominal = nominal_planner(self._library, deadline=deadline).plan(mission)
        return max(HORIZON, 2 * nominal.cost) if nominal.found else HORIZON

    def _prepare(self, mission: Mission, until: float) -> _PreparedMission:
        horizon = self.horizon(mission, deadline=SHARE * (until - perf_counter()))
        deadline = SHARE * (until - perf_counter())
        known = worst_case_planner(self._library, self._gamma, deadline=deadline).plan(mission)
        every, left_out = choose_walks(
            self._library, self._levels, mission, horizon=horizon, known=known, until=until
        )
        paths = [self._library.maneuvers_along(walk) for walk in every]
        nominal_fixed = np.array([sum(step.duration for step in path) for path in paths], dtype=float)
        slope = np.array([sum(step.error.duration for step in path) for path in paths], dtype=float)
        fixed = nominal_fixed + self._gamma * np.abs(slope)
        task = CommittedTask.of(mission, self._gamma)
        search = BranchAndBound(self._library, every, fixed, task, most_nodes=self._max_nodes, until=until)
        coasting = self._least_coasting_times(mission, every, nominal_fixed, slope, until)
        return _PreparedMission(mission, every, left_out, fixed, fixed + coasting, search, horizon, known)

    def _least_coasting_times(
        self,
        mission: Mission,
        every: tuple[Walk, ...],
        fixed: Float[np.ndarray, "walks"],
        slope: Float[np.ndarray, "walks"],
        until: float,
    ) -> Float[np.ndarray, "walks"]:
        """Returns lower bounds of each walk's coasting time, within a deadline."""
        least = np.zeros(len(every))
        row_of = {walk: row for row, walk in enumerate(every)}
        for gamma in self._levels:
            for table in tables_of_walks(Automaton.of(self._library, (gamma,)), every):
                for part in table.parts(WALKS_AT_ONCE):
                    if perf_counter() > until:
                        return least
                    rows = [row_of[tuple(walk)] for walk in part.walks.tolist()]
                    coasting = least_costs(part, mission) - (fixed[rows] + gamma * slope[rows])
                    least[rows] = np.maximum(least[rows], coasting)
        return least

    def _starts(self, case: _PreparedMission) -> tuple[tuple[Walk, tuple[float, ...]], ...]:
        """Returns starting times: the worst-case plan's at each level, and mean."""
        if not case.worst_case.found:
            return ()
        each = [scenario.coasting_times for scenario in case.worst_case.scenarios]
        each.append(tuple(np.mean(each, axis=0).tolist()))
        return tuple((case.worst_case.sequence, times) for times in each)

    def _refine_starts(
        self, case: _PreparedMission, starts: Iterable[tuple[Walk, tuple[float, ...]]], *, minimise_time: bool
    ) -> Incumbent:
        descend, horizon = case.search.descend, case.horizon
        found = [
            descend(case.walks.index(walk), np.array(times), horizon, minimise_time=minimise_time)
            for walk, times in starts
        ]
        return min((one for one in found if one is not None), key=lambda one: one.value, default=NOTHING)

    def _optimal_plan(self, case: _PreparedMission, best: Incumbent) -> Plan:
        plan = self._assemble(case.mission, best)
        return self._verify(
            replace(
                plan,
                status="optimal" if best.complete else "feasible",
                reason="" if best.complete else UNFINISHED,
                lower_bound=best.bound if isfinite(best.bound) else None,
            ),
            case.mission,
        )

    def _infeasible_plan(self, case: _PreparedMission, nearest: Incumbent, fast: Incumbent) -> Plan:
        """Returns an infeasible plan with the smallest-tolerance plan attached."""
        mission = case.mission
        plan = self._empty_plan(mission)
        depth = f"of at most {mission.max_trims} trims from trim {mission.start_trim}"
        alone = not np.isfinite(case.bounds).any() and case.left_out == inf
        tolerance = case.search.task.tolerance
        proved = fast.complete or (nearest.bound > tolerance and case.left_out >= case.horizon)
        bound = max(nearest.bound, tolerance if proved else 0.0)
        headless = nearest.complete and nearest.found is None and (case.fixed <= case.horizon).any()
        kept = "have the wanted heading" if headless else "stay within the tolerance"
        if alone:
            reason = (
                f"no walk {depth} leads to the goal at all of {LEVELS} levels, each planned alone: proved"
            )
        elif proved:
            reason = (
                f"no coasting times that take at most {case.horizon:.1f} s with the maneuvers, in any "
                f"walk {depth}, {kept} at every gamma from {-self._gamma:g} to "
                f"{self._gamma:g}; longer ones were not searched"
            )
        else:
            reason = (
                f"no coasting times that stay within the tolerance were found for any walk {depth}; the "
                f"search was stopped, and none take less than {min(fast.bound, case.horizon):.3f} s"
            )
        plan = replace(plan, status="infeasible" if alone else "unknown", reason=reason)
        if nearest.found is None:
            return plan
        wider = replace(mission, tolerance=nearest.found.worst.bound)
        widened = self._assemble(wider, nearest)
        note = (
            f"the smallest tolerance within {case.horizon:.1f} s: none below {bound:.4f} m"
            if nearest.complete
            else f"the smallest tolerance that was found within {case.horizon:.1f} s; the search for smaller "
            f"ones was stopped, {f'none below {bound:.4f} m' if bound else 'without a lower bound'}"
        )
        widened = self._verify(replace(widened, status="feasible", reason=note), wider)
        return replace(plan, at_smallest_tolerance=widened if widened.found else None)

    def _empty_plan(self, mission: Mission) -> Plan:
        return Plan(
            status="unknown",
            library=self._library.name,
            library_hash=self._hash,
            mission=mission.name,
            policy="committed",
            gamma=self._gamma,
            tolerance=mission.tolerance,
        )

    def _assemble(self, mission: Mission, best: Incumbent) -> Plan:
        assert best.found is not None
        times, worst = best.found.times, best.found.worst
        levels = [0.0, -self._gamma, self._gamma]
        if min(abs(worst.gamma - level) for level in levels) > 1e-9:
            levels.append(worst.gamma)
        scenarios = []
        for gamma in levels:
            numbers = walk_motion(self._library, best.walk, gamma)
            scenarios.append(Scenario(gamma, numbers.cost(times), times, numbers.end(mission.start, times)))
        return replace(
            self._empty_plan(mission),
            sequence=best.walk,
            maneuvers=tuple(step.id for step in self._library.maneuvers_along(best.walk)),
            scenarios=tuple(scenarios),
            miss=worst.bound,
        )

    def _verify(self, plan: Plan, mission: Mission) -> Plan:
        wrong = plan_problems(plan, self._library, mission)
        if not wrong:
            return replace(plan, verified=True)
        return replace(
            self._empty_plan(mission), status="unknown", reason=f"a plan failed its check: {wrong[0]}"
        )


def _as_committed(plan: Plan, mission: Mission) -> Plan:
    """Returns a nominal plan as the committed one without uncertainty."""
    if not plan.found:
        return replace(plan, policy="committed")
    miss = plan.deciding.end.distance_to(mission.goal) + ROUNDING
    return replace(plan, policy="committed", miss=min(miss, mission.destination.reach))
