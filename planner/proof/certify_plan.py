"""Plans with a certificate that passed the independent check."""

from dataclasses import replace
from math import isfinite
from time import perf_counter

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.mission import Mission
from flight.plan.plan import Plan, Status
from planner.check.plan_check import plan_problems

from .certify import MOST_WALKS, ProofFailure, certify, provable_bound

PROVABLE = ("nominal", "worst-case")
"""Policies whose plans are minima over coasting times at levels known beforehand."""


class NotProvableError(FlightError):
    """A certificate was requested for an unsupported policy."""

    def __init__(self, policy: str) -> None:
        super().__init__(
            f"expected a policy that can be certified, one of {', '.join(PROVABLE)}; got {policy}"
        )


def certify_plan(plan: Plan, library: Library, mission: Mission) -> Plan:
    """Returns a plan with its certificate, or with the failure's reason.

    Where the proof is not found the plan comes back as `feasible` (or `unknown`), with the reason.

    Args:
        plan: of the nominal or the worst-case policy.
        library: it was made with.
        mission: it was planned for.

    Raises:
        NotProvableError: the plan is of another policy.
    """
    if plan.policy not in PROVABLE:
        raise NotProvableError(plan.policy)
    began = perf_counter()
    gamma = plan.gamma
    levels = (0.0,) if plan.policy == "nominal" or gamma == 0 else (0.0, -gamma, gamma)
    bound = provable_bound(plan.cost)
    proof = certify(library, mission, levels, bound)
    if isinstance(proof, ProofFailure):
        proved = _explain_failure(plan, proof)
    else:
        proved = replace(
            plan,
            status="optimal" if plan.found else "infeasible",
            reason=""
            if plan.found
            else f"no walk of at most {mission.max_trims} trims leads to the goal, proved",
            lower_bound=bound if isfinite(bound) else None,
            certificate=proof,
        )
        wrong = plan_problems(proved, library, mission)
        if wrong:
            proved = _without_certificate(plan, f"the certificate failed its check: {wrong[0]}")
    return replace(proved, solve_time=plan.solve_time + perf_counter() - began)


def _explain_failure(plan: Plan, failure: ProofFailure) -> Plan:
    if failure.reached:
        return _without_certificate(
            plan, f"walk {failure.walk} may {'be faster' if plan.found else 'lead to the goal'}"
        )
    if not failure.walk:
        return _without_certificate(
            plan, f"there are {failure.walks} walks, and a certificate covers at most {MOST_WALKS}"
        )
    return _without_certificate(plan, f"walk {failure.walk} was not refuted with the boxes allowed")


def _without_certificate(plan: Plan, why: str) -> Plan:
    status: Status = "feasible" if plan.found else "unknown"
    return replace(plan, status=status, reason=f"not certified: {why}", lower_bound=None)
