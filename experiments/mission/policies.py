"""Policies by their names on the command line."""

from math import inf
from typing import Literal, get_args

from flight.automaton.library import Library
from flight.plan.plan import Policy as PlannedPolicy
from planner.policies.nominal import nominal_planner
from planner.policies.policy import Planner
from planner.policies.worst_case import worst_case_planner

PlanningPolicy = Literal["nominal", "worst-case", "adaptive-gamma", "committed"]
"""Policies that make plans in flight.

`adaptive-gamma` is the worst case at a gamma that follows the turbulence.
"""

FlownPolicy = Literal["nominal", "worst-case", "adaptive-gamma", "committed", "feedback"]
"""Policies for flights; `feedback` decides by a table and makes no plans."""

FLOWN_POLICIES: tuple[FlownPolicy, ...] = get_args(FlownPolicy)

COMPARED_POLICIES: tuple[PlanningPolicy, ...] = ("nominal", "worst-case")
"""Policies compared by default."""

DEFAULT_POLICY: PlannedPolicy = "worst-case"

GAMMA, ALPHA = 1.0, 1.2
"""Default gamma and alpha of planning."""

ONE_LEVEL: tuple[FlownPolicy, ...] = ("nominal", "feedback")
"""Policies that know no gamma."""

CERTIFIABLE: tuple[PlannedPolicy, ...] = ("nominal", "worst-case")
"""Policies whose optima at known gammas `planner.proof.certify_plan` can prove."""


def planner_of(
    policy: PlanningPolicy | PlannedPolicy,
    library: Library,
    *,
    gamma: float = GAMMA,
    alpha: float = ALPHA,
    max_nodes: int | None = None,
    deadline: float = inf,
    horizon: float | None = None,
) -> Planner:
    """Returns the planner of a policy; parameters of other policies are ignored.

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
            from sim.wind.wind_class import wind_class

            wind = wind_class(library.conditions.wind).wind_at_20_ft
            return AdaptiveGammaPlanner(library, wind, max_nodes=max_nodes)
        case "committed":
            from planner.commitment.committed import CommittedPlanner

            return CommittedPlanner(library, gamma, max_nodes=max_nodes, deadline=deadline, horizon=horizon)
        case "price-of-robustness":
            from planner.policies.price_of_robustness import PriceOfRobustness

            return PriceOfRobustness(library, alpha)
