"""Acceptance of plans in flight."""

from dataclasses import dataclass

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from flightlog.decision import DecisionKind
from planner.check.plan_check import plan_problems


@dataclass(frozen=True, slots=True)
class Acceptance:
    """Acceptance of a plan: ADOPTED, FAILED, LATE or REFUSED, with its reason."""

    kind: DecisionKind
    reason: str = ""


def judge_plan(plan: Plan, library: Library, asked: Mission, *, late: bool) -> Acceptance:
    """Returns the acceptance of a plan after an independent check.

    Args:
        plan: of the planner.
        library: flown with.
        asked: the mission that was planned.
        late: True if the vehicle had already passed the plan's start.
    """
    if not plan.found:
        return Acceptance(DecisionKind.FAILED, plan.reason)
    if late:
        return Acceptance(DecisionKind.LATE, f"planning took {plan.solve_time:.3f} s")
    wrong = plan_problems(plan, library, asked)
    if wrong:
        return Acceptance(DecisionKind.REFUSED, f"a plan failed its check: {wrong[0]}")
    return Acceptance(DecisionKind.ADOPTED)
