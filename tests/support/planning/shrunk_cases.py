"""Failing missions made smaller, and written as the files that the command line takes."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import floor, log10
from pathlib import Path

from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.se2 import SE2, Twist

from .odd_missions import OddCase

STILL = Twist(0.0, 0.0, 0.0)
EXACT = ManeuverError(0.0, 0.0, 0.0, 0.0)

Fails = Callable[[OddCase], bool]
"""Predicate: True while a case still shows the fault."""


def shrunk(case: OddCase, fails: Fails, *, rounds: int = 3) -> OddCase:
    """Returns a smaller case that fails, too: less trims, maneuvers and errors, rounder numbers.

    Args:
        case: it fails.
        fails: tells whether another does.
        rounds: passes over all changes, unless one of them changes nothing.
    """
    for _ in range(rounds):
        before = case
        case = _pass(case, fails)
        if case == before:
            break
    return case


def _pass(case: OddCase, fails: Fails) -> OddCase:
    for change in (_fewer_maneuvers, _fewer_trims, _simpler_missions, _simpler_primitives):
        progress = True
        while progress:
            progress = False
            for smaller in change(case):
                if smaller != case and fails(smaller):
                    case, progress = smaller, True
                    break
    return case


def _fewer_maneuvers(case: OddCase) -> Iterator[OddCase]:
    every = case.library.maneuvers
    used = set(zip(case.walk, case.walk[1:], strict=False))
    for place, one in enumerate(every):
        if (one.from_trim, one.to_trim) not in used:
            yield _with(case, maneuvers=every[:place] + every[place + 1 :])


def _fewer_trims(case: OddCase) -> Iterator[OddCase]:
    library, mission = case.library, case.mission
    kept = {*case.walk, mission.start_trim, mission.goal_trim}
    for trim in library.trims:
        if trim.id not in kept:
            yield _with(
                case,
                trims=tuple(one for one in library.trims if one is not trim),
                maneuvers=tuple(
                    one for one in library.maneuvers if trim.id not in (one.from_trim, one.to_trim)
                ),
            )


def _simpler_missions(case: OddCase) -> Iterator[OddCase]:
    mission = case.mission
    for depth in range(1, mission.max_trims):
        yield replace(case, mission=replace(mission, max_trims=depth))
    yield replace(case, mission=replace(mission, goal_trim=None))
    yield replace(case, mission=replace(mission, goal_heading=None, heading_tolerance=3.141592653589793))
    yield replace(case, mission=_from_origin(mission))
    yield replace(case, gamma=0.5)
    for digits in (1, 3, 6):
        yield replace(case, mission=replace(mission, tolerance=_rounded(mission.tolerance, digits)))
        yield replace(
            case,
            mission=replace(
                mission, goal=(_rounded(mission.goal[0], digits), _rounded(mission.goal[1], digits))
            ),
        )
        if mission.goal_heading is not None:
            yield replace(
                case,
                mission=replace(
                    mission,
                    goal_heading=_rounded(mission.goal_heading, digits),
                    heading_tolerance=_rounded(mission.heading_tolerance, digits),
                ),
            )


def _from_origin(mission: Mission) -> Mission:
    seen = mission.start.inverse() @ SE2(*mission.goal, mission.goal_heading or 0.0)
    heading = None if mission.goal_heading is None else seen.heading
    return replace(mission, start=SE2.identity(), goal=seen.position, goal_heading=heading)


def _simpler_primitives(case: OddCase) -> Iterator[OddCase]:
    library = case.library
    yield _with(
        case,
        trims=tuple(replace(one, error=STILL) for one in library.trims),
        maneuvers=tuple(replace(one, error=EXACT) for one in library.maneuvers),
    )
    for place, trim in enumerate(library.trims):
        for simpler in _simpler_trims(trim):
            yield _with(case, trims=(*library.trims[:place], simpler, *library.trims[place + 1 :]))
    for place, one in enumerate(library.maneuvers):
        for other in _simpler_maneuvers(one):
            yield _with(case, maneuvers=(*library.maneuvers[:place], other, *library.maneuvers[place + 1 :]))


def _simpler_trims(trim: Trim) -> Iterator[Trim]:
    held = trim.velocity
    yield replace(trim, error=STILL)
    yield replace(trim, velocity=replace(held, side=0.0))
    for digits in (1, 3):
        yield replace(
            trim,
            velocity=Twist(*(_rounded(one, digits) for one in (held.forward, held.side, held.yaw_rate))),
        )
        error = trim.error
        yield replace(
            trim, error=Twist(*(_rounded(one, digits) for one in (error.forward, error.side, error.yaw_rate)))
        )


def _simpler_maneuvers(one: Maneuver) -> Iterator[Maneuver]:
    moved = one.displacement
    yield replace(one, error=EXACT)
    yield replace(one, duration=1.0, error=replace(one.error, duration=0.0))
    yield replace(one, displacement=SE2(0.0, 0.0, moved.heading))
    yield replace(one, displacement=replace(moved, heading=0.0))
    for digits in (1, 3):
        yield replace(
            one,
            duration=_rounded(one.duration, digits),
            displacement=SE2(*(_rounded(value, digits) for value in (moved.x, moved.y, moved.heading))),
        )


def _rounded(value: float, digits: int) -> float:
    return round(value, digits - 1 - floor(log10(abs(value)))) if value else value


def _with(case: OddCase, **parts: object) -> OddCase:
    return replace(case, library=_changed(case.library, **parts))


def _changed(library: Library, **parts: object) -> Library:
    return replace(library, **parts)  # type: ignore[arg-type]


def mission_text(mission: Mission) -> str:
    """Returns the mission as a file."""
    lines = [f'name = "{mission.name}"', "[start]"]
    lines += [f"position = [{mission.start.x!r}, {mission.start.y!r}]"]
    lines += [f"heading = {mission.start.heading!r}", f"trim = {mission.start_trim}", "[goal]"]
    lines += [f"position = [{mission.goal[0]!r}, {mission.goal[1]!r}]", f"tolerance = {mission.tolerance!r}"]
    if mission.goal_heading is not None:
        lines += [f"heading = {mission.goal_heading!r}", f"heading_tolerance = {mission.heading_tolerance!r}"]
    if mission.goal_trim is not None:
        lines.append(f"trim = {mission.goal_trim}")
    lines += ["[planner]", f"max_trims = {mission.max_trims}"]
    return "\n".join(lines) + "\n"


def write_case(case: OddCase, folder: Path, note: str) -> None:
    """Writes lib.json, mission.toml and a README with the right value."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "lib.json").write_text(library_text(case.library))
    (folder / "mission.toml").write_text(mission_text(case.mission))
    (folder / "README").write_text(note)
