"""Missions that are kept as they are flown, so that a long validation can be stopped and started again."""

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from flight.automaton.library_file import library_hash
from flight.errors import BadFileError
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes
from flightlog.identity import difference, identity
from planner.kernel.build import SEARCH_BACKEND
from runtime.atomic_write import refuse_folder, remove_partials
from runtime.code_version import code_version, judging_version
from runtime.executor import Means
from runtime.job import Done, Found, State, refuse_other_code
from runtime.job_store import accept_others, complete, refuse_to_replace
from runtime.progress import shown
from sim.loop.specification import Departure
from sim.vehicle.parameters import model_hash

from .fly import fly_and_log, fly_mission
from .mission_log import mission_identity
from .result import MissionResult
from .task import MissionTask

FLIGHTS = "flights"
"""Folder of the flights that are kept."""

_RESULT = TypeAdapter(MissionResult)


class _Kept(BaseModel):
    """What a flight came to, and the SHA-256 of that, by which a damaged file is known."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    sha256: str
    result: MissionResult


@dataclass(frozen=True, slots=True)
class KeptTask:
    """A flight, and the file that keeps what it came to (a `runtime.job.Work`).

    Attributes:
        task: what is flown.
        path: of the file; its name is a digest of all that is flown, so another flight has another file.
        code: version that flies it.
    """

    task: MissionTask
    path: Path
    code: str

    def found(self) -> Found[MissionResult]:
        """Returns what is kept, if it is whole and its log, where one was wanted, is there and its own."""
        log = self._log()
        if log.state is State.ANOTHER or not self.path.exists():
            return Found(log.state if log.state is State.ANOTHER else State.MISSING, why=log.why)
        try:
            kept = _Kept.model_validate_json(self.path.read_bytes())
        except (OSError, ValidationError):
            return Found(State.DAMAGED, why=f"{self.path} is damaged: it is no result of a flight")
        if _digest(kept.result) != kept.sha256:
            return Found(State.DAMAGED, why=f"{self.path} is damaged: it does not match its checksum")
        return Found(log.state, kept.result if log.state is State.WHOLE else None, log.why)

    def done(self) -> Done[MissionResult]:
        """Flies.

        Raises:
            OtherCodeError: this process has other code than the one that asked.
        """
        refuse_other_code(self.code, code_here())
        result, log = fly_and_log(self.task)
        kept = _Kept(sha256=_digest(result), result=result).model_dump_json().encode()
        path = self.task.log
        logs = () if path is None or log is None else ((path, log_bytes(log)),)
        return Done((*logs, (self.path, kept)), result)

    def _log(self) -> Found[None]:
        """Returns whether the flight's log is there; where none is wanted, all is."""
        path = self.task.log
        if path is None:
            return Found(State.WHOLE)
        if not path.exists():
            return Found(State.MISSING)
        try:
            log = read_log(path, topics=())
        except BadFileError as error:
            return Found(State.DAMAGED, why=str(error))
        wrong = difference(mission_identity(self.task), identity(log.header, log.attachments))
        if wrong is not None:
            return Found(State.ANOTHER, why=f"{path} is of another flight: {wrong}")
        return Found(State.WHOLE)


def _digest(result: MissionResult) -> str:
    return hashlib.sha256(_RESULT.dump_json(result)).hexdigest()


def code_here() -> str:
    """Returns the versions of the code that flies missions here and that judges them, and how it plans."""
    return f"{code_version()}, judged by {judging_version()}, plans {SEARCH_BACKEND}"


def kept(task: MissionTask, folder: Path, *, library_sha256: str, model_sha256: str) -> KeptTask:
    """Returns the flight with the file that keeps it: another flight has another file."""
    code = code_here()
    content = {
        "code": code,
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
    words = json.dumps(content, sort_keys=True, default=str)
    name = hashlib.sha256(words.encode()).hexdigest()[:24]
    return KeptTask(task, folder / f"{name}.json", code)


def keep_all(tasks: list[MissionTask], folder: Path) -> list[KeptTask]:
    """Returns the flights with the files that keep them."""
    hashes = {id(task.library): library_hash(task.library) for task in tasks}
    model = model_hash()
    return [kept(task, folder, library_sha256=hashes[id(task.library)], model_sha256=model) for task in tasks]


def fly_all(
    tasks: list[MissionTask], *, folder: Path | None, logs: Path | None, means: Means, force: bool
) -> list[MissionResult]:
    """Flies what is not kept yet, and returns all flights in their order.

    Args:
        tasks: the flights.
        folder: that keeps them; None keeps nothing.
        logs: folder of their logs.
        means: what flies.
        force: write into folders that hold something else.

    Raises:
        AlreadyExistsError: a folder holds something that is no validation, and `force` is not set.
        FlightError: a log that would be overwritten is of another flight, and `force` is not set.
    """
    if folder is None:
        if logs is not None:
            refuse_folder(logs, force=force)
        flown = means.executor.map(fly_mission, tasks)
        return list(shown(flown, total=len(tasks), what="flying missions"))
    if not (folder / FLIGHTS).is_dir():
        refuse_folder(folder, force=force)
    for path in (task.log for task in tasks if task.log is not None):
        remove_partials(path.parent, of=path.name)
    flights = keep_all(tasks, folder / FLIGHTS)
    check = accept_others if force else refuse_to_replace
    return complete(flights, folder / FLIGHTS, means=means, what="flying missions", check=check)
