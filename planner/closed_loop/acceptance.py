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
        plan: the answer.
        library: flown with.
        asked: the question.
        late: whether it came when the vehicle was no longer where it begins.
    """
    if not plan.found:
        return Acceptance(DecisionKind.FAILED, plan.reason)
    if late:
        return Acceptance(DecisionKind.LATE, f"it took {plan.solve_time:.3f} s")
    wrong = plan_problems(plan, library, asked)
    if wrong:
        return Acceptance(DecisionKind.REFUSED, f"a plan failed its check: {wrong[0]}")
    return Acceptance(DecisionKind.ADOPTED)
