"""Planner interface of all policies, for one library."""

from dataclasses import replace
from functools import cache, partial
from math import inf, isfinite, pi
from time import perf_counter
from typing import Protocol

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from flight.mission.mission import Mission
from flight.plan.plan import Plan, Policy, Scenario
from planner.check.plan_check import plan_problems
from planner.kernel.build import load_kernel
from planner.kernel.exact import ExactSearch
from planner.walks.kinematics import check_durations, walk_motion
from planner.walks.safe_stop import safe_stop_path
from planner.walks.search_result import SearchResult
from planner.walks.walk import trims_of_walks

STOPPED = "not proved optimal: the search stopped before every walk was searched or excluded by a bound"

ROUNDING = 1e-16
"""Share of a full circle's length by which its end is rounded."""

SLOW_TURNS = (
    "no plan was found; trim {trim} turns so slowly that the ends of its full circles cannot be computed to "
    "the slack for rounding"
)


class Planner(Protocol):
    """Interface of planners: a plan for a mission."""

    def plan(self, mission: Mission) -> Plan:
        """Returns the best plan found, or an infeasible one.

        Raises:
            UnknownTrimError: the library lacks the start or goal trim.
        """


class LibraryPlanner:
    """Planner for one library over a policy's uncertainty levels.

    Args:
        library: the primitives.
        policy: name that plans carry.
        gamma: uncertainty level that plans carry.
        gammas: the levels that every walk must reach the goal at.
        max_nodes: walks at one level that the exact search may solve; None for all it needs.
        deadline: seconds after which the best plan so far is given.

    Raises:
        NegativeDurationError: a level turns a maneuver's duration negative.
        NoMachineCodeError: there is no C compiler that works.
    """

    def __init__(
        self,
        library: Library,
        *,
        policy: Policy,
        gamma: float,
        gammas: tuple[float, ...],
        max_nodes: int | None = None,
        deadline: float = inf,
    ) -> None:
        for level in gammas:
            check_durations(library, level)
        # Whoever closes a loop learns before the flight that nothing can be planned here.
        load_kernel()
        self._library = library
        self._hash = library_hash(library)
        self._policy: Policy = policy
        self._gamma = gamma
        self._gammas = gammas
        self._max_nodes = max_nodes
        self._deadline = deadline
        self._exact = ExactSearch(library, gammas)
        self._tails = cache(partial(safe_stop_path, library))

    def plan(self, mission: Mission) -> Plan:
        """Returns the best plan found, after an independent check.

        Raises:
            UnknownTrimError: the library lacks the start or goal trim.
        """
        began = perf_counter()
        answer = self._exact.answer(mission, max_nodes=self._max_nodes, deadline=self._deadline)
        plan = self._verify(self._assemble(answer, mission), mission)
        return replace(plan, solve_time=perf_counter() - began)

    def _assemble(self, answer: SearchResult, mission: Mission) -> Plan:
        plan = Plan(
            status="unknown",
            library=self._library.name,
            library_hash=self._hash,
            mission=mission.name,
            policy=self._policy,
            gamma=self._gamma,
            tolerance=mission.tolerance,
            lower_bound=answer.lower_bound if isfinite(answer.lower_bound) else None,
        )
        depth = f"of at most {mission.max_trims} trims from trim {mission.start_trim}"
        slow = [] if isfinite(answer.lower_bound) else self._unresolved(mission)
        if slow:
            return replace(plan, reason=SLOW_TURNS.format(trim=min(slow)))
        if not isfinite(answer.lower_bound):
            return replace(plan, status="infeasible", reason=f"no walk {depth} leads to the goal, proved")
        if not answer.walk:
            return replace(plan, reason=f"no coasting times were found for any walk {depth}")
        return replace(
            plan,
            # Times that use the slack for rounding may be faster than the bound, which does not count on it.
            lower_bound=min(answer.lower_bound, max(answer.costs)),
            status="optimal" if answer.exhausted else "feasible",
            reason="" if answer.exhausted else self._optimality_caveat(),
            sequence=answer.walk,
            maneuvers=tuple(maneuver.id for maneuver in self._library.maneuvers_along(answer.walk)),
            tail=self._tails(answer.walk[-1]),
            scenarios=tuple(
                Scenario(
                    gamma,
                    cost,
                    times,
                    walk_motion(self._library, answer.walk, gamma).end(mission.start, times),
                )
                for gamma, cost, times in zip(self._gammas, answer.costs, answer.times, strict=True)
            ),
        )

    def _unresolved(self, mission: Mission) -> list[int]:
        """Returns trims with full circles too long for a computed end."""
        longest = mission.destination.slack / (2 * pi * ROUNDING)
        twists = {
            trim: [self._library.trim(trim).at(gamma) for gamma in self._gammas]
            for trim in trims_of_walks(
                self._library, mission.start_trim, max_trims=mission.max_trims, goal_trim=mission.goal_trim
            )
        }
        return [
            trim
            for trim, levels in twists.items()
            if any(one.yaw_rate and one.speed > longest * abs(one.yaw_rate) for one in levels)
        ]

    def _optimality_caveat(self) -> str:
        return STOPPED

    def _verify(self, plan: Plan, mission: Mission) -> Plan:
        if not plan.found:
            return plan
        wrong = plan_problems(plan, self._library, mission)
        if not wrong:
            return replace(plan, verified=True)
        return replace(
            plan,
            status="unknown",
            reason=f"a plan failed its check: {wrong[0]}",
            sequence=(),
            maneuvers=(),
            scenarios=(),
        )
