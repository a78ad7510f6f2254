"""A disk that notes every step, and the states that it may be in after a crash at any of them.

A process that is killed leaves what it wrote: the system still has it. A machine that stops leaves what was
synced, and of the rest whatever the disk had got to: pages of 4096 bytes, in any order and some of them in
part, and names whose folder was not synced. That is the weakest promise that file systems make; some make
stronger ones.
"""

from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from random import Random

from flight.publishing import Disk

_PAGE = 4096


class Loss(StrEnum):
    """What a crash takes away, beyond the steps that were still to come."""

    KILLED = "killed"
    DROPPED = "all unsynced dropped"
    TORN = "unsynced torn"
    NAMES_FIRST = "names kept, unsynced content dropped"


@dataclass(slots=True)
class _Content:
    """A file's content, apart from its names: as written, and as synced."""

    written: bytes = b""
    synced: bytes = b""


@dataclass(slots=True)
class _State:
    """Names and contents: as the system has them, and as the disk surely has them.

    Attributes:
        names: of files, as the system has them.
        kept: names that were synced with their folder.
        pending: changes of names since their folder was synced, in order: name, content or None.
    """

    names: dict[Path, _Content] = field(default_factory=dict)
    kept: dict[Path, _Content] = field(default_factory=dict)
    pending: list[tuple[Path, _Content | None]] = field(default_factory=list)

    def name(self, path: Path, content: _Content | None) -> None:
        """Gives or takes a name."""
        if content is None:
            self.names.pop(path, None)
        else:
            self.names[path] = content
        self.pending.append((path, content))

    def sync_names(self, folder: Path) -> None:
        """Makes the names of a folder last."""
        for path, content in self.pending:
            if path.parent == folder:
                _apply(self.kept, path, content)
        self.pending = [(path, content) for path, content in self.pending if path.parent != folder]


@dataclass(frozen=True, slots=True)
class _Step:
    """One call of the disk; what a write adds stands in `content`."""

    what: str
    path: Path
    target: Path | None = None
    content: bytes = b""


class NotingDisk(Disk):
    """Notes every step, and writes nothing; files exist in its notes alone.

    Args:
        piece: bytes that a write takes at most, so that there are steps within files.
    """

    def __init__(self, piece: int) -> None:
        self.steps: list[_Step] = []
        self._piece, self._open = piece, dict[int, Path]()

    def make_folder(self, path: Path) -> None:
        """Folders are made beforehand."""
        raise AssertionError(f"{path} was to be there")

    def open(self, path: Path) -> int:
        """Notes a file that is opened anew."""
        number = len(self._open)
        self._open[number] = path
        self.steps.append(_Step("open", path))
        return number

    def write(self, descriptor: int, content: bytes) -> int:
        """Notes a piece."""
        piece = content[: self._piece]
        self.steps.append(_Step("write", self._open[descriptor], content=piece))
        return len(piece)

    def sync(self, descriptor: int) -> None:
        """Notes that a content lasts."""
        self.steps.append(_Step("sync", self._open[descriptor]))

    def close(self, descriptor: int) -> None:
        """Closing promises nothing."""

    def rename(self, path: Path, target: Path) -> None:
        """Notes a new name."""
        self.steps.append(_Step("rename", path, target))

    def remove(self, path: Path) -> None:
        """Notes that a name is gone."""
        self.steps.append(_Step("remove", path))

    def sync_folder(self, path: Path) -> None:
        """Notes that names last."""
        self.steps.append(_Step("sync folder", path))


def after_crash(steps: list[_Step], loss: Loss, chance: Random) -> dict[Path, bytes]:
    """Returns the files, by name, that a disk may hold when all stops after some steps.

    Args:
        steps: that were taken.
        loss: what is taken away.
        chance: decides what of it, where that is open.
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


def _take(state: _State, step: _Step) -> None:
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
            # After a crash either name may be there, or both, or none.
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
