"""Store of mission results, so that a validation can be resumed."""

import hashlib
import json
from dataclasses import asdict, dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from flight.automaton.library_file import library_hash
from flight.errors import BadFileError
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes
from flightlog.identity.flight_identity import flight_identity, identity_difference
from planner.kernel.build import SEARCH_BACKEND
from runtime.atomic_write import check_output_folder, remove_partial_files
from runtime.code_version import code_version, evaluation_version
from runtime.executor import JobExecutor
from runtime.job import JobResult, JobState, JobStatus, check_code_version
from runtime.job_store import allow_other_files, check_no_replacement, complete
from runtime.progress import show_progress
from sim.loop.specification import FlightOptions
from sim.vehicle.parameters import model_hash

from .fly import fly_and_log, fly_mission
from .mission_log import mission_identity
from .mission_task import MissionTask
from .result import MissionResult

FLIGHTS = "flights"
"""Folder of the stored results."""

_RESULT = TypeAdapter(MissionResult)


class _StoredResult(BaseModel):
    """A result and its SHA-256."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    sha256: str
    result: MissionResult


@dataclass(frozen=True, slots=True)
class StoredTask:
    """A flight and the file of its result (a `runtime.job.Job`).

    Attributes:
        task: the flight.
        path: the result's file; its name is a digest of all inputs, so other flights have other files.
        code: code version of the flight.
    """

    task: MissionTask
    path: Path
    code: str

    def status(self) -> JobStatus[MissionResult]:
        """Returns the state of the result and of its log, if requested."""
        log = self._log()
        if log.state is JobState.ANOTHER or not self.path.exists():
            return JobStatus(
                log.state if log.state is JobState.ANOTHER else JobState.MISSING, reason=log.reason
            )
        try:
            stored = _StoredResult.model_validate_json(self.path.read_bytes())
        except (OSError, ValidationError):
            return JobStatus(JobState.DAMAGED, reason=f"{self.path} is damaged: expected a flight's result")
        if _digest(stored.result) != stored.sha256:
            return JobStatus(
                JobState.DAMAGED, reason=f"{self.path} is damaged: it does not match its checksum"
            )
        return JobStatus(log.state, stored.result if log.state is JobState.WHOLE else None, log.reason)

    def run(self) -> JobResult[MissionResult]:
        """Flies the mission; returns the files to write.

        Raises:
            OtherCodeError: this process has another code version than the requesting one.
        """
        check_code_version(self.code, code_identity())
        result, log = fly_and_log(self.task)
        stored = _StoredResult(sha256=_digest(result), result=result).model_dump_json().encode()
        path = self.task.log
        logs = () if path is None or log is None else ((path, log_bytes(log)),)
        return JobResult((*logs, (self.path, stored)), result)

    def _log(self) -> JobStatus[None]:
        """Returns the state of the log; whole where none is requested."""
        path = self.task.log
        if path is None:
            return JobStatus(JobState.WHOLE)
        if not path.exists():
            return JobStatus(JobState.MISSING)
        try:
            log = read_log(path, topics=())
        except BadFileError as error:
            return JobStatus(JobState.DAMAGED, reason=str(error))
        wrong = identity_difference(mission_identity(self.task), flight_identity(log.header, log.attachments))
        if wrong is not None:
            return JobStatus(JobState.ANOTHER, reason=f"{path} is of another flight: {wrong}")
        return JobStatus(JobState.WHOLE)


def _digest(result: MissionResult) -> str:
    return hashlib.sha256(_RESULT.dump_json(result)).hexdigest()


def code_identity() -> str:
    """Returns the digests of the code that flies and evaluates missions."""
    return f"{code_version()}, judged by {evaluation_version()}, plans {SEARCH_BACKEND}"


def stored_task(task: MissionTask, folder: Path) -> StoredTask:
    """Returns the flight with the path of its result."""
    code = code_identity()
    content = {
        "code": code,
        "model": model_hash(),
        "library": library_hash(task.library),
        "mission": asdict(task.mission),
        "policy": task.policy,
        "gamma": task.gamma,
        "plant": task.plant,
        "wind": task.wind,
        "seed": task.seed,
        "settings": asdict(task.settings),
        "max_nodes": task.max_nodes,
        "departure": TypeAdapter(FlightOptions).dump_python(task.flight_options, mode="json"),
        "envelope": asdict(task.envelope),
        "log": None if task.log is None else str(task.log),
    }
    words = json.dumps(content, sort_keys=True, default=str)
    name = hashlib.sha256(words.encode()).hexdigest()[:24]
    return StoredTask(task, folder / f"{name}.json", code)


def stored_tasks(tasks: list[MissionTask], folder: Path) -> list[StoredTask]:
    """Returns the flights with the files that keep them."""
    return [stored_task(task, folder) for task in tasks]


def fly_tasks(
    tasks: list[MissionTask],
    *,
    folder: Path | None,
    logs: Path | None,
    job_executor: JobExecutor,
    force: bool,
) -> list[MissionResult]:
    """Flies the missing flights; returns all results in order.

    Args:
        tasks: the flights.
        folder: folder of stored results; None stores nothing.
        logs: folder of their logs.
        job_executor: executor of the flights.
        force: write into folders with other files.

    Raises:
        AlreadyExistsError: a folder has files that are not of a validation, and `force` is not set.
        FlightError: a log that would be overwritten is of another flight, and `force` is not set.
    """
    if folder is None:
        if logs is not None:
            check_output_folder(logs, force=force)
        flown = job_executor.executor.map(fly_mission, tasks)
        return list(show_progress(flown, total=len(tasks), what="flying missions"))
    if not (folder / FLIGHTS).is_dir():
        check_output_folder(folder, force=force)
    for path in (task.log for task in tasks if task.log is not None):
        remove_partial_files(path.parent, of=path.name)
    flights = stored_tasks(tasks, folder / FLIGHTS)
    check = allow_other_files if force else check_no_replacement
    return complete(flights, folder / FLIGHTS, job_executor=job_executor, what="flying missions", check=check)
