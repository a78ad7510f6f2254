"""The policies that can be flown, and how they are named on the command line."""

from collections.abc import Mapping
from typing import Literal, get_args

from flight.errors import FlightError

FlownPolicy = Literal["nominal", "worst-case", "adaptive-gamma", "committed"]
"""What can be flown; `adaptive-gamma` is the worst case at a level that follows the turbulence."""

FLOWN_POLICIES: tuple[FlownPolicy, ...] = get_args(FlownPolicy)

COMPARED_POLICIES: tuple[FlownPolicy, ...] = ("nominal", "worst-case")
"""What is flown side by side where nothing else is asked."""

PlannedPolicy = Literal["nominal", "worst-case", "committed", "price-of-robustness"]
"""What a single mission can be planned with."""

DEFAULT_POLICY: PlannedPolicy = "worst-case"

CERTIFIABLE: tuple[PlannedPolicy, ...] = ("nominal", "worst-case")
"""Minima over coasting times at levels known beforehand, which `planner.proof.certify_plan` can prove."""

OPTION_POLICIES: Mapping[str, tuple[PlannedPolicy, ...]] = {
    "--gamma": ("worst-case", "committed"),
    "--alpha": ("price-of-robustness",),
    "--max-nodes": ("nominal", "worst-case", "committed"),
    "--deadline": ("nominal", "worst-case", "committed"),
    "--horizon": ("committed",),
    "--certify": CERTIFIABLE,
}
"""Which policies heed an option of `maneuver plan`; given with another it is refused, not ignored."""


def check_policy_options(
    policy: PlannedPolicy | None, options: Mapping[str, object], *, pareto: bool
) -> None:
    """Refuses an option that would be ignored.

    Args:
        policy: that is asked for, if any is.
        options: what was given, by name; None or False where nothing was.
        pareto: whether the price of robustness is asked for, which heeds none of them.

    Raises:
        FlightError: there is one; says what it goes with.
    """
    given = [option for option, value in options.items() if value is not None and value is not False]
    if pareto and (policy or given):
        first = given[0] if given else "--policy"
        raise FlightError(
            f"{first} does not go with --pareto, which plans for the worst case from gamma 0 to 1"
        )
    chosen = policy or DEFAULT_POLICY
    for option in given:
        if chosen not in OPTION_POLICIES[option]:
            raise FlightError(
                f"{option} goes with --policy {' or '.join(OPTION_POLICIES[option])}, got {chosen}"
            )
