"""Monotonicity audit of the sign convention over random missions.

The errors are signed so that gamma = +1 means fast and wide for every primitive at once
(`flight.automaton.sign_convention`). Whether the optimal time then falls from gamma = -1 to gamma = +1 is
no theorem (thesis, appendix B). Where it rises, the walk that was best before the rise is solved again with
one number of one primitive held back: the one whose holding back saves most is what broke it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import cos, inf, isfinite, pi, sin

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.se2 import SE2
from planner.kernel.exact import ExactSearch, least_costs
from planner.kernel.tables import kernel_table
from planner.walks.kinematics import check_durations
from planner.walks.walk import Walk

GAMMAS = (-1.0, 0.0, 1.0)
"""Levels compared."""

TOLERANCE = 1e-6
"""Seconds by which a time must rise to count."""

NEAREST, FURTHEST = 1.0, 80.0
"""Metres to the goal of a random mission."""

_TRIM_NUMBERS = ("forward", "side", "yaw_rate")
_MANEUVER_NUMBERS = ("duration", "forward", "side", "heading_change")


@dataclass(frozen=True, slots=True, order=True)
class PrimitiveScalar:
    """One scalar of one primitive: kind, id and name."""

    kind: str
    id: int
    name: str


@dataclass(frozen=True, slots=True)
class TimeIncrease:
    """A mission whose optimal time rises with gamma.

    Attributes:
        mission: place among the missions.
        gammas: the two levels.
        times: optimal times in seconds; the second is infinite where nothing reaches the goal any more.
        walk: the best at the first level.
        culprit: the scalar that saves most when kept at the first level; None if none saves any.
        saved: seconds that it saves on this walk; infinite where it makes the goal reachable.
    """

    mission: int
    gammas: tuple[float, float]
    times: tuple[float, float]
    walk: Walk
    culprit: PrimitiveScalar | None
    saved: float


@dataclass(frozen=True, slots=True)
class MonotonicityAudit:
    """Counts and exceptions of a monotonicity audit.

    Attributes:
        missions: number tried.
        reachable: number with a plan at one level or more.
        monotone: number of those whose time never rises with gamma.
        rises: the exceptions.
    """

    missions: int
    reachable: int
    monotone: int
    rises: tuple[TimeIncrease, ...]


def audit_monotonicity(
    library: Library, *, missions: int, seed: int, max_trims: int = 4
) -> MonotonicityAudit:
    """Returns how often the optimal time is monotone in gamma.

    Args:
        library: the primitives.
        missions: number, at random: any start trim and heading, 1 to 80 m, half of them met exactly.
        seed: of the missions.
        max_trims: longest walk searched.

    Raises:
        NegativeDurationError: a level turns a maneuver's duration negative.
        NoMachineCodeError: there is no C compiler that works.
    """
    for gamma in GAMMAS:
        check_durations(library, gamma)
    searches = [ExactSearch(library, (gamma,)) for gamma in GAMMAS]
    rises: list[TimeIncrease] = []
    reachable = monotone = 0
    for place, mission in enumerate(_missions(library, missions, seed, max_trims)):
        evaluator = [search.answer(mission) for search in searches]
        times = [answer.costs[0] if answer.walk else inf for answer in evaluator]
        if not any(isfinite(time) for time in times):
            continue
        reachable += 1
        before = len(rises)
        for (low, high), levels in zip(pairwise(range(len(GAMMAS))), pairwise(GAMMAS), strict=True):
            if times[high] > times[low] + TOLERANCE:
                walk = evaluator[low].walk
                culprit, saved = _costliest_scalar(library, mission, walk, levels)
                rises.append(TimeIncrease(place, levels, (times[low], times[high]), walk, culprit, saved))
        monotone += len(rises) == before
    return MonotonicityAudit(missions, reachable, monotone, tuple(rises))


def _missions(library: Library, count: int, seed: int, max_trims: int) -> Iterator[Mission]:
    rng = np.random.default_rng(seed)
    ids = [trim.id for trim in library.trims]
    for place in range(count):
        angle, distance = rng.uniform(-pi, pi), rng.uniform(NEAREST, FURTHEST)
        yield Mission(
            f"audit-{place}",
            SE2(0.0, 0.0, float(rng.uniform(-pi, pi))),
            int(rng.choice(ids)),
            (float(distance * cos(angle)), float(distance * sin(angle))),
            tolerance=float(rng.choice([0.0, 0.05 * distance])),
            max_trims=max_trims,
        )


def _costliest_scalar(
    library: Library, mission: Mission, walk: Walk, levels: tuple[float, float]
) -> tuple[PrimitiveScalar | None, float]:
    """Returns the scalar with the largest cost change between two levels."""
    trims, maneuvers = [library.trim(trim) for trim in walk], library.maneuvers_along(walk)
    owners = [PrimitiveScalar("trim", trim.id, name) for trim in trims for name in _TRIM_NUMBERS]
    owners += [PrimitiveScalar("maneuver", row.id, name) for row in maneuvers for name in _MANEUVER_NUMBERS]
    numbers = sorted(set(owners))
    # The first row takes every scalar to the second level, each further row keeps one at the first.
    gamma = np.full((len(numbers) + 1, len(owners)), levels[1])
    for row, number in enumerate(numbers, start=1):
        gamma[row, [owner == number for owner in owners]] = levels[0]
    nominal = [
        value
        for trim in trims
        for value in (trim.velocity.forward, trim.velocity.side, trim.velocity.yaw_rate)
    ]
    error = [value for trim in trims for value in (trim.error.forward, trim.error.side, trim.error.yaw_rate)]
    for maneuver in maneuvers:
        moved, off = maneuver.displacement, maneuver.error
        nominal += [maneuver.duration, moved.x, moved.y, moved.heading]
        error += [off.duration, off.forward, off.side, off.heading_change]
    costs = _costs(np.array(nominal) + gamma * np.array(error), mission, walk)
    best = int(np.argmin(costs[1:])) + 1
    saved = float(costs[0] - costs[best]) if isfinite(costs[best]) else 0.0
    return (numbers[best - 1], saved) if saved > TOLERANCE else (None, 0.0)


def _costs(values: Float[np.ndarray, "rows n"], mission: Mission, walk: Walk) -> Float[np.ndarray, "rows"]:
    """Returns the least time of one walk for each row's coefficients."""
    rows, split = len(values), len(_TRIM_NUMBERS) * len(walk)
    trims = values[:, :split].reshape(rows, len(walk), len(_TRIM_NUMBERS))
    maneuvers = values[:, split:].reshape(rows, len(walk) - 1, len(_MANEUVER_NUMBERS))
    table = kernel_table(
        np.tile(np.array(walk), (rows, 1)),
        velocity=trims[:, :, 0] + 1j * trims[:, :, 1],
        rate=trims[:, :, 2],
        displacement=maneuvers[:, :, 1] + 1j * maneuvers[:, :, 2],
        turn=maneuvers[:, :, 3],
        fixed=maneuvers[:, :, 0].sum(axis=1),
    )
    return least_costs(table, mission)
