"""Price of robustness: tolerable gamma for an allowed time (thesis, Problem 4.2).

A level meets alpha where at it, and at every smaller one, the best worst-case time is at most alpha times the
nominal optimum. That time is computed on a grid of levels and bisected where it first exceeds the limit;
`certified_gamma.py` then proves the levels in between.
"""

from dataclasses import dataclass, replace
from math import inf
from time import perf_counter

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.mission import Mission
from flight.plan.plan import Plan
from planner.walks.kinematics import NegativeDurationError

from .certified_gamma import certified_gamma
from .nominal import nominal_planner
from .worst_case import worst_case_planner

STEPS = 40
"""Levels above 0 on the grid, evenly up to 1."""

ON_A_GRID = f"it was computed only at levels {1 / STEPS:g} apart"

ALL_BUT = 1e-3
"""Levels below the largest in which a proof may leave off: there the time is all but the limit."""

GAMMA_RESOLUTION = 1e-6
"""Resolution of the largest level that meets alpha; the plan is the one just below it."""

TO_THE_RESOLUTION = f"gamma {GAMMA_RESOLUTION:g} exceeds alpha"


class AlphaError(FlightError):
    """Alpha is below 1 or not a number."""

    def __init__(self, alpha: float) -> None:
        super().__init__(f"alpha must be >= 1, got {alpha}")


@dataclass(frozen=True, slots=True)
class PricePoint:
    """One point of the curve.

    Attributes:
        gamma: uncertainty level.
        cost: the best worst-case time at that level in seconds; infinite where no plan was found.
        alpha: the largest ratio of that time to the nominal optimum at this and all smaller levels computed.
        sequence: trims of the plan; empty without one.
    """

    gamma: float
    cost: float
    alpha: float
    sequence: tuple[int, ...]


def price_curve(library: Library, mission: Mission, *, steps: int = STEPS) -> tuple[PricePoint, ...]:
    """Returns the curve from gamma 0 to 1; empty if infeasible.

    Args:
        library: the primitives.
        mission: from where to where.
        steps: levels above 0.
    """
    nominal = nominal_planner(library).plan(mission)
    if not nominal.found:
        return ()
    curve = [PricePoint(0.0, nominal.cost, 1.0, nominal.sequence)]
    for step in range(1, steps + 1):
        gamma = step / steps
        plan = _worst_case(library, gamma, mission)
        cost = inf if plan is None else plan.cost
        alpha = max(curve[-1].alpha, _cost_ratio(cost, nominal.cost))
        curve.append(PricePoint(gamma, cost, alpha, () if plan is None else plan.sequence))
    return tuple(curve)


class PriceOfRobustness:
    """Planner for the largest gamma within a time limit alpha.

    Args:
        library: the primitives.
        alpha: worst-case time that is accepted, in nominal optima.

    Raises:
        AlphaError: alpha is below 1, or no number.
    """

    def __init__(self, library: Library, alpha: float) -> None:
        if not 1 <= alpha < inf:
            raise AlphaError(alpha)
        self._library = library
        self._alpha = alpha

    def plan(self, mission: Mission) -> Plan:
        """Returns the worst-case plan at the largest gamma within the limit.

        Raises:
            UnknownTrimError: the library lacks the start or goal trim.
        """
        began = perf_counter()
        best = nominal_planner(self._library).plan(mission)
        if not best.found:
            return replace(best, policy="price-of-robustness", alpha=self._alpha)
        # The equality at gamma 0 must survive rounding.
        limit = self._alpha * best.cost + 1e-9
        low, high = 0.0, None
        for step in range(1, STEPS + 1):
            plan = self._within(step / STEPS, limit, mission)
            if plan is None:
                high = step / STEPS
                break
            low, best = step / STEPS, plan
        while high is not None and high - low > GAMMA_RESOLUTION:
            middle = 0.5 * (low + high)
            plan = self._within(middle, limit, mission)
            if plan is None:
                high = middle
            else:
                low, best = middle, plan
        proved = certified_gamma(self._library, mission, limit=limit, gamma=low)
        return replace(
            best,
            status="feasible",
            reason=_gamma_reason(low, proved),
            lower_bound=None,
            policy="price-of-robustness",
            gamma=low,
            alpha=self._alpha,
            solve_time=perf_counter() - began,
        )

    def _within(self, gamma: float, limit: float, mission: Mission) -> Plan | None:
        plan = _worst_case(self._library, gamma, mission)
        return plan if plan is not None and plan.cost <= limit else None


def _gamma_reason(gamma: float, proved: float) -> str:
    """Returns the proof status of the levels below gamma."""
    if gamma == 0:
        return TO_THE_RESOLUTION
    if proved >= gamma:
        return "every smaller gamma meets alpha, proved"
    if proved > 0:
        nearly = "; above it the time is close to alpha" if proved >= gamma - ALL_BUT else f"; {ON_A_GRID}"
        return f"every gamma up to {proved:.6g} meets alpha, proved{nearly}"
    return f"not proved that every smaller gamma meets alpha: {ON_A_GRID}"


def _worst_case(library: Library, gamma: float, mission: Mission) -> Plan | None:
    try:
        plan = worst_case_planner(library, gamma).plan(mission)
    except NegativeDurationError:
        return None
    return plan if plan.found else None


def _cost_ratio(cost: float, nominal: float) -> float:
    if nominal:
        return cost / nominal
    return 1.0 if cost == 0 else inf
