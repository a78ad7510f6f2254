"""`maneuver faults`: closed-loop flights with faults, with and without protection."""

import json as json_module
import sys
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from experiments.faults.fault_matrix import FaultCase, FaultMatrix, find_fault_matrix
from experiments.faults.fault_report import (
    FaultReport,
    Outcomes,
    count_outcomes,
    fault_csv,
    fault_markdown,
    merge_outcomes,
)
from experiments.mission.fly import mission_seed
from experiments.mission.mission_task import MissionTask
from experiments.mission.policies import FlownPolicy
from experiments.mission.random_missions import random_missions
from experiments.mission.result import MissionResult
from experiments.mission.result_store import fly_tasks
from flight.automaton.library import Library
from flight.mission.campaign import VehiclePopulation
from flight.mission.fault import Fault
from flight.mission.mission import Mission
from maneuver.options.executor_options import THIS_MACHINE, ExecutorArgument, open_executor
from maneuver.options.numbers import Count, Seed
from maneuver.options.population import library_population
from planner.closed_loop.settings import Settings
from runtime.atomic_write import write_atomically
from scenarios.find import find_library
from sim.loop.specification import FlightOptions

NOT_ACCEPTABLE = 1

WAIT = 10.0
"""Seconds that a vehicle must stay safe after it aborted its mission."""


def faults(
    matrix: str = "helicopter",
    *,
    library: str = "gtmax-sim",
    policy: FlownPolicy = "worst-case",
    wind: str | None = None,
    vehicles: VehiclePopulation | None = None,
    airframe: Seed | None = None,
    sensors: str | None = None,
    flights: Count = 50,
    seed: Seed = 1,
    bare: bool = True,
    out: Path | None = None,
    job_executor: ExecutorArgument = THIS_MACHINE,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Flies a fault matrix on random missions and counts the outcomes.

    Each fault is flown on the same missions in the same wind, with and without protection. Protection means
    alarms that abort the mission and start a safe stop, and a position margin for declaring arrival.
    A flight is safe, a detected loss (it left the safe envelope with an alarm in time) or an undetected
    failure (it left the envelope without one, or declared arrival away from the goal). The exit code is 0
    if, with protection, there was no undetected failure and every fault had an effect in every flight. With
    --out, flights are stored as they finish, the same command resumes after a stop, and the folder receives
    the matrix as Markdown and CSV.

    For example:

        maneuver faults --flights 2

        maneuver faults --out fault-matrix

        maneuver faults my-faults.toml --no-bare --wind light --flights 20

    Args:
        matrix: name or path of a fault matrix.
        library: name or path of the library planned with.
        policy: planning policy.
        wind: wind class; the library's by default.
        vehicles: vehicle flown: `nominal`, `one` drawn airframe or a `fleet`; the library's by default.
        airframe: seed of the airframe of --vehicles one; the library's, or --seed, by default.
        sensors: sensor class, rtk or gps; the library's by default.
        flights: number of flights per fault, each of another random mission.
        seed: seed of all random numbers.
        bare: also fly without protection.
        out: folder for flights and tables; none by default.
        job_executor: executor of the flights.
        force: write into a folder that holds other files.
        json: print one JSON document.
    """
    faults_flown, flown_with = find_fault_matrix(matrix), find_library(library)
    missions = random_missions(flown_with, count=flights, seed=seed, gamma=1.0)
    population = library_population(flown_with, vehicles, airframe=airframe, seed=seed, sensors=sensors)
    air = wind or flown_with.conditions.wind
    flying = _MatrixFlights(
        faults_flown, flown_with, policy, air, seed, missions, FlightOptions(**population)
    )
    cases = [case.fault for case in faults_flown.cases]
    orders: list[tuple[Fault | None, bool]] = [(None, True), *((fault, True) for fault in cases)]
    orders += [(fault, False) for fault in cases] if bare else []
    tasks = [task for fault, protected in orders for task in flying.tasks(fault, protected=protected)]
    with open_executor(job_executor) as executor:
        results = fly_tasks(tasks, folder=out, logs=None, job_executor=executor, force=force)
    card = _fault_report(
        faults_flown, [results[place : place + flights] for place in range(0, len(results), flights)]
    )
    if out is not None:
        for name, text in (("md", fault_markdown(card)), ("csv", fault_csv(card))):
            write_atomically(text.encode(), out / f"fault-matrix.{name}", force=True)
    if json:
        print(json_module.dumps(_content(card)))
    else:
        _print_report(card)
    return 0 if card.acceptable else NOT_ACCEPTABLE


@dataclass(frozen=True, slots=True)
class _MatrixFlights:
    """Settings that all flights of a fault matrix share."""

    matrix: FaultMatrix
    library: Library
    policy: FlownPolicy
    wind: str
    seed: int
    missions: Sequence[Mission]
    flight_options: FlightOptions

    def tasks(self, fault: Fault | None, *, protected: bool) -> list[MissionTask]:
        """Returns a flight of every mission, with a fault or without."""
        settings = Settings(wait=WAIT) if protected else Settings(wait=WAIT, arrival_probability=0.0)
        faults = () if fault is None else (fault,)
        flight_options = replace(self.flight_options, faults=faults, supervised=protected)
        return [
            MissionTask(
                mission=mission,
                library=self.library,
                policy=self.policy,
                gamma=0.0 if self.policy == "nominal" else 1.0,
                wind=self.wind,
                seed=mission_seed(self.seed, mission.name, 0),
                settings=settings,
                flight_options=flight_options,
                envelope=self.matrix.envelope,
            )
            for mission in self.missions
        ]


def _fault_report(matrix: FaultMatrix, flown: Sequence[Sequence[MissionResult]]) -> FaultReport:
    sound, *rest = flown
    count = len(matrix.cases)
    nothing = FaultCase(matrix.cases[0].fault, contract=True, expected="")
    return FaultReport(
        command=" ".join(["maneuver", *sys.argv[1:]]),
        matrix=matrix,
        protected=tuple(map(count_outcomes, matrix.cases, rest[:count])),
        bare=tuple(map(count_outcomes, matrix.cases, rest[count:])),
        sound=count_outcomes(nothing, sound),
    )


def _content(card: FaultReport) -> dict[str, object]:
    def plain(found: Outcomes) -> dict[str, object]:
        alarms = {kind.name.lower(): count for kind, count in found.alarms}
        limit = found.undetected_failure_at_most
        return {**asdict(found), "alarms": alarms, "undetected_failure_at_most": limit}

    rows = [
        {
            "fault": case.fault.words,
            "contract": case.contract,
            "expected": case.expected,
            "protected": plain(card.protected[place]),
            "bare": plain(card.bare[place]) if card.bare else None,
        }
        for place, case in enumerate(card.matrix.cases)
    ]
    return {"matrix": card.matrix.name, "sound": plain(card.sound), "faults": rows}


def _print_report(card: FaultReport) -> None:
    """Prints a line for each fault, and the sum."""
    unprotected = "   unprotected: safe  undetected" if card.bare else ""
    print(f"{'fault':<45} passed  safe  detected  undetected{unprotected}")
    parts: list[tuple[str, Outcomes, Outcomes | None]] = [("none", card.sound, None)]
    parts += [
        (case.fault.words, card.protected[place], card.bare[place] if card.bare else None)
        for place, case in enumerate(card.matrix.cases)
    ]
    parts.append(
        ("all faults", merge_outcomes(card.protected), merge_outcomes(card.bare) if card.bare else None)
    )
    for words, found, bare in parts:
        passed = "-" if found.passed is None else str(found.passed)
        without = "" if bare is None else f"{bare.safe:>20}{bare.undetected_failure:>12}"
        failed = f"{found.detected_loss:>10}{found.undetected_failure:>12}"
        print(f"{words:<45}{passed:>7}{found.safe:>6}{failed}{without}")
        if found.acted < found.flights and words != "none":
            print(f"  had an effect in only {found.acted} of {found.flights} flights")
    whole = merge_outcomes(card.protected)
    print(
        f"undetected failures with protection: {whole.undetected_failure} of {whole.flights}; at most "
        f"{whole.undetected_failure_at_most:.3%} (95 % confidence)"
    )
