"""`maneuver validate`: repeated closed-loop flights of missions, compared with their plans."""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter
from cyclopts.types import NonNegativeFloat, PositiveFloat

from experiments.mission.error_attribution import ErrorAttribution, attribute_errors
from experiments.mission.policies import COMPARED_POLICIES, FlownPolicy
from experiments.mission.random_missions import random_missions
from experiments.mission.result import MissionResult, flown_walk
from experiments.mission.result_store import FLIGHTS, fly_tasks, stored_tasks
from experiments.mission.stated_time_bound import stated_time_bounds
from experiments.thesis.flown_tables import compare_loops, count_arrivals_by_policy, loops_csv, loops_markdown
from experiments.validation.grid import Grid
from experiments.validation.pictures import write_validation_pictures
from experiments.validation.scorecard import ScorecardCell, scorecard_cells, scorecard_totals
from experiments.validation.scorecard_files import (
    Scorecard,
    scorecard_csv,
    scorecard_json,
    scorecard_markdown,
)
from experiments.validation.time_bound_trial import time_bound_trials
from experiments.validation.tube_trial import tube_trials
from flight.automaton.library import Library
from flight.errors import FlightError
from flight.mission.campaign import VehiclePopulation
from flight.mission.mission import Mission
from maneuver.options.calibration import BOUND_SHARE, check_calibration, write_time_bounds
from maneuver.options.depth import at_depth
from maneuver.options.domain_warnings import warn_of_flight, warn_of_walks
from maneuver.options.executor_options import THIS_MACHINE, ExecutorArgument, open_executor
from maneuver.options.folder_status import print_status
from maneuver.options.latencies import latency_of
from maneuver.options.numbers import Count, Seed
from maneuver.options.population import library_population
from maneuver.report.scorecard_report import print_scorecard
from planner.closed_loop.settings import Settings
from runtime.atomic_write import (
    check_output_files,
    check_output_folder,
    remove_partial_files,
    write_atomically,
)
from runtime.executor import default_workers, worker_pool
from runtime.job_store import inspect_jobs
from scenarios.find import find_library, find_mission, library_path
from sim.loop.specification import SUPERVISED_OPTIONS

# Chapter 7 of the thesis, from the slow forward trim, to 3 ft; the kinematic missions in metres.
THESIS_MISSIONS = ("gtmax-1", "gtmax-2", "kinematic-1-flown", "kinematic-2-flown", "kinematic-3-flown")
RANDOM_MISSIONS = 100
NOT_REACHED = 1

Names = Annotated[tuple[str, ...], Parameter(consume_multiple=True, negative="")]
Levels = Annotated[tuple[float, ...], Parameter(consume_multiple=True, negative="")]


def validate(
    *,
    suite: Literal["thesis", "random", "tables"] = "thesis",
    missions: Names = (),
    policies: Annotated[
        tuple[FlownPolicy, ...], Parameter(consume_multiple=True, negative="")
    ] = COMPARED_POLICIES,
    library: str = "gtmax-sim",
    gamma: Levels = (1.0,),
    plant: Literal["helicopter", "automaton"] = "helicopter",
    true_gamma: Names = (),
    wind: Names = (),
    vehicles: VehiclePopulation | None = None,
    airframe: Seed | None = None,
    sensors: str | None = None,
    flights: Count = 5,
    seed: Seed = 1,
    tolerance: PositiveFloat | None = None,
    replan_interval: PositiveFloat = 0.5,
    tolerance_share: NonNegativeFloat = 0.0,
    aim: PositiveFloat = 0.5,
    hysteresis: NonNegativeFloat = 1.0,
    learn_level: bool = True,
    replan_in_maneuver: Annotated[bool, Parameter(negative="")] = False,
    latency: str = "0.05",
    max_nodes: Count | None = None,
    max_replans: Count = 200,
    max_trims: Count | None = None,
    out: Path | None = None,
    logs: Path | None = None,
    calibrate: Path | None = None,
    job_executor: ExecutorArgument = THIS_MACHINE,
    status: Annotated[bool, Parameter(negative="")] = False,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Flies missions in closed loop and compares them with their plans.

    Every mission is flown with every policy, gamma and wind, with the same seeds. With --out, flights are
    stored as they finish, the same command resumes after a stop, and the folder receives a scorecard
    (Markdown, CSV, JSON) and pictures. The exit code is 0 if every flight of the worst-case policy (or,
    without it, of all policies flown) reached its goal. A flight that ends by time-out, at the limit of
    replans, without a plan or in a safe stop counts as not reached.

    For example:

        maneuver validate --flights 10 --out thesis-missions

        maneuver validate --suite random --missions 100 --flights 10 --out random-missions

        maneuver validate --missions gtmax-1 --policies worst-case --wind gtmax light --logs flights

        maneuver validate --suite random --seed 2001 --flights 1 --calibrate my-library.times.toml

        maneuver validate --plant automaton --gamma 0.3 0.5 1 --true-gamma minus random

    Args:
        suite: missions of the thesis; random missions that have a plan at the first gamma; or Tables 12 to 26
            of the thesis, flown by the automaton, with no other option but --out.
        missions: names or paths of other missions; for --suite random their number, 100 by default.
        policies: planning policies.
        library: name or path of the library planned with.
        gamma: uncertainty levels of the worst-case policy, 0 to 1.
        plant: simulated helicopter, or automaton: the library's model with the library's errors.
        true_gamma: true gamma of the automaton: numbers from -1 to 1, `plus` or `minus` the planned gamma, or
            `random`, drawn for every primitive; 1 by default.
        wind: wind classes; the library's by default.
        vehicles: vehicle flown: `nominal`, `one` drawn airframe or a `fleet`; the library's by default.
        airframe: seed of the airframe of --vehicles one; the library's, or --seed, by default.
        sensors: sensor class, rtk or gps; the library's by default.
        flights: number of flights per mission and policy, each with its own seed.
        seed: seed of all random numbers.
        tolerance: goal tolerance in metres; the mission's by default.
        replan_interval: seconds between two replans.
        tolerance_share: share of the remaining distance that replaces the replan's tolerance if it is larger.
        aim: share of the goal tolerance that replans use, to leave room for errors.
        hysteresis: seconds by which a new plan must be faster than one that still reaches the goal.
        learn_level: fly the coasting times of the estimated gamma, not of the deciding one.
        replan_in_maneuver: replan during every maneuver, from its predicted end.
        latency: planning latency: seconds, `measured` (clock time; more than 0.05 s is too late), or the log
            of a flight whose latencies are repeated.
        max_nodes: limit of each replan: walks solved at one gamma; no limit by default.
        max_replans: number of replans after which a flight is aborted.
        max_trims: number of trims in the longest sequence of a plan, at most 8; each mission's by default.
        out: folder for flights, scorecard and pictures; none by default.
        calibrate: file for the times within which 90 % of these flights finish, used by `maneuver plan`:
            NAME.times.toml beside the library NAME.json; for --suite random. Not written if too few flights
            succeeded.
        logs: folder for the flight logs of the helicopter; none by default.
        job_executor: executor of the flights.
        status: list the stored flights without flying; the exit code is 1 if one is missing.
        force: write into a folder that holds other files.
        json: print one JSON document with every cell and every flight.
    """
    if suite == "tables":
        return _tables(out, job_executor.workers or default_workers(), force=force)
    flown_with = find_library(library)
    try:
        settings = Settings(
            activation_interval=replan_interval,
            max_activations=max_replans,
            final_tolerance=tolerance,
            tolerance_share=tolerance_share,
            aim=aim,
            latency=latency_of(latency),
            replan_in_maneuver=replan_in_maneuver,
            hysteresis=hysteresis,
            learn_level=learn_level,
        )
    except ValueError as error:
        raise FlightError(str(error)) from None
    plain = (settings, max_nodes, max_trims) == (Settings(), None, None)
    check_calibration(calibrate, suite, plant, plain=plain)
    check_output_files(calibrate, force=force, inputs=[library_path(library)])
    if job_executor.cluster is not None and logs is not None and out is None:
        raise FlightError("--logs with --cluster: expected --out with a folder for the flights, got none")
    if plant == "automaton" and (wind or logs):
        raise FlightError(
            "--plant automaton: expected neither --wind nor --logs; it has no wind and writes no logs"
        )
    if plant == "helicopter" and true_gamma:
        raise FlightError("--true-gamma: expected --plant automaton, got helicopter")
    grid = Grid(
        missions=tuple(
            at_depth(mission, max_trims)
            for mission in _missions(suite, missions, flown_with, seed=seed, gamma=gamma[0])
        ),
        policies=policies,
        library=flown_with,
        gammas=gamma,
        true_gammas=(true_gamma or ("1",)) if plant == "automaton" else (),
        winds=wind or (flown_with.conditions.wind,),
        flights=flights,
        seed=seed,
        settings=settings,
        max_nodes=max_nodes,
        logs=logs,
        flight_options=replace(
            SUPERVISED_OPTIONS,
            **library_population(flown_with, vehicles, airframe=airframe, seed=seed, sensors=sensors),
        ),
    )
    if plant == "helicopter":
        for name in grid.winds:
            warn_of_flight(flown_with, wind=name)
    if status:
        return _status(grid, out, as_json=json)
    with open_executor(job_executor) as executor:
        results = fly_tasks(grid.tasks(), folder=out, logs=logs, job_executor=executor, force=force)
    helicopter = [one for one in results if one.plant == "helicopter" and one.legs]
    warn_of_walks(flown_with, [flown_walk(one.legs) for one in helicopter])
    stated = stated_time_bounds(library, flown_with)
    drawn = seed if suite == "random" else -1
    card = Scorecard(
        command=_command(),
        library=flown_with.name,
        totals=scorecard_totals(results),
        cells=scorecard_cells(results),
        time_bounds=time_bound_trials(results, share=BOUND_SHARE, stated=stated, seed=drawn),
        attributions=_attributions(results, flown_with),
        tubes=tube_trials(results, flown_with),
    )
    if out is not None:
        remove_partial_files(out)
        for name, text in (("md", scorecard_markdown(card)), ("csv", scorecard_csv(card))):
            write_atomically(text.encode(), out / f"scorecard.{name}", force=True)
        write_atomically(scorecard_json(card, results).encode(), out / "results.json", force=True)
        write_validation_pictures(
            out, results, grid.missions, flown_with, totals=card.totals, time_bounds=card.time_bounds
        )
    write_time_bounds(calibrate, helicopter, flown_with, seed=seed, command=_command(), force=force)
    if json:
        sys.stdout.write(scorecard_json(card, results))
    else:
        print_scorecard(card)
    return _exit_code(card.cells)


def _tables(folder: Path | None, workers: int, *, force: bool) -> int:
    if folder is None:
        raise FlightError("--suite tables: expected --out with a folder for the tables, got none")
    check_output_folder(folder, force=force)
    with worker_pool(workers) as executor:
        rows = compare_loops(executor)
    write_atomically(loops_markdown(rows).encode(), folder / "tables-12-to-26.md", force=force)
    write_atomically(loops_csv(rows).encode(), folder / "tables-12-to-26.csv", force=force)
    for policy, (printed, theirs, ours) in count_arrivals_by_policy(rows).items():
        print(
            f"{policy}: goal reached in {printed} of 15 printed lines; recomputed with both signs of the "
            f"errors: {theirs} with the thesis's loop, {ours} with this program's loop"
        )
    return 0


def _status(grid: Grid, folder: Path | None, *, as_json: bool) -> int:
    if folder is None:
        raise FlightError("--status: expected --out with the folder of the flights, got none")
    return print_status(
        inspect_jobs(stored_tasks(grid.tasks(), folder / FLIGHTS), folder / FLIGHTS), as_json=as_json
    )


def _exit_code(cells: Sequence[ScorecardCell]) -> int:
    judged = [cell for cell in cells if cell.policy == "worst-case"] or list(cells)
    return 0 if all(cell.reached.count == cell.flights for cell in judged) else NOT_REACHED


def _command() -> str:
    return " ".join(["maneuver", *sys.argv[1:]])


def _missions(
    suite: str, names: Sequence[str], library: Library, *, seed: int, gamma: float
) -> tuple[Mission, ...]:
    if suite == "thesis":
        return tuple(find_mission(name, library) for name in names or THESIS_MISSIONS)
    if len(names) > 1 or not all(name.isdecimal() and int(name) for name in names):
        raise FlightError(f"--suite random: expected one number > 0 for --missions, got {' '.join(names)}")
    count = int(names[0]) if names else RANDOM_MISSIONS
    return random_missions(library, count=count, seed=seed, gamma=gamma)


def _attributions(
    results: Sequence[MissionResult], library: Library
) -> dict[str, tuple[ErrorAttribution, ...]]:
    winds: dict[str, list[MissionResult]] = {}
    for row in results:
        if row.performances:
            winds.setdefault(row.wind, []).append(row)
    return {
        wind: attribute_errors(
            (
                (str(row.log or f"{row.mission}, {row.policy}, seed {row.seed}"), row.performances)
                for row in rows
            ),
            library,
        )
        for wind, rows in winds.items()
    }
