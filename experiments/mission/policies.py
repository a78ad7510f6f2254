"""The policies: how they are named on the command line, what can be flown, and a planner for each name."""

from collections.abc import Mapping
from math import inf
from typing import Literal, get_args

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.plan.plan import Policy as PlannedPolicy
from planner.policies.nominal import nominal_planner
from planner.policies.policy import Planner
from planner.policies.price_of_robustness import PriceOfRobustness
from planner.policies.worst_case import worst_case_planner

FlownPolicy = Literal["nominal", "worst-case", "adaptive-gamma", "committed"]
"""What can be flown; `adaptive-gamma` is the worst case at a level that follows the turbulence."""

FLOWN_POLICIES: tuple[FlownPolicy, ...] = get_args(FlownPolicy)

COMPARED_POLICIES: tuple[FlownPolicy, ...] = ("nominal", "worst-case")
"""What is flown side by side where nothing else is asked."""

DEFAULT_POLICY: PlannedPolicy = "worst-case"

GAMMA, ALPHA = 1.0, 1.2
"""What is planned for where nothing is asked."""

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


def planner_of(
    policy: FlownPolicy | PlannedPolicy,
    library: Library,
    *,
    gamma: float = GAMMA,
    alpha: float = ALPHA,
    max_nodes: int | None = None,
    deadline: float = inf,
    horizon: float | None = None,
) -> Planner:
    """Returns the planner of a policy for a library; what the policy does not heed is ignored.

    Args:
        policy: its name.
        library: the primitives.
        gamma: uncertainty level of the worst-case and the committed planner.
        alpha: worst-case time that the price-of-robustness planner accepts, in nominal optima.
        max_nodes: walks at one level, or boxes of coasting times, that may be solved; None for all it needs.
        deadline: seconds after which the best plan so far is given.
        horizon: seconds that a committed plan may take.

    Raises:
        AlphaError: alpha is below 1.
        GammaError: the level is outside [0, 1].
        NegativeDurationError: the level turns a maneuver's duration negative.
    """
    # CasADi and SciPy take long to load: only what is asked for is.
    match policy:
        case "nominal":
            return nominal_planner(library, max_nodes=max_nodes, deadline=deadline)
        case "worst-case":
            return worst_case_planner(library, gamma, max_nodes=max_nodes, deadline=deadline)
        case "adaptive-gamma":
            from planner.policies.adaptive_gamma import AdaptiveGammaPlanner
            from sim.wind.wind import wind_class

            wind = wind_class(library.conditions.wind).wind_at_20_ft
            return AdaptiveGammaPlanner(library, wind, max_nodes=max_nodes)
        case "committed":
            from planner.commitment.committed import CommittedPlanner

            return CommittedPlanner(library, gamma, max_nodes=max_nodes, deadline=deadline, horizon=horizon)
        case "price-of-robustness":
            return PriceOfRobustness(library, alpha)


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
