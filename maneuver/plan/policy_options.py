"""Options of `maneuver plan` that go with some policies only."""

from collections.abc import Mapping

from experiments.mission.policies import CERTIFIABLE, DEFAULT_POLICY
from flight.errors import FlightError
from flight.plan.plan import Policy

OPTION_POLICIES: Mapping[str, tuple[Policy, ...]] = {
    "--gamma": ("worst-case", "committed"),
    "--alpha": ("price-of-robustness",),
    "--max-nodes": ("nominal", "worst-case", "committed"),
    "--deadline": ("nominal", "worst-case", "committed"),
    "--horizon": ("committed",),
    "--certify": CERTIFIABLE,
}
"""Policies for which an option of `maneuver plan` is valid; otherwise it is refused."""


def check_policy_options(policy: Policy | None, options: Mapping[str, object], *, pareto: bool) -> None:
    """Checks that no option would be ignored.

    Args:
        policy: the requested policy, if any.
        options: options by name; None or False where not given.
        pareto: True for `--pareto`, with which none of them is valid.

    Raises:
        FlightError: an option is not valid with the policy.
    """
    given = [option for option, value in options.items() if value is not None and value is not False]
    if pareto and (policy or given):
        first = given[0] if given else "--policy"
        raise FlightError(f"--pareto: expected no {first}, got one; it covers gamma 0 to 1 in the worst case")
    chosen = policy or DEFAULT_POLICY
    for option in given:
        if chosen not in OPTION_POLICIES[option]:
            raise FlightError(
                f"{option}: expected --policy {' or '.join(OPTION_POLICIES[option])}, got {chosen}"
            )
