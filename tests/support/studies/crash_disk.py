"""Recording file system, and its possible states after a crash.

Writes of a killed process are kept by the system. After a power failure synced data are kept; of the rest any
subset of pages of 4096 bytes, some of them in part, and any names in unsynced folders. This is the weakest
guarantee of file systems; some give stronger ones.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from errno import ENOSPC
from pathlib import Path
from random import Random

from runtime.atomic_write import FileSystem

_PAGE = 4096


class Loss(StrEnum):
    """Losses of a crash beyond the steps that were still to come."""

    KILLED = "killed"
    DROPPED = "all unsynced dropped"
    TORN = "unsynced torn"
    NAMES_FIRST = "names kept, unsynced content dropped"


@dataclass(slots=True)
class _Content:
    """Content of a file: as written and as synced."""

    written: bytes = b""
    synced: bytes = b""


@dataclass(slots=True)
class _State:
    """Names and contents in the system and on the disk.

    Attributes:
        names: names of files in the system.
        kept: names synced with their folder.
        pending: later changes of names in order: name, content or None.
    """

    names: dict[Path, _Content] = field(default_factory=dict)
    kept: dict[Path, _Content] = field(default_factory=dict)
    pending: list[tuple[Path, _Content | None]] = field(default_factory=list)

    def name(self, path: Path, content: _Content | None) -> None:
        """Adds or removes a name."""
        if content is None:
            self.names.pop(path, None)
        else:
            self.names[path] = content
        self.pending.append((path, content))

    def sync_names(self, folder: Path) -> None:
        """Syncs the names of a folder."""
        for path, content in self.pending:
            if path.parent == folder:
                _apply(self.kept, path, content)
        self.pending = [(path, content) for path, content in self.pending if path.parent != folder]


@dataclass(frozen=True, slots=True)
class DiskStep:
    """One call of the disk; what a write adds stands in `content`."""

    what: str
    path: Path
    target: Path | None = None
    content: bytes = b""


class NotingDisk(FileSystem):
    """Does every step, and notes it.

    Args:
        piece: largest number of bytes of a write, so that files take several steps.
        full_after: number of steps after which the disk is full; None for never.
    """

    def __init__(self, piece: int, *, full_after: int | None = None) -> None:
        self.steps: list[DiskStep] = []
        self._piece, self._full_after, self._open = piece, full_after, dict[int, Path]()

    def open(self, path: Path) -> int:
        """Creates or truncates a file."""
        self._need_room()
        descriptor = super().open(path)
        self._open[descriptor] = path
        self.steps.append(DiskStep("open", path))
        return descriptor

    def write(self, descriptor: int, content: bytes) -> int:
        """Writes at most one piece."""
        self._need_room()
        taken = super().write(descriptor, content[: self._piece])
        self.steps.append(DiskStep("write", self._open[descriptor], content=content[:taken]))
        return taken

    def sync(self, descriptor: int) -> None:
        """Syncs a file's content."""
        self._need_room()
        super().sync(descriptor)
        self.steps.append(DiskStep("sync", self._open[descriptor]))

    def rename(self, path: Path, target: Path) -> None:
        """Renames a file."""
        super().rename(path, target)
        self.steps.append(DiskStep("rename", path, target))

    def remove(self, path: Path) -> None:
        """Removes a file."""
        super().remove(path)
        self.steps.append(DiskStep("remove", path))

    def sync_folder(self, path: Path) -> None:
        """Syncs a folder's names."""
        super().sync_folder(path)
        self.steps.append(DiskStep("sync folder", path))

    def _need_room(self) -> None:
        if self._full_after is not None and len(self.steps) >= self._full_after:
            raise OSError(ENOSPC, "No space left on device")


def after_crash(steps: Sequence[DiskStep], loss: Loss, chance: Random) -> dict[Path, bytes]:
    """Returns the files, by name, that a disk may hold when all stops after some steps.

    Args:
        steps: operations before the crash.
        loss: kind of loss.
        chance: random generator of the loss.
    """
    state = _State()
    for step in steps:
        _take(state, step)
    if loss is Loss.KILLED:
        return {path: content.written for path, content in state.names.items()}
    names = dict(state.kept)
    for path, content in state.pending:
        if loss is Loss.NAMES_FIRST or (loss is Loss.TORN and chance.random() < 0.5):
            _apply(names, path, content)
    if loss is Loss.TORN:
        return {path: _torn(content, chance) for path, content in names.items()}
    return {path: content.synced for path, content in names.items()}


def _take(state: _State, step: DiskStep) -> None:
    match step.what:
        case "open":
            if step.path in state.names:
                state.names[step.path].written = b""
            else:
                state.name(step.path, _Content())
        case "write":
            state.names[step.path].written += step.content
        case "sync":
            state.names[step.path].synced = state.names[step.path].written
        case "rename":
            assert step.target is not None
            content = state.names[step.path]
            # After a crash either name may exist, or both, or none.
            state.name(step.target, content)
            state.name(step.path, None)
        case "remove":
            state.name(step.path, None)
        case "sync folder":
            state.sync_names(step.path)


def _apply(names: dict[Path, _Content], path: Path, content: _Content | None) -> None:
    if content is None:
        names.pop(path, None)
    else:
        names[path] = content


def _torn(content: _Content, chance: Random) -> bytes:
    """Returns a content of which some pages that were not synced are there, some not, and one in part."""
    if content.written == content.synced:
        return content.written
    size = chance.randrange(len(content.written) + 1)
    pages = bytearray(content.synced[:size].ljust(size, b"\0"))
    for begin in range(0, size, _PAGE):
        end = min(begin + _PAGE, size)
        fate = chance.random()
        kept = end if fate < 0.5 else begin if fate < 0.9 else chance.randrange(begin, end + 1)
        pages[begin:kept] = content.written[begin:kept]
    return bytes(pages)
