"""Policies by their names on the command line."""

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
"""Policies for flights; `adaptive-gamma` is the worst case at a gamma that follows the turbulence."""

FLOWN_POLICIES: tuple[FlownPolicy, ...] = get_args(FlownPolicy)

COMPARED_POLICIES: tuple[FlownPolicy, ...] = ("nominal", "worst-case")
"""Policies compared by default."""

DEFAULT_POLICY: PlannedPolicy = "worst-case"

GAMMA, ALPHA = 1.0, 1.2
"""What is planned for where nothing is asked."""

CERTIFIABLE: tuple[PlannedPolicy, ...] = ("nominal", "worst-case")
"""Policies whose optima at known gammas `planner.proof.certify_plan` can prove."""

OPTION_POLICIES: Mapping[str, tuple[PlannedPolicy, ...]] = {
    "--gamma": ("worst-case", "committed"),
    "--alpha": ("price-of-robustness",),
    "--max-nodes": ("nominal", "worst-case", "committed"),
    "--deadline": ("nominal", "worst-case", "committed"),
    "--horizon": ("committed",),
    "--certify": CERTIFIABLE,
}
"""Policies for which an option of `maneuver plan` is valid; otherwise it is refused."""


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
        raise FlightError(f"--pareto plans the worst case from gamma 0 to 1: expected no {first}, got one")
    chosen = policy or DEFAULT_POLICY
    for option in given:
        if chosen not in OPTION_POLICIES[option]:
            raise FlightError(
                f"{option}: expected --policy {' or '.join(OPTION_POLICIES[option])}, got {chosen}"
            )
