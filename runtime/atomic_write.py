"""Files that are there whole or not at all, whenever the program or the machine stops."""

import os
import secrets
import stat
from collections.abc import Iterable
from pathlib import Path

from flight.errors import AlreadyExistsError, CannotWriteError, FlightError

PARTIAL = ".partial"
"""Ending of files that are being written; their names begin with a dot."""

_PIECE = 1 << 20


class FileSystem:
    """What publishing asks of the operating system, one call a step; tests and benchmarks put others here."""

    def make_folder(self, path: Path) -> None:
        """Makes one folder, whose parent is there."""
        path.mkdir(exist_ok=True)

    def open(self, path: Path) -> int:
        """Opens a file anew, and returns its descriptor."""
        return os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)

    def write(self, descriptor: int, content: bytes) -> int:
        """Writes on, and returns how many bytes were taken."""
        return os.write(descriptor, content)

    def sync(self, descriptor: int) -> None:
        """Waits until what was written would outlive the machine."""
        os.fsync(descriptor)

    def close(self, descriptor: int) -> None:
        """Closes a file."""
        os.close(descriptor)

    def rename(self, path: Path, target: Path) -> None:
        """Gives a file the name of another, which is gone then, in one step."""
        path.replace(target)

    def remove(self, path: Path) -> None:
        """Removes a file, if it is there."""
        path.unlink(missing_ok=True)

    def sync_folder(self, path: Path) -> None:
        """Waits until the names in a folder would outlive the machine."""
        descriptor = os.open(path, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


FILE_SYSTEM = FileSystem()


def write_atomically(
    content: bytes, path: Path, *, force: bool = False, file_system: FileSystem = FILE_SYSTEM
) -> None:
    """Writes a file whole or not at all: temporary file, sync, rename, sync of the folder.

    When this returns the file outlives the machine's stop. A symbolic link stays, and what it leads to is
    written.

    Raises:
        AlreadyExistsError: the file exists and `force` is not set.
        CannotWriteError: it is no regular file, or the system says no; what is left behind is nothing, or the
            whole file where nothing but the folder could not be synced.
    """
    target = file_target(path, force=force)
    try:
        _write_and_rename(content, target, file_system)
    except OSError as error:
        raise CannotWriteError(path, error.strerror or str(error)) from None


def file_target(path: Path, *, force: bool) -> Path:
    """Returns where a file is written: PATH, or what a symbolic link there leads to.

    A folder, a device or a pipe would be replaced by the rename, not written: none of them is taken.

    Raises:
        AlreadyExistsError: the file exists and `force` is not set.
        CannotWriteError: something else than a file has its name, or there can be none.
    """
    try:
        mode = None if path.name == ".." else path.stat().st_mode
    except FileNotFoundError:
        return Path(os.path.realpath(path)) if path.is_symlink() else path
    except OSError as error:
        raise CannotWriteError(path, error.strerror or str(error)) from None
    if mode is None or not stat.S_ISREG(mode):
        what = "a folder" if mode is None or stat.S_ISDIR(mode) else "a device, a pipe or a socket"
        raise CannotWriteError(path, f"expected the name of a file, got {what}")
    if not force:
        raise AlreadyExistsError(path)
    return Path(os.path.realpath(path)) if path.is_symlink() else path


def write_unless_equal(content: bytes, path: Path, *, force: bool = False) -> None:
    """Writes a file whole or not at all, unless it is there with this very content.

    Raises:
        AlreadyExistsError: the file exists with other content, and `force` is not set.
        CannotWriteError: the system says no; nothing is left behind.
    """
    if not path.is_file() or path.read_bytes() != content:
        write_atomically(content, path, force=force)


def make_durable_folder(path: Path, *, file_system: FileSystem = FILE_SYSTEM) -> None:
    """Makes a folder that outlives the machine, and those above it, where they are not there.

    Raises:
        AlreadyExistsError: a file has its name.
        CannotWriteError: the system says no.
    """
    if path.exists() and not path.is_dir():
        raise AlreadyExistsError(path)
    try:
        _make_folders(path, file_system)
    except OSError as error:
        raise CannotWriteError(path, error.strerror or str(error)) from None


def remove_partial_files(folder: Path, *, of: str = "*") -> None:
    """Removes what writers left that were killed; nobody else may be writing these files.

    Args:
        folder: to be cleared.
        of: names of the files that were being written, as a pattern.
    """
    for path in partial_files(folder, of=of):
        path.unlink(missing_ok=True)


def partial_files(folder: Path, *, of: str = "*") -> list[Path]:
    """Returns the files of a folder that were being written, by a pattern of the names they were to have."""
    return sorted(folder.glob(f".{of}.*{PARTIAL}"))


def _write_and_rename(content: bytes, path: Path, file_system: FileSystem) -> None:
    _make_folders(path.parent, file_system)
    # Two machines may write the same file into a folder that they share.
    partial = path.with_name(f".{path.name}.{secrets.token_hex(4)}{PARTIAL}")
    try:
        _write(content, partial, file_system)
        file_system.rename(partial, path)
    except BaseException:
        file_system.remove(partial)
        raise
    file_system.sync_folder(path.parent)


def _write(content: bytes, path: Path, file_system: FileSystem) -> None:
    descriptor = file_system.open(path)
    try:
        left = memoryview(content)
        while left:
            left = left[file_system.write(descriptor, bytes(left[:_PIECE])) :]
        file_system.sync(descriptor)
    finally:
        file_system.close(descriptor)


def _make_folders(path: Path, file_system: FileSystem) -> None:
    """Makes a folder and those above it; a name outlives the machine only where its folder was synced."""
    if path.is_dir():
        return
    _make_folders(path.parent, file_system)
    file_system.make_folder(path)
    file_system.sync_folder(path.parent)


def check_output_files(
    *files: Path | None, force: bool, inputs: Iterable[Path] = (), ending: str = ""
) -> None:
    """Refuses, before any work is done, results that cannot be written or would destroy something.

    Args:
        files: that one command writes; None is none.
        force: overwrite what is there.
        inputs: what the command reads, which no force gives up.
        ending: of the files' names, where it says what is in them.

    Raises:
        AlreadyExistsError: a file exists and `force` is not set.
        CannotWriteError: something else than a file has the name.
        FlightError: two results, or a result and an input, are one file; or a name ends otherwise.
    """
    taken = {os.path.realpath(path): f"{path}, which it reads" for path in inputs}
    for path in (one for one in files if one is not None):
        if path.suffix.lower() != ending and ending:
            raise FlightError(f"expected a name that ends with {ending}, got {path}")
        target = os.path.realpath(path)
        if target in taken:
            raise FlightError(f"{path}: one command cannot write this and {taken[target]}; give another name")
        file_target(path, force=force)
        taken[target] = f"{path}, which it also writes"


def check_output_folder(folder: Path, *, force: bool) -> None:
    """Refuses, before any work is done, a folder for results that has something in it, or is none.

    Raises:
        AlreadyExistsError: the folder has something in it, and `force` is not set.
        CannotWriteError: something else than a folder has the name.
    """
    if (folder.exists() or folder.is_symlink()) and not folder.is_dir():
        raise CannotWriteError(folder, "expected the name of a folder, got something else")
    if folder.is_dir() and any(folder.iterdir()) and not force:
        raise AlreadyExistsError(folder)
