"""Times that are promised with plans: found on one set of missions, put to the test on another."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf, isfinite

from scipy.stats import binom

from experiments.mission.policies import FlownPolicy
from experiments.mission.result import MissionResult
from flight.plan.time_bound import TimeBound

from .scorecard import CONFIDENCE, Proportion, group_by_condition, time_ratio

ROUNDING = 1e-9


@dataclass(frozen=True, slots=True)
class TimeBoundTrial:
    """A time that is promised with a plan, made on one set of missions and put to the test on another.

    Attributes:
        policy: which planner.
        gamma: uncertainty level planned for.
        plant: what flew.
        wind: wind class.
        share: of flights that are to reach the goal within the promised time.
        factor: promised time in parts of the predicted one; None where too few missions reached their goal.
        missions: of the set that it was made on.
        flights: likewise.
        kept: flights of the other set that kept it; the interval is for as many trials as it has missions.
        stated: whether it stood beside the library; where not, every second mission made it.
    """

    policy: FlownPolicy
    gamma: float
    plant: str
    wind: str
    share: float
    factor: float | None
    missions: int
    flights: int
    kept: Proportion
    stated: bool = False


def time_bound_trials(
    results: Iterable[MissionResult], *, share: float, stated: Sequence[TimeBound] = (), seed: int = -1
) -> tuple[TimeBoundTrial, ...]:
    """Returns what can be promised, tested on missions that did not make it.

    What stands beside the library is tested on all missions, unless they are those that it was made on.
    Otherwise every second mission sets the factor, and the others test it.

    Args:
        results: of all flights.
        share: of flights that are to keep the promise.
        stated: what stands beside the library.
        seed: that the missions were drawn with.
    """
    made = []
    for rows in group_by_condition(results).values():
        first, groups = rows[0], _by_mission(rows)
        condition = (first.policy, first.gamma, first.wind, share)
        own = [
            one
            for one in stated
            if first.plant == "helicopter" and (one.policy, one.gamma, one.wind, one.share) == condition
        ]
        if own and own[0].seed != seed:
            factor, known = own[0].factor, (own[0].missions, own[0].flights)
            tested = groups
        else:
            factor = time_factor(groups[::2], share)
            known, tested = (len(groups[::2]), sum(map(len, groups[::2]))), groups[1::2]
        if tested:
            made.append(_time_bound_trial(first, share, factor, known, tested, stated=tested is groups))
    return tuple(made)


def find_time_bounds(
    results: Iterable[MissionResult], *, share: float, seed: int
) -> tuple[tuple[TimeBound, ...], tuple[str, ...]]:
    """Returns what all missions together promise, and of which policies too few flights were there."""
    made, lacking = [], []
    for rows in group_by_condition(results).values():
        first, groups = rows[0], _by_mission(rows)
        factor = time_factor(groups, share)
        if not isfinite(factor):
            lacking.append(first.policy)
            continue
        made.append(
            TimeBound(
                policy=first.policy,
                gamma=first.gamma,
                wind=first.wind,
                share=share,
                factor=factor,
                missions=len(groups),
                flights=len(rows),
                seed=seed,
            )
        )
    return tuple(made), tuple(lacking)


def time_factor(groups: Sequence[Sequence[MissionResult]], share: float) -> float:
    """Returns the multiple of the predicted time that a share of flights keeps, of other missions too.

    It is a tolerance limit (Wilks 1941): with 95 % confidence no smaller share of flights to come keeps it.
    Flights of one mission resemble one another, so a mission is the sample, and each counts the same however
    often it was flown.
    """
    number = len(groups)
    # As many missions as no more than the share would hold with 95 % confidence.
    rank = int(binom.ppf(CONFIDENCE, number, share)) + 1
    if rank > number:
        return inf
    weighted = sorted((time_ratio(row), 1.0 / len(group)) for group in groups for row in group)
    seen = 0.0
    for value, weight in weighted:
        seen += weight
        if seen >= rank - ROUNDING:
            return value
    return inf


def _by_mission(rows: Sequence[MissionResult]) -> list[list[MissionResult]]:
    groups: dict[str, list[MissionResult]] = {}
    for row in rows:
        groups.setdefault(row.mission, []).append(row)
    return list(groups.values())


def _time_bound_trial(
    first: MissionResult,
    share: float,
    factor: float,
    known: tuple[int, int],
    tested: Sequence[Sequence[MissionResult]],
    *,
    stated: bool,
) -> TimeBoundTrial:
    kept = [[isfinite(factor) and time_ratio(row) <= factor for row in group] for group in tested]
    return TimeBoundTrial(
        policy=first.policy,
        gamma=first.gamma,
        plant=first.plant,
        wind=first.wind,
        share=share,
        factor=factor if isfinite(factor) else None,
        missions=known[0],
        flights=known[1],
        kept=Proportion.of_groups(kept),
        stated=stated,
    )
