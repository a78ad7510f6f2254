"""Options of `maneuver plan` that go with some policies only."""

from collections.abc import Mapping

from experiments.mission.policies import CERTIFIABLE, DEFAULT_POLICY
from flight.errors import FlightError
from flight.plan.plan import Policy

HEEDED: Mapping[str, tuple[Policy, ...]] = {
    "--gamma": ("worst-case", "committed"),
    "--alpha": ("price-of-robustness",),
    "--max-nodes": ("nominal", "worst-case", "committed"),
    "--deadline": ("nominal", "worst-case", "committed"),
    "--horizon": ("committed",),
    "--certify": CERTIFIABLE,
}
"""Which policies heed an option of `maneuver plan`; given with another it is refused, not ignored."""


def refuse_misfits(policy: Policy | None, options: Mapping[str, object], *, pareto: bool) -> None:
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
        if chosen not in HEEDED[option]:
            raise FlightError(f"{option} goes with --policy {' or '.join(HEEDED[option])}, got {chosen}")
