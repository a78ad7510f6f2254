"""Job store: runs missing jobs only and keeps each result.

The files alone record progress. Each is written atomically and its content identifies its job, so that there
is no separate register that could disagree with them.
"""

import fcntl
import os
import sys
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import Future, as_completed
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

from flight.errors import AlreadyExistsError, FlightError

from .atomic_write import make_durable_folder, partial_files, remove_partial_files, write_atomically
from .executor import JobExecutor
from .job import Job, JobResult, JobState, JobStatus
from .progress import show_progress

Result = TypeVar("Result")
Value = TypeVar("Value")


class BusyError(FlightError):
    """Two programs writing into one folder at the same time."""

    def __init__(self, folder: Path) -> None:
        super().__init__(f"{folder} is locked by another program; wait for it, or give another folder")


class NotSharedError(FlightError):
    """File written by a worker but not visible here."""

    def __init__(self, path: Path) -> None:
        super().__init__(
            f"{path}: written by a worker but not visible here; expected a folder shared by all machines; "
            "without --shared-folder workers send files back"
        )


@dataclass(frozen=True, slots=True)
class JobStoreStatus(Generic[Result]):
    """Status of a set of jobs in a folder.

    Attributes:
        folder: folder inspected.
        jobs: jobs in order.
        status: status of each job.
        foreign_files: files of the same kind that belong to no job.
        partial_files: partial files of killed writers.
    """

    folder: Path
    jobs: tuple[Job[Result], ...]
    status: tuple[JobStatus[Result], ...]
    foreign_files: tuple[Path, ...]
    partial_files: tuple[Path, ...]

    def paths(self, state: JobState) -> tuple[Path, ...]:
        """Returns the files in a state."""
        return tuple(
            job.path for job, status in zip(self.jobs, self.status, strict=True) if status.state is state
        )

    @property
    def complete(self) -> bool:
        """True if all jobs are done."""
        return all(status.state is JobState.WHOLE for status in self.status)


def inspect_jobs(jobs: Sequence[Job[Result]], folder: Path) -> JobStoreStatus[Result]:
    """Returns the status of all jobs without changing any file."""
    known = {job.path for job in jobs}
    kinds = {path.suffix for path in known}
    others = sorted(path for kind in kinds for path in folder.glob(f"[!.]*{kind}") if path not in known)
    found = tuple(job.status() for job in jobs)
    return JobStoreStatus(folder, tuple(jobs), found, tuple(others), tuple(partial_files(folder)))


def check_own_folder(store: JobStoreStatus[Result]) -> None:
    """Refuses a folder that holds anything but these jobs' files.

    Raises:
        FlightError: a file of the same name or kind belongs to another job.
        AlreadyExistsError: the folder holds no file of these jobs, but others.
    """
    check_no_replacement(store)
    if store.foreign_files:
        raise FlightError(
            f"{store.folder}: expected only files of this command, got {store.foreign_files[0].name} "
            f"({len(store.foreign_files)} unrelated files); give --force to keep them, or another folder"
        )
    begun = any(found.state is not JobState.MISSING for found in store.status) or store.partial_files
    if not begun and any(store.folder.iterdir()):
        raise AlreadyExistsError(store.folder)


def check_no_replacement(store: JobStoreStatus[Result]) -> None:
    """Refuses to replace files of other jobs; other files are ignored.

    Raises:
        FlightError: a file that would be replaced belongs to another job.
    """
    for found in store.status:
        if found.state is JobState.ANOTHER:
            raise FlightError(f"{found.reason}; give --force to replace it, or another folder")


def allow_other_files(store: JobStoreStatus[Result]) -> None:
    """Accepts any folder: conflicting files are replaced, others are kept."""


def complete(
    jobs: Sequence[Job[Result]],
    folder: Path,
    *,
    job_executor: JobExecutor,
    what: str,
    check: Callable[[JobStoreStatus[Result]], None] = check_own_folder,
) -> list[Result]:
    """Runs the missing jobs and returns all results in order.

    Args:
        jobs: jobs, each with its own file in the folder.
        folder: output folder, locked during the run.
        job_executor: executor of the jobs.
        what: label of the progress bar.
        check: raises if the folder holds files that must not be touched.

    Raises:
        BusyError: another program is writing into the folder.
        FlightError: the check, a job or a write failed; finished files stay.
    """
    existed = folder.exists()
    with _exclusive_folder(folder):
        store = inspect_jobs(jobs, folder)
        if existed:
            check(store)
        remove_partial_files(folder)
        _print_status(store)
        results = {n: status.result for n, status in enumerate(store.status) if status.result is not None}
        missing = {n: job for n, job in enumerate(jobs) if n not in results}
        finished = (
            _run_and_collect(missing, job_executor)
            if job_executor.by_value
            else _run_in_shared_folder(missing, job_executor)
        )
        with closing(finished):
            results |= show_progress(finished, total=len(jobs), done=len(results), what=what)
    return [results[n] for n in range(len(jobs))]


def _print_status(store: JobStoreStatus[Result]) -> None:
    whole = len(store.paths(JobState.WHOLE))
    if whole:
        print(f"{whole} of {len(store.jobs)} already done", file=sys.stderr)
    for status in store.status:
        if status.state is JobState.DAMAGED:
            print(f"repeated: {status.reason}", file=sys.stderr)


def _run_and_collect(
    missing: Mapping[int, Job[Result]], job_executor: JobExecutor
) -> Generator[tuple[int, Result]]:
    """Yields job numbers and results; workers send files by value."""
    sent = {job_executor.executor.submit(_run_job, job): n for n, job in missing.items()}
    for future in _completed_futures(sent):
        done = future.result()
        for path, content in done.files:
            job_executor.write(content, path)
        yield sent.pop(future), done.result


def _run_in_shared_folder(
    missing: Mapping[int, Job[Result]], job_executor: JobExecutor
) -> Generator[tuple[int, Result]]:
    """Yields job numbers and results; workers write the files."""
    here = Path.cwd()
    submitted = {job_executor.executor.submit(_run_and_write, job, here): n for n, job in missing.items()}
    for future in _completed_futures(submitted):
        result, n = future.result(), submitted.pop(future)
        if not missing[n].path.exists():
            raise NotSharedError(missing[n].path)
        yield n, result


def _completed_futures(futures: Mapping[Future[Value], int]) -> Iterator[Future[Value]]:
    """Yields completed futures and cancels the rest on exit."""
    try:
        yield from as_completed(futures)
    finally:
        for future in futures:
            future.cancel()


def _run_job(job: Job[Result]) -> JobResult[Result]:
    return job.run()


def _run_and_write(job: Job[Result], folder: Path) -> Result:
    """Runs a job and writes its files below a folder."""
    done = job.run()
    for path, content in done.files:
        write_atomically(content, folder / path, force=True)
    return done.result


@contextmanager
def _exclusive_folder(folder: Path) -> Iterator[None]:
    """Makes and locks a folder; the lock ends with the process."""
    make_durable_folder(folder)
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        _lock(descriptor, folder)
        yield
    finally:
        os.close(descriptor)


def _lock(descriptor: int, folder: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        raise BusyError(folder) from None
    except OSError:
        # Some network file systems have no locks; files are written atomically there too.
        return
