"""How far a single gamma can be trusted: every primitive with a sign of its own (thesis, appendix B).

The policies scale all errors by one gamma. Here each trim and each maneuver of a plan's walk takes its own,
from -g, 0 and g: 3^(n_T + n_M) scenarios. Where one of them takes longer than every single gamma, or ends
further from the goal, it is a counter-example. These are corners: through turns they are no bound on what
lies between.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError
from flight.library import Library
from flight.mission import Mission
from flight.se2 import rotate

from .kernel.exact import least_costs_of_each
from .kernel.tables import Table, fold

MOST_PRIMITIVES = 11
"""Of a walk; more scenarios than 3 to this power are not enumerated."""


class TooManyScenariosError(FlightError):
    """A walk is too long for all signs to be tried."""

    def __init__(self, primitives: int) -> None:
        super().__init__(
            f"expected at most {MOST_PRIMITIVES} trims and maneuvers in a walk whose signs are all tried, "
            f"got {primitives}"
        )


@dataclass(frozen=True, slots=True)
class Scenario:
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
class Signs:
    """All scenarios of a walk.

    Attributes:
        scenarios: every choice of signs.
        slowest: the one that takes longest.
        furthest: the one that ends furthest from the goal.
        slowest_single: the slowest of those with one sign for all.
        furthest_single: the furthest of those.
    """

    scenarios: tuple[Scenario, ...]
    slowest: Scenario
    furthest: Scenario
    slowest_single: Scenario
    furthest_single: Scenario


def all_signs(
    library: Library,
    mission: Mission,
    sequence: tuple[int, ...],
    coasting_times: tuple[float, ...],
    *,
    gamma: float = 1.0,
) -> Signs:
    """Returns what every choice of signs comes to.

    Args:
        library: the primitives.
        mission: from where to where.
        sequence: trims of the walk.
        coasting_times: seconds, committed before the signs are known.
        gamma: what the signs scale.

    Raises:
        TooManyScenariosError: the walk is too long.
        NoKernelError: there is no C compiler.
    """
    primitives = 2 * len(sequence) - 1
    if primitives > MOST_PRIMITIVES:
        raise TooManyScenariosError(primitives)
    signs = np.array(list(product((-1, 0, 1), repeat=primitives)))
    trims = [library.trim(trim) for trim in sequence]
    maneuvers = library.maneuvers_along(sequence)
    # Trims at the even places, maneuvers at the odd ones.
    twists = [[trim.at(one) for trim in trims] for one in (-gamma, 0.0, gamma)]
    outcomes = [[maneuver.at(one) for maneuver in maneuvers] for one in (-gamma, 0.0, gamma)]
    which, step = signs[:, 0::2] + 1, signs[:, 1::2] + 1
    at, edge = np.arange(len(trims)), np.arange(len(maneuvers))
    velocity = np.array([[complex(one.forward, one.side) for one in row] for row in twists])[which, at]
    rate = np.array([[one.yaw_rate for one in row] for row in twists])[which, at]
    moved = np.array([[complex(one.displacement.x, one.displacement.y) for one in row] for row in outcomes])
    turn = np.array([[one.displacement.heading for one in row] for row in outcomes])[step, edge]
    durations = np.array([[one.duration for one in row] for row in outcomes])[step, edge]
    displacement = moved[step, edge]
    table = fold(
        np.tile(np.array(sequence), (len(signs), 1)),
        velocity=velocity,
        rate=rate,
        displacement=displacement,
        turn=turn,
        fixed=durations.sum(axis=1),
    )
    costs = least_costs_of_each(table, mission)
    misses = _misses(mission, np.array(coasting_times), table)
    scenarios = tuple(
        Scenario(tuple(row), cost, miss)
        for row, cost, miss in zip(signs.tolist(), costs.tolist(), misses.tolist(), strict=True)
    )
    single = [one for one in scenarios if len(set(one.signs)) == 1]
    return Signs(
        scenarios,
        slowest=max(scenarios, key=lambda one: one.cost),
        furthest=max(scenarios, key=lambda one: one.miss),
        slowest_single=max(single, key=lambda one: one.cost),
        furthest_single=max(single, key=lambda one: one.miss),
    )


def _misses(mission: Mission, times: Float[np.ndarray, "trims"], table: Table) -> Float[np.ndarray, "rows"]:
    """Returns how far from the goal each scenario ends with these coasting times, in metres."""
    rate, velocity, _, displacement = table.arrays[:4]
    position = np.zeros(len(rate), dtype=complex)
    heading = np.zeros(len(rate))
    for place, time in enumerate(times.tolist()):
        position = position + np.exp(1j * heading) * displacement[:, place]
        half = 0.5 * rate[:, place] * time
        chord = velocity[:, place] * time * np.sinc(half / np.pi)
        position = position + np.exp(1j * (heading + half)) * chord
        heading = heading + 2 * half
    start = mission.start
    north, east = rotate(mission.goal[0] - start.x, mission.goal[1] - start.y, -start.heading)
    misses: Float[np.ndarray, "rows"] = np.abs(position - complex(north, east))
    return misses
