"""Guarantees of a checked plan: proved claims and unproved statements."""

from dataclasses import dataclass

from flight.plan.plan import Plan


@dataclass(frozen=True, slots=True)
class Guarantees:
    """Guarantees of one plan that passed its check.

    Attributes:
        proved: claims that the check showed from plan, library and mission alone.
        unproved: further claims of the plan, not checked.
    """

    proved: tuple[str, ...]
    unproved: tuple[str, ...]


def guarantees_of(plan: Plan) -> Guarantees:
    """Returns the proved and the unproved claims of a plan.

    Args:
        plan: in which `planner.check.plan_check.plan_problems` found nothing.
    """
    proved, unproved = [], []
    if plan.found:
        levels = ", ".join(f"{scenario.gamma:g}" for scenario in plan.scenarios)
        exactly = "" if plan.certificate is None else ", also in interval arithmetic"
        proved.append(f"the sequence ends at the goal at gamma {levels}, in the stated times{exactly}")
    if plan.miss is not None:
        proved.append(
            f"these coasting times end within {plan.miss:.4f} m of the goal {describe_gamma_range(plan)}"
        )
    if plan.certificate is not None:
        depth = f"of at most {plan.certificate.max_trims} trims"
        rest = "leads to the goal" if plan.lower_bound is None else describe_lower_bound(plan)
        proved.append(f"no plan {depth} {rest} (certificate verified)")
    else:
        unproved += _lower_bound_sentences(plan)
    if plan.policy == "price-of-robustness" and plan.found:
        unproved += _price_sentences(plan)
    if plan.time_promise is not None:
        unproved.append(f"time bound: {plan.time_promise.sentence}; the flights are not repeated here")
    return Guarantees(tuple(proved), tuple(unproved))


def describe_lower_bound(plan: Plan) -> str:
    """Returns the plan's lower bound in words, following "no plan"."""
    return f"takes less than {max(plan.lower_bound or 0.0, 0.0):.3f} s"


def describe_gamma_range(plan: Plan) -> str:
    """Returns the gamma range of a committed plan in words."""
    return f"at every gamma from {-plan.gamma:g} to {plan.gamma:g}" if plan.gamma else "at gamma 0"


def _lower_bound_sentences(plan: Plan) -> list[str]:
    """Returns the unproved lower-bound claims of a plan without a certificate."""
    if plan.status == "optimal":
        none = "no certificate for committed plans" if plan.policy == "committed" else "no certificate"
        return [f"optimal: no plan {describe_lower_bound(plan)} ({none})"] if plan.cost else []
    if plan.lower_bound is not None and plan.lower_bound > 0:
        return [f"lower_bound: no plan {describe_lower_bound(plan)} (no certificate)"]
    return []


def _price_sentences(plan: Plan) -> list[str]:
    """Returns the claims about levels that have no scenario in the plan."""
    assert plan.alpha is not None
    return [
        f"alpha: no plan takes less than {plan.cost / plan.alpha:.3f} s at gamma 0",
        f"gamma: every gamma below {plan.gamma:g} meets alpha {plan.alpha:g}, and none above it does",
    ]
