"""Fixed and adaptive gammas compared: `python -m benchmarks.flight.adaptive_gamma_flights 40 9`.

The helicopter flies random missions in wind that changes on the way, every one at gamma 0, 0.5, 1 and at the
adaptive one, in the same air. Prints as Markdown: goals reached, times, the time difference of the adaptive
level from each other one, mission by mission, with the 95 % bootstrap interval, and the flights with a
warning of wind outside the library's domain.
"""

import sys
from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from statistics import mean, median

import numpy as np

from experiments.mission.fly import fly_mission, mission_seed
from experiments.mission.mission_task import MissionTask
from experiments.mission.policies import FlownPolicy
from experiments.mission.random_missions import random_missions
from experiments.mission.result import MissionResult
from experiments.validation.scorecard import Proportion, time_ratio
from flight.mission.wind_change import WindChange
from flightlog.alarm import AlarmKind
from runtime.executor import default_workers, worker_pool
from scenarios.find import find_library
from sim.loop.specification import FlightOptions

LIBRARY = find_library("gtmax-sim")
FLOWN: tuple[tuple[str, FlownPolicy, float], ...] = (
    ("gamma 0", "nominal", 0.0),
    ("gamma 0.5", "worst-case", 0.5),
    ("gamma 1", "worst-case", 1.0),
    ("adaptive gamma", "adaptive-gamma", 1.0),
)
RESAMPLED = 4000


@dataclass(frozen=True, slots=True)
class WeatherCase:
    """A wind that changes: its first class and its changes."""

    first: str
    changes: tuple[tuple[float, str], ...]

    @property
    def words(self) -> str:
        """Returns the results in words."""
        return ", ".join([self.first, *(f"{wind} from {time:g} s" for time, wind in self.changes)])


WEATHERS = (
    WeatherCase("calm", ((10.0, "gtmax"),)),
    WeatherCase("gtmax", ((10.0, "calm"),)),
    WeatherCase("gtmax", ((8.0, "light"), (16.0, "9"))),
)


def fly_all(executor: Executor, weather: WeatherCase, count: int, seed: int) -> list[list[MissionResult]]:
    """Returns the flights of every level, mission by mission."""
    missions = random_missions(LIBRARY, count=count, seed=seed, gamma=1.0)
    changes = tuple(WindChange(time=time, wind=wind) for time, wind in weather.changes)
    tasks = [
        MissionTask(
            mission,
            LIBRARY,
            policy,
            gamma,
            weather.first,
            mission_seed(seed, mission.name, 0),
            flight_options=FlightOptions(supervised=True, wind_changes=changes),
        )
        for _, policy, gamma in FLOWN
        for mission in missions
    ]
    rows = list(executor.map(fly_mission, tasks))
    return [rows[place : place + count] for place in range(0, len(rows), count)]


def difference(rows: Sequence[MissionResult], others: Sequence[MissionResult]) -> str:
    """Returns the mean time difference over common arrivals, with its interval."""
    pairs = zip(rows, others, strict=True)
    seconds = np.array([one.flown_time - two.flown_time for one, two in pairs if one.reached and two.reached])
    rng = np.random.default_rng(1)
    means = rng.choice(seconds, (RESAMPLED, len(seconds))).mean(axis=1)
    low, high = np.quantile(means, (0.025, 0.975))
    return f"{seconds.mean():+.1f} ({low:+.1f} to {high:+.1f})"


def table(weather: WeatherCase, flown: Sequence[Sequence[MissionResult]]) -> str:
    """Returns the results of one weather as a table."""
    lines = [
        f"## {weather.words}",
        "",
        "| level | reached | 95 % | inside the plan's time | median flown, s | mean, s "
        "| adaptive less this, s | outside its wind, detected |",
        "| --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    for (name, _, _), rows in zip(FLOWN, flown, strict=True):
        reached = Proportion.counted(rows, lambda row: row.reached)
        inside = Proportion.counted(rows, lambda row: time_ratio(row) <= 1)
        times = [row.flown_time for row in rows if row.reached]
        beyond = sum(any(alarm.kind is AlarmKind.TURBULENCE for alarm in row.alarms) for row in rows)
        less = "" if rows is flown[-1] else difference(flown[-1], rows)
        lines.append(
            f"| {name} | {reached.count}/{reached.of} | {reached.low:.3f}-{reached.high:.3f} "
            f"| {inside.count}/{inside.of} ({inside.low:.2f}-{inside.high:.2f}) | {median(times):.1f} "
            f"| {mean(times):.1f} | {less} | {beyond}/{len(rows)} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Prints a table for each weather."""
    count, seed = (int(word) for word in sys.argv[1:3])
    print("# Adaptive gamma\n")
    print(f"    python -m benchmarks.flight.adaptive_gamma_flights {count} {seed}\n")
    with worker_pool(default_workers()) as executor:
        for weather in WEATHERS:
            print(table(weather, fly_all(executor, weather, count, seed)) + "\n", flush=True)


if __name__ == "__main__":
    main()
