"""Flights that are kept as they come, so that a long validation can be stopped and started again."""

import hashlib
import json
from concurrent.futures import Executor
from dataclasses import asdict, dataclass
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from flight.library_file import library_hash
from flight.log_file import publish_bytes
from flight.version import VERSION
from sim.parameters import model_hash
from sim.specification import Departure

from .files import refuse_existing
from .mission_flights import MissionResult, MissionTask, fly_mission
from .progress import shown

_RESULT = TypeAdapter(MissionResult)

FLIGHTS = "flights"
"""Folder of the flights that are kept."""


@dataclass(frozen=True, slots=True)
class KeptTask:
    """A flight, and the file that keeps what it came to."""

    task: MissionTask
    path: Path

    def result(self) -> MissionResult | None:
        """Returns what is kept; None where the flight is still to be flown, or its log is missing."""
        try:
            found = _RESULT.validate_json(self.path.read_bytes())
        except (OSError, ValidationError):
            return None
        return found if found.log is None or found.log.exists() else None


def kept(task: MissionTask, folder: Path, *, library_sha256: str, model_sha256: str) -> KeptTask:
    """Returns the flight with the file that keeps it: another flight has another file."""
    content = {
        "version": VERSION,
        "model": model_sha256,
        "library": library_sha256,
        "mission": asdict(task.mission),
        "policy": task.policy,
        "gamma": task.gamma,
        "plant": task.plant,
        "wind": task.wind,
        "seed": task.seed,
        "settings": asdict(task.settings),
        "max_nodes": task.max_nodes,
        "departure": TypeAdapter(Departure).dump_python(task.departure, mode="json"),
        "envelope": asdict(task.envelope),
        "log": None if task.log is None else str(task.log),
    }
    name = hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:24]
    return KeptTask(task, folder / f"{name}.json")


def keep_all(tasks: list[MissionTask], folder: Path) -> list[KeptTask]:
    """Returns the flights with the files that keep them."""
    hashes = {id(task.library): library_hash(task.library) for task in tasks}
    model = model_hash()
    return [kept(task, folder, library_sha256=hashes[id(task.library)], model_sha256=model) for task in tasks]


def fly_and_keep(flight: KeptTask) -> MissionResult:
    """Flies a mission once, and keeps what it came to, whole or not at all."""
    result = fly_mission(flight.task)
    publish_bytes(_RESULT.dump_json(result, indent=None), flight.path, force=True)
    return result


def fly_all(
    tasks: list[MissionTask], *, folder: Path | None, logs: Path | None, executor: Executor, force: bool
) -> list[MissionResult]:
    """Flies what is not kept yet, and returns all flights in their order.

    Args:
        tasks: the flights.
        folder: that keeps them; None keeps nothing.
        logs: folder of their logs.
        executor: flies them.
        force: write into folders that hold something else.

    Raises:
        AlreadyExistsError: a folder holds something that is no validation, and `force` is not set.
    """
    if folder is None:
        if logs is not None:
            refuse_existing(logs, force=force)
        return list(shown(executor.map(fly_mission, tasks), total=len(tasks), what="flying missions"))
    if not (folder / FLIGHTS).is_dir():
        refuse_existing(folder, force=force)
    flights = keep_all(tasks, folder / FLIGHTS)
    known = {flight.path: found for flight in flights if (found := flight.result()) is not None}
    missing = [flight for flight in flights if flight.path not in known]
    flown = shown(executor.map(fly_and_keep, missing), total=len(missing), what="flying missions")
    known |= {flight.path: result for flight, result in zip(missing, flown, strict=True)}
    return [known[flight.path] for flight in flights]
