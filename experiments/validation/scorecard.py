"""Scorecard of closed-loop flights against predicted times."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import ceil, inf, isfinite, sqrt
from statistics import NormalDist, median

from scipy.stats import binomtest

from experiments.mission.policies import FlownPolicy
from experiments.mission.result import MissionResult

CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True)
class Proportion:
    """A count of a total, with the share's 95 % Wilson interval."""

    count: int
    of: int
    low: float
    high: float

    @classmethod
    def of_groups(cls, groups: Sequence[Sequence[bool]]) -> "Proportion":
        """Returns the share over groups that are independent of one another.

        The interval is Wilson's with one trial per group, which is conservative.
        """
        count, of, number = sum(map(sum, groups)), sum(map(len, groups)), len(groups)
        z = NormalDist().inv_cdf(0.5 + CONFIDENCE / 2)
        share = sum(sum(group) / len(group) for group in groups) / number
        middle = (share + z**2 / (2 * number)) / (1 + z**2 / number)
        half = z * sqrt(share * (1 - share) / number + (z / (2 * number)) ** 2) / (1 + z**2 / number)
        return cls(count, of, max(middle - half, 0.0), min(middle + half, 1.0))

    @classmethod
    def counted(cls, rows: Sequence[MissionResult], holds: Callable[[MissionResult], bool]) -> "Proportion":
        """Returns the share of flights that meet a condition."""
        count = sum(map(holds, rows))
        interval = binomtest(count, len(rows)).proportion_ci(CONFIDENCE, method="wilson")
        return cls(count, len(rows), float(interval.low), float(interval.high))


@dataclass(frozen=True, slots=True)
class ScorecardCell:
    """Flights of one mission, or all, with one policy, plant and wind.

    Attributes:
        mission: name; `all` for all missions together.
        policy: policy of the planner.
        gamma: gamma of the plans; 0 for the nominal policy.
        plant: name of the plant.
        wind: wind class.
        reached: flights that reached the goal on a plan.
        inside: flights that did so within the predicted time.
        flown_time: median seconds of the flights that reached it; None without one.
        flown_time_95: 95 % quantile of the flown time; None where more than 5 % did not reach the goal.
        planned_time: median time of the plans for the missions as stated; None without one.
        predicted_time: median predicted time of the first plans; None without one.
        miss: largest miss distance in metres of flights that did not reach the goal; None where all did.
        replans: median number of replans per flight.
        failures: total number of replans without a plan.
        safe_stops: total number of safe stops begun.
        planning_time_99: 99 % quantile of the replans' CPU seconds; None without one.
        reasons: distinct reasons why flights did not reach the goal.
    """

    mission: str
    policy: FlownPolicy
    gamma: float
    plant: str
    wind: str
    reached: Proportion
    inside: Proportion
    flown_time: float | None
    flown_time_95: float | None
    planned_time: float | None
    predicted_time: float | None
    miss: float | None
    replans: float
    failures: int
    safe_stops: int
    planning_time_99: float | None
    reasons: tuple[str, ...]

    @property
    def flights(self) -> int:
        """Number of flights."""
        return self.reached.of


def scorecard_cells(results: Iterable[MissionResult]) -> tuple[ScorecardCell, ...]:
    """Returns a cell per mission and condition, in the order flown."""
    groups: dict[tuple[object, ...], list[MissionResult]] = {}
    for row in results:
        groups.setdefault((row.mission, *_condition(row)), []).append(row)
    return tuple(_cell(rows[0].mission, rows) for rows in groups.values())


def scorecard_totals(results: Iterable[MissionResult]) -> tuple[ScorecardCell, ...]:
    """Returns a cell per condition for all missions together."""
    return tuple(_cell("all", rows) for rows in group_by_condition(results).values())


def group_by_condition(results: Iterable[MissionResult]) -> dict[tuple[object, ...], list[MissionResult]]:
    """Groups the flights by policy, gamma, plant and wind."""
    groups: dict[tuple[object, ...], list[MissionResult]] = {}
    for row in results:
        groups.setdefault(_condition(row), []).append(row)
    return groups


def _condition(row: MissionResult) -> tuple[object, ...]:
    return row.policy, row.gamma, row.plant, row.wind


def _cell(mission: str, rows: Sequence[MissionResult]) -> ScorecardCell:
    first = rows[0]
    reached = [row for row in rows if row.reached]
    planned = [row.planned_time for row in rows if row.planned_time is not None]
    predictions = [row.predicted_time for row in rows if row.predicted_time is not None]
    times = [row.flown_time if row.reached else inf for row in rows]
    cpu_times = [time for row in rows for time in row.planning_times]
    return ScorecardCell(
        mission=mission,
        policy=first.policy,
        gamma=first.gamma,
        plant=first.plant,
        wind=first.wind,
        reached=Proportion.counted(rows, lambda row: row.reached),
        inside=Proportion.counted(rows, lambda row: time_ratio(row) <= 1),
        flown_time=median(row.flown_time for row in reached) if reached else None,
        flown_time_95=_finite_or_none(quantile(times, 0.95)),
        planned_time=median(planned) if planned else None,
        predicted_time=median(predictions) if predictions else None,
        miss=max((row.closest for row in rows if not row.reached and row.closest is not None), default=None),
        replans=median(row.replans for row in rows),
        failures=sum(row.failures for row in rows),
        safe_stops=sum(row.safe_stops for row in rows),
        planning_time_99=quantile(cpu_times, 0.99) if cpu_times else None,
        reasons=tuple(dict.fromkeys(row.reason for row in rows if not row.reached)),
    )


def time_ratio(row: MissionResult) -> float:
    """Returns flown over predicted time; infinite without arrival."""
    return row.flown_time / row.predicted_time if row.reached and row.predicted_time else inf


def quantile(values: Sequence[float], share: float) -> float:
    """Returns the smallest value not exceeded by a share of the values."""
    return sorted(values)[max(ceil(share * len(values)), 1) - 1]


def _finite_or_none(value: float) -> float | None:
    return value if isfinite(value) else None
