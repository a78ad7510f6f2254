"""Time bounds of plans, found on some missions and tested on others."""

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
    """A time bound with its test on other missions.

    Attributes:
        policy: policy of the planner.
        gamma: gamma of the plans.
        plant: name of the plant.
        wind: wind class.
        share: share of flights that reach the goal within the bound.
        factor: bound over predicted time; None for too few missions that reached their goal.
        missions: number of missions that it was found on.
        flights: number of flights that it was found on.
        kept: test flights within the bound; the interval has one trial per mission.
        stated: True for a bound of the library; otherwise every second mission set it.
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
    """Tests time bounds on missions other than those they were found on.

    A bound of the library is tested on all missions, unless it was found on them. Otherwise every second
    mission sets the factor, and the others test it.

    Args:
        results: results of all flights.
        share: share of flights within the bound.
        stated: time bounds of the library.
        seed: seed of the missions.
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
    """Returns the time bounds of all missions, and policies without one."""
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
    """Returns the factor on the predicted time for a share of flights.

    It is a tolerance limit (Wilks 1941): with 95 % confidence at least this share of future flights is within
    it. Flights of one mission are alike, so a mission is the sample, with the same weight for any number of
    flights.
    """
    number = len(groups)
    # Least number of missions within the factor that proves the share with 95 % confidence.
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
