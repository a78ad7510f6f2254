"""Independent primitive errors against a single gamma (thesis, appendix B).

The policies scale all errors by one gamma. Here each trim and each maneuver of a plan's walk, or each of
their scalars, takes its own from -g, 0 and g: 3^(n_T + n_M) scenarios. A scenario that takes longer than
every single gamma, or ends further from the goal, is a counter-example. These corners do not bound the errors
between them where the walk turns; an enclosure of the whole box of errors does.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product
from math import inf

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.mission import Mission
from planner.kernel.exact import least_costs
from planner.walks.goal_condition import goal_from_start

from .bounded_maximum import BoundedMaximum
from .error_path import ErrorGranularity, ErrorPath, error_path
from .worst_miss import worst_miss_bound
from .worst_time import MOST_TIME_BOXES, worst_time_bound

MOST_PRIMITIVES = 11
"""Of a walk; more scenarios than 3 to this power are not listed."""

MOST_ENUMERATED = 9
"""Error variables up to which every corner is tried; beyond, local search is used."""


class TooManyScenariosError(FlightError):
    """A walk is too long for an enumeration of all signs."""

    def __init__(self, primitives: int) -> None:
        super().__init__(
            f"expected at most {MOST_PRIMITIVES} trims and maneuvers to enumerate all signs, got {primitives}"
        )


@dataclass(frozen=True, slots=True)
class SignScenario:
    """One choice of signs.

    Attributes:
        signs: -1, 0 or 1 for each trim and maneuver, in the order flown: trim, maneuver, trim, ...
        cost: seconds with the coasting times chosen for it; infinite where it cannot reach the goal.
        miss: metres between the goal and where the coasting times of the plan lead.
    """

    signs: tuple[int, ...]
    cost: float
    miss: float


@dataclass(frozen=True, slots=True)
class SignScenarios:
    """All scenarios of a walk.

    Attributes:
        scenarios: every choice of signs.
        slowest: the one that takes longest.
        furthest: the one that ends furthest from the goal.
        slowest_single: the slowest of those with one sign for all.
        furthest_single: the furthest of those.
    """

    scenarios: tuple[SignScenario, ...]
    slowest: SignScenario
    furthest: SignScenario
    slowest_single: SignScenario
    furthest_single: SignScenario


def enumerate_signs(
    library: Library,
    mission: Mission,
    sequence: tuple[int, ...],
    coasting_times: tuple[float, ...],
    *,
    gamma: float = 1.0,
) -> SignScenarios:
    """Returns the scenarios of every choice of signs.

    Args:
        library: the primitives.
        mission: from where to where.
        sequence: trims of the walk.
        coasting_times: seconds, committed before the signs are known.
        gamma: scale of the signed errors.

    Raises:
        TooManyScenariosError: the walk is too long.
        NoMachineCodeError: there is no C compiler that works.
    """
    path = error_path(library, sequence, gamma, "primitive")
    if len(path.names) > MOST_PRIMITIVES:
        raise TooManyScenariosError(len(path.names))
    signs = np.array(list(product((-1, 0, 1), repeat=len(path.names))))
    errors = signs.astype(float)
    costs = least_costs(path.table(errors), mission)
    misses = _misses(path, mission, coasting_times, errors)
    scenarios = tuple(
        SignScenario(tuple(row), cost, miss)
        for row, cost, miss in zip(signs.tolist(), costs.tolist(), misses.tolist(), strict=True)
    )
    single = [one for one in scenarios if len(set(one.signs)) == 1]
    return SignScenarios(
        scenarios,
        slowest=max(scenarios, key=lambda one: one.cost),
        furthest=max(scenarios, key=lambda one: one.miss),
        slowest_single=max(single, key=lambda one: one.cost),
        furthest_single=max(single, key=lambda one: one.miss),
    )


@dataclass(frozen=True, slots=True)
class ExtremeCase:
    """One choice of errors with its seconds or metres."""

    errors: tuple[float, ...]
    value: float


@dataclass(frozen=True, slots=True)
class IndependentErrorBounds:
    """Bounds of independent errors: single gamma, corners, and over all errors.

    Attributes:
        names: of the error variables.
        scenarios: corners that there are.
        all_tried: True if every corner was evaluated; False for a local search.
        slowest_single: the slowest with one value -1, 0 or 1 for all, coasting times chosen for it; seconds.
        furthest_single: with the plan's coasting times, the furthest from the goal; metres.
        slowest: the slowest corner found.
        furthest: the furthest corner found.
        slowest_bound: upper bound over the whole box, and the slowest found in it.
        furthest_bound: likewise for the miss.
    """

    names: tuple[str, ...]
    scenarios: int
    all_tried: bool
    slowest_single: ExtremeCase
    furthest_single: ExtremeCase
    slowest: ExtremeCase
    furthest: ExtremeCase
    slowest_bound: BoundedMaximum
    furthest_bound: BoundedMaximum


def bound_independent_errors(
    library: Library,
    mission: Mission,
    sequence: tuple[int, ...],
    coasting_times: tuple[float, ...],
    *,
    gamma: float = 1.0,
    each: ErrorGranularity = "primitive",
    most_boxes: int = MOST_TIME_BOXES,
) -> IndependentErrorBounds:
    """Returns the worst effects of independent errors on a plan.

    Args:
        library: the primitives.
        mission: from where to where.
        sequence: trims of the walk.
        coasting_times: seconds, committed before the errors are known.
        gamma: scale of the error variables from -1 to 1.
        each: unit with an error variable of its own.
        most_boxes: boxes of errors that the bound of the time may use.

    Raises:
        NoMachineCodeError: there is no C compiler that works.
    """
    path = error_path(library, sequence, gamma, each)
    count = len(path.names)
    one_sign = np.array([[sign] * count for sign in (-1.0, 0.0, 1.0)])

    def seconds(errors: Float[np.ndarray, "n variables"]) -> Float[np.ndarray, "n"]:
        return least_costs(path.table(errors), mission)

    def metres(errors: Float[np.ndarray, "n variables"]) -> Float[np.ndarray, "n"]:
        return _misses(path, mission, coasting_times, errors)

    enumerated = count <= MOST_ENUMERATED
    corners = np.array(list(product((-1.0, 0.0, 1.0), repeat=count))) if enumerated else one_sign
    search = _largest_case if enumerated else _climb
    slowest, furthest = search(seconds, corners), search(metres, corners)
    known = BoundedMaximum(slowest.value, slowest.errors, inf, 0)
    arrives = slowest.value < inf
    miss = worst_miss_bound(path, mission, coasting_times)
    if furthest.value > miss.found:
        miss = replace(miss, found=furthest.value, errors=furthest.errors)
    return IndependentErrorBounds(
        names=path.names,
        scenarios=3**count,
        all_tried=enumerated,
        slowest_single=_largest_case(seconds, one_sign),
        furthest_single=_largest_case(metres, one_sign),
        slowest=slowest,
        furthest=furthest,
        slowest_bound=worst_time_bound(path, mission, known, most=most_boxes) if arrives else known,
        furthest_bound=miss,
    )


def _largest_case(
    value: Callable[[Float[np.ndarray, "n variables"]], Float[np.ndarray, "n"]],
    choices: Float[np.ndarray, "n variables"],
) -> ExtremeCase:
    values = value(choices)
    best = int(values.argmax())
    return ExtremeCase(tuple(choices[best].tolist()), float(values[best]))


def _climb(
    value: Callable[[Float[np.ndarray, "n variables"]], Float[np.ndarray, "n"]],
    starts: Float[np.ndarray, "n variables"],
) -> ExtremeCase:
    """Returns the largest value by coordinate ascent over corners."""
    best = ExtremeCase((), -inf)
    for start in starts:
        here, known = start, float(value(start[None])[0])
        while True:
            steps = np.repeat(here[None], 3 * len(here), axis=0)
            for place in range(len(here)):
                steps[3 * place : 3 * place + 3, place] = (-1.0, 0.0, 1.0)
            next_ = _largest_case(value, steps)
            if next_.value <= known:
                break
            here, known = np.array(next_.errors), next_.value
        if known > best.value:
            best = ExtremeCase(tuple(here.tolist()), known)
    return best


def _misses(
    path: ErrorPath, mission: Mission, times: tuple[float, ...], errors: Float[np.ndarray, "n variables"]
) -> Float[np.ndarray, "n"]:
    """Returns each choice of errors' miss in metres."""
    ends = path.at(errors).end(np.tile(np.array(times), (len(errors), 1)))
    misses: Float[np.ndarray, "n"] = np.abs(ends - goal_from_start(mission))
    return misses
