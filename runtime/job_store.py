"""Work that is kept as it comes: started again, the same command does only what is missing.

Nothing but the files says what is done. Each is published whole, and tells by its content whose it is, so
that there is no register that could disagree with them.
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
    """Two programs were to write into one folder at the same time."""

    def __init__(self, folder: Path) -> None:
        super().__init__(f"{folder}: another program is writing there; wait for it, or give another folder")


class NotSharedError(FlightError):
    """A worker wrote a file that is not seen here."""

    def __init__(self, path: Path) -> None:
        super().__init__(
            f"{path} was written by a worker and is not seen here: expected the same folder on every "
            "machine; without --shared-folder workers send files back"
        )


@dataclass(frozen=True, slots=True)
class JobStoreStatus(Generic[Result]):
    """What a folder holds of some work.

    Attributes:
        folder: that was looked at.
        jobs: in their order.
        status: of each.
        foreign_files: files of the same kind that belong to none of them.
        partial_files: files that a writer left who was killed.
    """

    folder: Path
    jobs: tuple[Job[Result], ...]
    status: tuple[JobStatus[Result], ...]
    foreign_files: tuple[Path, ...]
    partial_files: tuple[Path, ...]

    def paths(self, state: JobState) -> tuple[Path, ...]:
        """Returns the files that are in a state."""
        return tuple(
            job.path for job, found in zip(self.jobs, self.status, strict=True) if found.state is state
        )

    @property
    def complete(self) -> bool:
        """Whether all is there."""
        return all(found.state is JobState.WHOLE for found in self.status)


def inspect_jobs(jobs: Sequence[Job[Result]], folder: Path) -> JobStoreStatus[Result]:
    """Looks at every file, and alters nothing."""
    known = {job.path for job in jobs}
    kinds = {path.suffix for path in known}
    others = sorted(path for kind in kinds for path in folder.glob(f"[!.]*{kind}") if path not in known)
    found = tuple(job.status() for job in jobs)
    return JobStoreStatus(folder, tuple(jobs), found, tuple(others), tuple(partial_files(folder)))


def check_own_folder(store: JobStoreStatus[Result]) -> None:
    """Refuses to add to a folder that holds something else.

    Raises:
        FlightError: a file of the same name or kind is of other work.
        AlreadyExistsError: the folder holds none of this work, but something.
    """
    check_no_replacement(store)
    if store.foreign_files:
        raise FlightError(
            f"{store.folder} holds {store.foreign_files[0].name}, which does not belong to this command "
            f"({len(store.foreign_files)} such); give --force to leave it there, or another folder"
        )
    begun = any(found.state is not JobState.MISSING for found in store.status) or store.partial_files
    if not begun and any(store.folder.iterdir()):
        raise AlreadyExistsError(store.folder)


def check_no_replacement(store: JobStoreStatus[Result]) -> None:
    """Refuses to replace files of other work; what stands beside is let be.

    Raises:
        FlightError: a file that would be replaced is of other work.
    """
    for found in store.status:
        if found.state is JobState.ANOTHER:
            raise FlightError(f"{found.reason}; give --force to replace it, or another folder")


def allow_other_files(store: JobStoreStatus[Result]) -> None:
    """Lets files of other work be: those in the way are replaced, those beside it stay."""


def complete(
    jobs: Sequence[Job[Result]],
    folder: Path,
    *,
    job_executor: JobExecutor,
    what: str,
    check: Callable[[JobStoreStatus[Result]], None] = check_own_folder,
) -> list[Result]:
    """Does what is missing, and returns what all work came to, in its order.

    Args:
        jobs: each with a file of its own in the folder.
        folder: nobody else writes into it meanwhile.
        job_executor: what does the work, and how files come here.
        what: is done, for the progress.
        check: raises where the folder holds what must not be touched.

    Raises:
        BusyError: another program is writing into the folder.
        FlightError: the check, the work or the writing says no; what is whole stays.
    """
    existed = folder.exists()
    with _exclusive_folder(folder):
        store = inspect_jobs(jobs, folder)
        if existed:
            check(store)
        remove_partial_files(folder)
        _print_status(store)
        results = {n: one.result for n, one in enumerate(store.status) if one.result is not None}
        missing = {n: job for n, job in enumerate(jobs) if n not in results}
        come = (
            _run_and_collect(missing, job_executor)
            if job_executor.by_value
            else _run_in_shared_folder(missing, job_executor)
        )
        with closing(come):
            results |= show_progress(come, total=len(jobs), done=len(results), what=what)
    return [results[n] for n in range(len(jobs))]


def _print_status(store: JobStoreStatus[Result]) -> None:
    whole = len(store.paths(JobState.WHOLE))
    if whole:
        print(f"{whole} of {len(store.jobs)} are there already", file=sys.stderr)
    for one in store.status:
        if one.state is JobState.DAMAGED:
            print(f"done again: {one.reason}", file=sys.stderr)


def _run_and_collect(
    missing: Mapping[int, Job[Result]], job_executor: JobExecutor
) -> Generator[tuple[int, Result]]:
    """Yields numbers and results as they come; workers send files by value."""
    sent = {job_executor.executor.submit(_run_job, job): n for n, job in missing.items()}
    for future in _completed_futures(sent):
        done = future.result()
        for path, content in done.files:
            job_executor.write(content, path)
        yield sent.pop(future), done.result


def _run_in_shared_folder(
    missing: Mapping[int, Job[Result]], job_executor: JobExecutor
) -> Generator[tuple[int, Result]]:
    """Yields numbers and results as they come; workers write files themselves."""
    here = Path.cwd()
    kept = {job_executor.executor.submit(_run_and_write, job, here): n for n, job in missing.items()}
    for future in _completed_futures(kept):
        result, n = future.result(), kept.pop(future)
        if not missing[n].path.exists():
            raise NotSharedError(missing[n].path)
        yield n, result


def _completed_futures(futures: Mapping[Future[Value], int]) -> Iterator[Future[Value]]:
    """Yields what is done; where somebody stops listening, the rest is not begun."""
    try:
        yield from as_completed(futures)
    finally:
        for future in futures:
            future.cancel()


def _run_job(job: Job[Result]) -> JobResult[Result]:
    return job.run()


def _run_and_write(job: Job[Result], folder: Path) -> Result:
    """Works, and writes the files where relative paths start from a folder."""
    done = job.run()
    for path, content in done.files:
        write_atomically(content, folder / path, force=True)
    return done.result


@contextmanager
def _exclusive_folder(folder: Path) -> Iterator[None]:
    """Makes a folder, and keeps other programs from writing into it; the system forgets that with us."""
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
        # Some network file systems know no locks; files are whole there too.
        return
