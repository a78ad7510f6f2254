"""Plan file with the library and mission that it was made with."""

import json
from dataclasses import replace
from pathlib import Path

from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from flight.errors import BadFileError
from flight.mission.mission import Mission
from flight.plan.plan import Plan, read_plan
from flight.schema import read_text
from planner.check.plan_check import identity_problems
from scenarios.find import NoSuchFileError, find_library, find_mission

from .prices import SCHEMA as PRICES


def library_and_mission(
    file: Path, plan: Plan, *, library: str | None, mission: str | None, max_trims: int | None = None
) -> tuple[Library, Mission]:
    """Returns library and mission of a plan.

    Args:
        file: the plan's.
        plan: content of the file.
        library: name or path; None for the name in the plan.
        mission: name or path; None for the mission in the plan, or else its name there.
        max_trims: longest sequence searched; None for that of the mission in the plan, or else the mission's,
            or the plan's if longer.

    Raises:
        FlightError: there is no such library or mission, or it is broken.
    """
    try:
        primitives = find_library(library or plan.library)
    except NoSuchFileError as error:
        raise error if library else _made_from(file, "library", "LIBRARY.json", error) from None
    if mission is None and plan.stated_mission is not None:
        task = plan.stated_mission
        return primitives, replace(task, max_trims=max_trims or task.max_trims)
    try:
        task = find_mission(mission or plan.mission)
    except NoSuchFileError as error:
        raise error if mission else _made_from(file, "mission", "MISSION.toml", error) from None
    wider = plan.at_smallest_tolerance or plan
    longest = max(task.max_trims, len(plan.sequence), len(wider.sequence))
    return primitives, replace(task, max_trims=max_trims or longest)


def check_plan_origin(file: Path, plan: Plan, library: Library, mission: Mission) -> None:
    """Checks that a plan belongs to a library and a mission.

    Raises:
        BadFileError: it does not.
    """
    for problem in identity_problems(plan, library_hash(library), library.name, mission):
        raise BadFileError(file, problem)


def holds_no_plan(path: Path | None) -> bool:
    """Returns True if a file holds a result without a plan."""
    if path is None or not path.is_file():
        return False
    try:
        return read_plan(path).empty
    except BadFileError:
        pass
    try:
        prices = json.loads(read_text(path))
    except (BadFileError, ValueError, RecursionError):
        return False
    return isinstance(prices, dict) and (prices.get("schema"), prices.get("points")) == (PRICES, [])


def _made_from(file: Path, kind: str, example: str, error: NoSuchFileError) -> BadFileError:
    return BadFileError(file, f"{error}; for a {kind} in a file give --{kind} {example}")
