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

from .atomic_write import partials, publish_bytes, publish_folder, remove_partials
from .executor import Means
from .job import Done, Found, State, Work
from .progress import shown

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
class Survey(Generic[Result]):
    """What a folder holds of some work.

    Attributes:
        folder: that was looked at.
        works: in their order.
        found: of each.
        strangers: files of the same kind that belong to none of them.
        partial: files that a writer left who was killed.
    """

    folder: Path
    works: tuple[Work[Result], ...]
    found: tuple[Found[Result], ...]
    strangers: tuple[Path, ...]
    partial: tuple[Path, ...]

    def paths(self, state: State) -> tuple[Path, ...]:
        """Returns the files that are in a state."""
        return tuple(
            work.path for work, found in zip(self.works, self.found, strict=True) if found.state is state
        )

    @property
    def complete(self) -> bool:
        """Whether all is there."""
        return all(found.state is State.WHOLE for found in self.found)


def survey(works: Sequence[Work[Result]], folder: Path) -> Survey[Result]:
    """Looks at every file, and alters nothing."""
    known = {work.path for work in works}
    kinds = {path.suffix for path in known}
    others = sorted(path for kind in kinds for path in folder.glob(f"[!.]*{kind}") if path not in known)
    found = tuple(work.found() for work in works)
    return Survey(folder, tuple(works), found, tuple(others), tuple(partials(folder)))


def refuse_others(seen: Survey[Result]) -> None:
    """Refuses to add to a folder that holds something else.

    Raises:
        FlightError: a file of the same name or kind is of other work.
        AlreadyExistsError: the folder holds none of this work, but something.
    """
    refuse_to_replace(seen)
    if seen.strangers:
        raise FlightError(
            f"{seen.folder} holds {seen.strangers[0].name}, which does not belong to this command "
            f"({len(seen.strangers)} such); give --force to leave it there, or another folder"
        )
    begun = any(found.state is not State.MISSING for found in seen.found) or seen.partial
    if not begun and any(seen.folder.iterdir()):
        raise AlreadyExistsError(seen.folder)


def refuse_to_replace(seen: Survey[Result]) -> None:
    """Refuses to replace files of other work; what stands beside is let be.

    Raises:
        FlightError: a file that would be replaced is of other work.
    """
    for found in seen.found:
        if found.state is State.ANOTHER:
            raise FlightError(f"{found.why}; give --force to replace it, or another folder")


def accept_others(seen: Survey[Result]) -> None:
    """Lets files of other work be: those in the way are replaced, those beside it stay."""


def complete(
    works: Sequence[Work[Result]],
    folder: Path,
    *,
    means: Means,
    what: str,
    check: Callable[[Survey[Result]], None] = refuse_others,
) -> list[Result]:
    """Does what is missing, and returns what all work came to, in its order.

    Args:
        works: each with a file of its own in the folder.
        folder: nobody else writes into it meanwhile.
        means: what does the work, and how files come here.
        what: is done, for the progress.
        check: raises where the folder holds what must not be touched.

    Raises:
        BusyError: another program is writing into the folder.
        FlightError: the check, the work or the writing says no; what is whole stays.
    """
    existed = folder.exists()
    with _alone_in(folder):
        seen = survey(works, folder)
        if existed:
            check(seen)
        remove_partials(folder)
        _say(seen)
        results = {n: one.result for n, one in enumerate(seen.found) if one.result is not None}
        missing = {n: work for n, work in enumerate(works) if n not in results}
        come = _sent_here(missing, means) if means.by_value else _kept_there(missing, means)
        with closing(come):
            results |= shown(come, total=len(works), done=len(results), what=what)
    return [results[n] for n in range(len(works))]


def _say(seen: Survey[Result]) -> None:
    whole = len(seen.paths(State.WHOLE))
    if whole:
        print(f"{whole} of {len(seen.works)} are there already", file=sys.stderr)
    for one in seen.found:
        if one.state is State.DAMAGED:
            print(f"done again: {one.why}", file=sys.stderr)


def _sent_here(missing: Mapping[int, Work[Result]], means: Means) -> Generator[tuple[int, Result]]:
    """Yields numbers and results as they come; workers send files by value."""
    sent = {means.executor.submit(_do, work): n for n, work in missing.items()}
    for future in _as_they_come(sent):
        done = future.result()
        for path, content in done.files:
            means.publish(content, path)
        yield sent.pop(future), done.result


def _kept_there(missing: Mapping[int, Work[Result]], means: Means) -> Generator[tuple[int, Result]]:
    """Yields numbers and results as they come; workers write files themselves."""
    here = Path.cwd()
    kept = {means.executor.submit(_do_and_keep, work, here): n for n, work in missing.items()}
    for future in _as_they_come(kept):
        result, n = future.result(), kept.pop(future)
        if not missing[n].path.exists():
            raise NotSharedError(missing[n].path)
        yield n, result


def _as_they_come(futures: Mapping[Future[Value], int]) -> Iterator[Future[Value]]:
    """Yields what is done; where somebody stops listening, the rest is not begun."""
    try:
        yield from as_completed(futures)
    finally:
        for future in futures:
            future.cancel()


def _do(work: Work[Result]) -> Done[Result]:
    return work.done()


def _do_and_keep(work: Work[Result], folder: Path) -> Result:
    """Works, and writes the files where relative paths start from a folder."""
    done = work.done()
    for path, content in done.files:
        publish_bytes(content, folder / path, force=True)
    return done.result


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """Makes a folder, and keeps other programs from writing into it; the system forgets that with us."""
    publish_folder(folder)
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
