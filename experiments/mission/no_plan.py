"""Reason of an infeasible mission, and the depth with a plan."""

from dataclasses import replace

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from planner.policies.infeasibility import longer_walk, unreachable_end

from .policies import CERTIFIABLE, planner_of


def with_full_reason(plan: Plan, library: Library, mission: Mission) -> Plan:
    """Returns an infeasible plan whose reason names what would change it.

    Args:
        plan: the answer; one that is not infeasible is returned as it is.
        library: the primitives.
        mission: the mission of the plan.
    """
    if plan.status != "infeasible":
        return plan
    cause = unreachable_end(library, mission)
    reasons = [plan.reason, cause] if plan.certificate is not None or not cause else [cause]
    if plan.policy in {*CERTIFIABLE, "price-of-robustness"}:
        # The price of robustness is infeasible where the nominal mission is.
        policy = plan.policy if plan.policy in CERTIFIABLE else "nominal"
        reasons.append(
            longer_walk(
                mission,
                lambda deeper, seconds: planner_of(policy, library, gamma=plan.gamma, deadline=seconds).plan(
                    deeper
                ),
            )
        )
    return replace(plan, reason="; ".join(filter(None, reasons)))
