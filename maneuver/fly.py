"""`maneuver fly`: flights of sequences, missions and campaigns by the simulated helicopter."""

import json as json_module
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from experiments.mission.fly import fly_mission, plan_as_stated
from experiments.mission.mission_task import MissionTask
from experiments.mission.no_plan import with_full_reason
from experiments.mission.policies import FlownPolicy
from experiments.mission.result import flown_walk
from flight.errors import FlightError
from flight.mission.campaign import VehiclePopulation
from flight.mission.fault import parse_fault
from flight.mission.wind_change import parse_wind_change
from flightlog.file.reader import read_log
from flightlog.file.writer import write_log
from maneuver.options.depth import at_depth
from maneuver.options.domain_warnings import warn_of_flight, warn_of_walk, warn_of_walks
from maneuver.options.executor_options import THIS_MACHINE, ExecutorArgument
from maneuver.options.films import check_film_target, make_film
from maneuver.options.folder_status import print_status
from maneuver.options.latencies import latency_of
from maneuver.options.numbers import Count, Seed
from maneuver.options.population import library_population
from planner.closed_loop.latency import Latency
from planner.closed_loop.settings import Settings
from runtime.atomic_write import check_output_files
from runtime.job_store import inspect_jobs
from scenarios.find import (
    find_library,
    find_mission,
    find_sequence,
    library_path,
    mission_path,
    sequence_path,
)
from sim.campaign_flight import fly_specification
from sim.loop.specification import FlightOptions, specify_sequence

from .fly_campaign import fly_ordered_campaign, order_campaign

LOST = 1

# Labels where the key is not clear by itself.
LABELS = {
    "flown_time": "flown",
    "planned_time": "planned",
    "closest": "least distance to goal",
    "failures": "failed replans",
    "safe_stops": "safe stops",
    "flight_hours": "flight hours",
    "timeouts": "time-outs",
}
# Keys for scorecards and pictures only.
NOT_PRINTED = {
    *("gamma", "plant", "predicted_time", "planning_times", "performances", "legs"),
    *("claimed", "alarms", "left", "effects", "left_tube"),
}
UNITS = {"flown_time": " s", "planned_time": " s", "closest": " m", "duration": " s"}


def fly(
    *,
    sequence: str | None = None,
    mission: str | None = None,
    campaign: str | None = None,
    library: str = "gtmax-sim",
    policy: FlownPolicy | None = None,
    gamma: float | None = None,
    latency: str | None = None,
    max_trims: Count | None = None,
    wind: str | None = None,
    vehicles: VehiclePopulation | None = None,
    airframe: Seed | None = None,
    sensors: str | None = None,
    ideal_sensors: Annotated[bool, Parameter(negative="")] = False,
    adaptation: bool = True,
    fault: tuple[str, ...] = (),
    wind_change: tuple[str, ...] = (),
    supervision: bool = True,
    seed: Seed = 1,
    flights: Count | None = None,
    nominal_flights: Annotated[int | None, Parameter(validator=Number(gte=0, lte=1_000_000))] = None,
    out: Path | None = None,
    job_executor: ExecutorArgument = THIS_MACHINE,
    status: Annotated[bool, Parameter(negative="")] = False,
    video: Path | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Flies a sequence, a mission or a campaign and writes flight logs.

    A sequence is flown as given. A mission is planned, and replanned in flight. A campaign flies every
    maneuver of its automaton once per flight; the same command resumes after a stop. The exit code is 1 if
    a flight was lost or the goal was not reached.

    For example:

        maneuver fly --sequence figure-eight --out eight.mcap

        maneuver fly --mission gtmax-1 --policy worst-case --seed 3 --out flight.mcap

        maneuver fly --campaign gtmax --flights 30 --out flights

        maneuver fly --campaign gtmax --flights 30 --out flights --status

        maneuver fly --campaign gtmax --out flights --cluster tcp://head:8786

        maneuver fly --mission gtmax-2 --video chase.mp4

        maneuver fly --sequence slow-walk --fault "gps dropout 10 2" --fault "pedal slow 20 5 0.1"

        maneuver fly --mission gtmax-2 --policy adaptive-gamma --wind-change "5 light"

        maneuver fly --sequence slow-walk --wind calm --ideal-sensors --no-adaptation

    Args:
        sequence: name or path of a sequence.
        mission: name or path of a mission.
        campaign: name or path of a campaign.
        library: name or path of the library that a sequence or mission is flown with.
        policy: planning policy of a mission; worst-case by default.
        gamma: uncertainty level of a mission's worst-case policy, 0 to 1; 1 by default.
        latency: planning latency of a mission: seconds, `measured` (clock time; more than 0.05 s is too
            late), or the log of a flight whose latencies are repeated; 0.05 by default.
        max_trims: number of trims in the longest sequence of a mission's plan, at most 8; the mission's by
            default.
        wind: wind class; that of the sequence, the mission's library or the campaign by default.
        vehicles: vehicle flown, while the nominal one is assumed: `nominal`, `one` drawn airframe for all
            flights, or a `fleet`, an airframe drawn for each flight; the library's or campaign's by default.
        airframe: seed of the airframe of --vehicles one; --seed by default.
        sensors: sensor class, rtk or gps; the library's or campaign's by default.
        ideal_sensors: fly with ideal navigation: the estimate equals the truth.
        adaptation: use the controller's adaptive element.
        fault: component, kind, start and duration in s (inf: to the end), then its sizes; may be repeated.
            All kinds are listed in docs/helicopter.md and in the error message for an unknown one.
        wind_change: time in s and the new wind class, such as `20 light`; may be repeated.
        supervision: monitor a mission's flight and abort it at the first alarm.
        seed: seed of all random numbers.
        flights: number of campaign flights for the bounds; the campaign's by default.
        nominal_flights: number of campaign flights for the maneuvers' values; the campaign's by default,
            none if only --flights is given.
        out: log of a sequence or mission (NAME.mcap by default), folder of a campaign (NAME by default).
        job_executor: executor of a campaign's flights.
        status: list the stored flights of the campaign without flying; the exit code is 1 if one is missing.
        video: film of a sequence or mission from a chase camera, FILE.mp4.
        force: overwrite OUT and VIDEO; for a campaign, replace logs of other flights.
        json: print the result as JSON.
    """
    flight_options = FlightOptions(
        ideal_navigation=ideal_sensors,
        adaptive=adaptation,
        faults=tuple(map(parse_fault, fault)),
        supervised=supervision and mission is not None,
        wind_changes=tuple(map(parse_wind_change, wind_change)),
    )
    if campaign is None:
        population = library_population(
            find_library(library), vehicles, airframe=airframe, seed=seed, sensors=sensors
        )
        flight_options = replace(flight_options, **population)
    order = _SharedOptions(library, wind, flight_options, seed, out, video, force)
    if video is not None:
        _check_video(video, campaign, force=force)
    if mission is None:
        _check_options("--mission", policy=policy, gamma=gamma, latency=latency, max_trims=max_trims)
    if campaign is None:
        given = {name: value for name, value in asdict(job_executor).items() if value}
        given |= {"status": status or None}
        _check_options("--campaign", flights=flights, nominal_flights=nominal_flights, **given)
    match sequence, mission, campaign:
        case str(), None, None:
            code, result = _fly_sequence(sequence, order)
        case None, str(), None:
            code, result = _fly_mission(
                mission,
                order,
                policy or "worst-case",
                1.0 if gamma is None else gamma,
                Latency() if latency is None else latency_of(latency),
                max_trims=max_trims,
            )
        case None, None, str():
            wanted = order_campaign(
                campaign,
                counts=(flights, nominal_flights),
                wind=wind,
                seed=seed,
                flight_options=flight_options,
                vehicles=vehicles,
                airframe=airframe,
                sensors=sensors,
            )
            folder = out or Path(wanted.campaign.name)
            if status:
                return print_status(inspect_jobs(wanted.jobs(folder), folder), as_json=json)
            code, result = fly_ordered_campaign(wanted, folder, job_executor=job_executor, force=force)
        case _:
            count = sum(kind is not None for kind in (sequence, mission, campaign))
            raise FlightError(f"expected one of --sequence, --mission and --campaign, got {count} of them")
    if video is not None:
        make_film(read_log(Path(str(result["log"]))), video, force=force)
        result["video"] = str(video)
    print(json_module.dumps(result) if json else _lines(result))
    return code


def _lines(result: Mapping[str, object]) -> str:
    return "\n".join(
        f"{LABELS.get(key, key):<18} {_text(value)}{UNITS.get(key, '') if value is not None else ''}"
        for key, value in result.items()
    )


def _check_video(path: Path, campaign: str | None, *, force: bool) -> None:
    if campaign is not None:
        raise FlightError("--video: expected --sequence or --mission, got --campaign")
    check_film_target(path, force=force)


def _check_options(owner: str, **options: object) -> None:
    """Refuses options without the option that they need."""
    given = [f"--{name.replace('_', '-')}" for name, value in options.items() if value is not None]
    if given:
        raise FlightError(f"{', '.join(given)}: only valid with {owner}")


def _text(value: object) -> str:
    match value:
        case None:
            return "-"
        case float():
            return f"{value:.2f}"
        case bool():
            return "yes" if value else "no"
        case list():
            return ", ".join(map(str, value)) or "none"
        case _:
            return str(value)


@dataclass(frozen=True, slots=True)
class _SharedOptions:
    """Options of every kind of flight."""

    library: str
    wind: str | None
    flight_options: FlightOptions
    seed: int
    out: Path | None
    video: Path | None
    force: bool

    def check_targets(self, path: Path, asked: Path) -> None:
        """Checks that log and film can be written, before flying."""
        check_output_files(path, self.video, force=self.force, inputs=[asked, library_path(self.library)])


def _fly_sequence(name: str, order: _SharedOptions) -> tuple[int, dict[str, object]]:
    walk = find_sequence(name)
    walk = replace(walk, wind=order.wind or walk.wind)
    library = find_library(order.library)
    library.maneuvers_along(walk.trims)
    path = order.out or Path(f"{walk.name}.mcap")
    order.check_targets(path, sequence_path(name))
    specification = specify_sequence(walk, seed=order.seed).with_options(order.flight_options)
    warn_of_flight(library, wind=walk.wind, altitude=specification.altitude)
    warn_of_walk(library, walk.trims, walk.coasting_times)
    log = fly_specification(specification, library)
    write_log(log, path, force=order.force)
    outcome = log.header.outcome
    result = {"sequence": walk.name, "outcome": outcome, "duration": round(log.duration, 2), "log": str(path)}
    return (0 if outcome == "completed" else LOST), result


def _fly_mission(
    name: str,
    order: _SharedOptions,
    policy: FlownPolicy,
    gamma: float,
    latency: Latency,
    *,
    max_trims: int | None,
) -> tuple[int, dict[str, object]]:
    library = find_library(order.library)
    mission = at_depth(find_mission(name, library), max_trims)
    path = order.out or Path(f"{mission.name}.mcap")
    order.check_targets(path, mission_path(name))
    task = MissionTask(
        mission=mission,
        library=library,
        policy=policy,
        gamma=gamma,
        wind=order.wind or library.conditions.wind,
        seed=order.seed,
        settings=Settings(latency=latency),
        flight_options=order.flight_options,
        log=path,
        force=order.force,
    )
    warn_of_flight(library, wind=task.wind)
    done = fly_mission(task)
    if done.planned_time is None:
        stated = with_full_reason(plan_as_stated(task), library, task.stated_mission)
        print(f"{mission.name}: {stated.status}: {stated.reason}", file=sys.stderr)
    if done.legs:
        warn_of_walks(library, [flown_walk(done.legs)])
    flown = asdict(done)
    result = {key: value for key, value in flown.items() if key not in NOT_PRINTED}
    return (0 if flown["reached"] else LOST), {**result, "log": str(path)}
