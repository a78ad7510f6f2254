"""`maneuver validate`: missions flown in closed loop, many times, beside what was predicted."""

import json as json_module
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import groupby
from pathlib import Path
from statistics import median
from typing import Annotated, Literal

from cyclopts import Parameter
from cyclopts.types import NonNegativeFloat, PositiveFloat
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from scipy.stats import binomtest

from flight.errors import FlightError
from flight.library import Library
from flight.mission import Mission
from planner.receding_horizon import Settings

from .domain import warn_of_flight
from .files import find_library, find_mission, refuse_existing
from .mission_flights import MissionResult, MissionTask, Plant, fly_mission, mission_seed
from .numbers import Count, Seed
from .policies import FLOWN_POLICIES, FlownPolicy
from .progress import shown
from .workers import default_workers, worker_pool

# Chapter 7 of the thesis, from the slow forward trim, to 3 ft; the kinematic missions in metres.
THESIS_MISSIONS = ("gtmax-1", "gtmax-2", "kinematic-1-flown", "kinematic-2-flown", "kinematic-3-flown")
NOT_REACHED = 1


@dataclass(frozen=True, slots=True)
class Cell:
    """All flights of one mission under one policy.

    Attributes:
        mission: name.
        policy: which planner.
        wind: wind class.
        flights: how many.
        reached: how many reached the goal.
        reached_low: lower end of the 95 % Wilson interval of the share that reaches it.
        reached_high: upper end.
        flown_time: median seconds of the flights that reached it; None without one.
        predicted_time: seconds that the first plan promised; None without one.
        miss: metres by which the worst flight that did not reach the goal missed it; None where all did.
        failures: plannings that gave no plan, all flights together.
        reasons: why flights did not reach the goal, each once.
    """

    mission: str
    policy: FlownPolicy
    wind: str
    flights: int
    reached: int
    reached_low: float
    reached_high: float
    flown_time: float | None
    predicted_time: float | None
    miss: float | None
    failures: int
    reasons: tuple[str, ...]


def validate(
    *,
    missions: Annotated[tuple[str, ...], Parameter(consume_multiple=True, negative="")] = THESIS_MISSIONS,
    policies: Annotated[
        tuple[FlownPolicy, ...], Parameter(consume_multiple=True, negative="")
    ] = FLOWN_POLICIES,
    library: str = "gtmax-sim",
    gamma: float = 1.0,
    plant: Literal["helicopter", "automaton"] = "helicopter",
    true_gamma: float | None = None,
    wind: str | None = None,
    flights: Count = 5,
    seed: Seed = 1,
    tolerance: PositiveFloat | None = None,
    activation_interval: PositiveFloat = 1.0,
    tolerance_share: NonNegativeFloat = 0.1,
    max_activations: Count = 100,
    logs: Path | None = None,
    workers: Count | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Flies missions in closed loop and compares with the plans: reached or not, flown time, predicted time.

    The exit code is 0 when every flight of the worst-case policy (or, without it, of the policies flown)
    reached its goal. A flight that ends by time-out, by the limit of plannings, or without a plan counts as
    not reached.

    For example:

        maneuver validate --flights 10

        maneuver validate --missions gtmax-1 --policies worst-case --wind light --logs flights

        maneuver validate --plant automaton --flights 1 --true-gamma -0.5

    Args:
        missions: names or paths; the thesis's by default.
        policies: which planners.
        library: name or path of the library planned with.
        gamma: uncertainty level of the worst-case planner, 0 to 1.
        plant: what flies: the simulated helicopter, or the library's own model with its own errors.
        true_gamma: level at which the automaton truly moves, -1 to 1; 1 by default.
        wind: wind class; the library's by default.
        flights: of each mission and policy, each with a seed of its own.
        seed: of all chance.
        tolerance: metres within which the goal counts as reached; the mission's by default.
        activation_interval: seconds between two plannings.
        tolerance_share: of the distance to go: the tolerance that re-planning is handed, where larger.
        max_activations: plannings after which a flight is given up.
        logs: folder that keeps the flight logs of the helicopter; none are kept by default.
        workers: processes; one for each processor by default.
        force: write into a folder that has something in it.
        json: print one JSON document with every cell and every flight.
    """
    flown_with = find_library(library)
    try:
        settings = Settings(activation_interval, max_activations, tolerance, tolerance_share)
    except ValueError as error:
        raise FlightError(str(error)) from None
    if plant == "automaton" and (wind or logs):
        raise FlightError(
            "--plant automaton flies in no wind and writes no logs: give neither --wind nor --logs"
        )
    if plant == "helicopter" and true_gamma is not None:
        raise FlightError("--true-gamma moves the automaton: give --plant automaton with it")
    if logs is not None:
        refuse_existing(logs, force=force)
    if plant == "helicopter":
        warn_of_flight(flown_with, wind=wind or flown_with.conditions.wind)
    tasks = list(
        _tasks(
            [find_mission(name) for name in missions],
            policies,
            flown_with,
            gamma=gamma,
            plant=_plant(plant, 1.0 if true_gamma is None else true_gamma, flights),
            wind="none" if plant == "automaton" else wind or flown_with.conditions.wind,
            flights=flights,
            seed=seed,
            settings=settings,
            logs=logs,
        )
    )
    with worker_pool(workers or default_workers()) as executor:
        results = list(shown(executor.map(fly_mission, tasks), total=len(tasks), what="flying missions"))
    cells = scorecard(results)
    if json:
        document = {"cells": [asdict(cell) for cell in cells], "flights": [_result(row) for row in results]}
        print(json_module.dumps(document))
    else:
        _print(cells)
    judged = [cell for cell in cells if cell.policy == "worst-case"] or list(cells)
    return 0 if all(cell.reached == cell.flights for cell in judged) else NOT_REACHED


def scorecard(results: Iterable[MissionResult]) -> tuple[Cell, ...]:
    """Returns a cell for each mission and policy, in the order flown."""
    return tuple(
        _cell(tuple(rows)) for _, rows in groupby(results, key=lambda result: (result.mission, result.policy))
    )


def _plant(kind: Literal["helicopter", "automaton"], true_gamma: float, flights: int) -> Plant:
    if kind == "helicopter":
        return "helicopter"
    if flights != 1:
        raise FlightError(f"--plant automaton knows no chance: expected --flights 1, got {flights}")
    return true_gamma


def _tasks(
    missions: Sequence[Mission],
    policies: Sequence[FlownPolicy],
    library: Library,
    *,
    gamma: float,
    plant: Plant,
    wind: str,
    flights: int,
    seed: int,
    settings: Settings,
    logs: Path | None,
) -> Iterator[MissionTask]:
    """Yields every flight; under every policy a mission meets the same air."""
    for mission in missions:
        for policy in policies:
            for number in range(flights):
                name = f"{mission.name}-{policy}-{number:04d}.mcap"
                yield MissionTask(
                    mission=mission,
                    library=library,
                    policy=policy,
                    gamma=gamma,
                    plant=plant,
                    wind=wind,
                    seed=mission_seed(seed, mission.name, number),
                    settings=settings,
                    log=None if logs is None else logs / name,
                    force=True,
                )


def _cell(rows: tuple[MissionResult, ...]) -> Cell:
    first = rows[0]
    reached = [row for row in rows if row.reached]
    interval = binomtest(len(reached), len(rows)).proportion_ci(0.95, method="wilson")
    predictions = [row.predicted_time for row in rows if row.predicted_time is not None]
    return Cell(
        mission=first.mission,
        policy=first.policy,
        wind=first.wind,
        flights=len(rows),
        reached=len(reached),
        reached_low=float(interval.low),
        reached_high=float(interval.high),
        flown_time=median(row.flown_time for row in reached) if reached else None,
        predicted_time=median(predictions) if predictions else None,
        miss=max((row.closest for row in rows if not row.reached and row.closest is not None), default=None),
        failures=sum(row.failures for row in rows),
        reasons=tuple(dict.fromkeys(row.reason for row in rows if not row.reached)),
    )


def _print(cells: Sequence[Cell]) -> None:
    missed, failed = any(cell.miss is not None for cell in cells), any(cell.failures for cell in cells)
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
    for name in ("mission", "policy"):
        table.add_column(name, no_wrap=True)
    for name in _heads(missed=missed, failed=failed):
        table.add_column(name, justify="right", no_wrap=True)
    for cell in cells:
        row = [
            f"{cell.reached}/{cell.flights}",
            f"{cell.reached_low:.2f}-{cell.reached_high:.2f}",
            _number(cell.flown_time),
            _number(cell.predicted_time),
        ]
        row += [_number(cell.miss)] if missed else []
        row += [str(cell.failures)] if failed else []
        table.add_row(cell.mission, cell.policy, *row)
    console = Console(highlight=False)
    console.print(f"wind class {cells[0].wind}; medians of flown and planned time", soft_wrap=True)
    console.print(table)
    for cell in cells:
        for reason in cell.reasons:
            console.print(f"{cell.mission}, {cell.policy}: not reached: {reason}", soft_wrap=True)


def _heads(*, missed: bool, failed: bool) -> list[str]:
    heads = ["reached", "95 %", "flown, s", "plan, s"]
    heads += ["miss, m"] if missed else []
    heads += ["no plan"] if failed else []
    return heads


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _result(row: MissionResult) -> dict[str, object]:
    return {**asdict(row), "log": None if row.log is None else str(row.log)}
