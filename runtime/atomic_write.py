"""Atomic file writing: complete or absent after any crash."""

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
    """File operations of an atomic write, one call a step.

    Tests and benchmarks substitute their own.
    """

    def make_folder(self, path: Path) -> None:
        """Makes one folder in an existing parent."""
        path.mkdir(exist_ok=True)

    def open(self, path: Path) -> int:
        """Creates or truncates a file and returns its descriptor."""
        return os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o666)

    def write(self, descriptor: int, content: bytes) -> int:
        """Writes bytes and returns the number written."""
        return os.write(descriptor, content)

    def sync(self, descriptor: int) -> None:
        """Flushes a file to the disk."""
        os.fsync(descriptor)

    def close(self, descriptor: int) -> None:
        """Closes a file."""
        os.close(descriptor)

    def rename(self, path: Path, target: Path) -> None:
        """Renames a file over another in one step."""
        path.replace(target)

    def remove(self, path: Path) -> None:
        """Removes a file if it exists."""
        path.unlink(missing_ok=True)

    def sync_folder(self, path: Path) -> None:
        """Flushes a folder's names to the disk."""
        descriptor = os.open(path, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


FILE_SYSTEM = FileSystem()


def write_atomically(
    content: bytes, path: Path, *, force: bool = False, file_system: FileSystem = FILE_SYSTEM
) -> None:
    """Writes a file atomically: temporary file, sync, rename, folder sync.

    After the return the file survives a power failure. A symbolic link is kept; its target is written.

    Raises:
        AlreadyExistsError: the file exists and `force` is not set.
        CannotWriteError: the path is no regular file, or a system call failed; nothing is left behind, or the
            complete file where only the sync of the folder failed.
    """
    target = file_target(path, force=force)
    try:
        _write_and_rename(content, target, file_system)
    except OSError as error:
        raise CannotWriteError(path, error.strerror or str(error)) from None


def file_target(path: Path, *, force: bool) -> Path:
    """Returns the path to write: the given one, or its link's target.

    Folders, devices and pipes are refused, because the rename would replace them.

    Raises:
        AlreadyExistsError: the file exists and `force` is not set.
        CannotWriteError: the path is not a regular file, or cannot be one.
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
    """Writes a file atomically unless it already has this content.

    Raises:
        AlreadyExistsError: the file exists with other content, and `force` is not set.
        CannotWriteError: a system call failed; nothing is left behind.
    """
    if not path.is_file() or path.read_bytes() != content:
        write_atomically(content, path, force=force)


def make_durable_folder(path: Path, *, file_system: FileSystem = FILE_SYSTEM) -> None:
    """Makes a folder and its missing parents, synced to the disk.

    Raises:
        AlreadyExistsError: a file has this name.
        CannotWriteError: a system call failed.
    """
    if path.exists() and not path.is_dir():
        raise AlreadyExistsError(path)
    try:
        _make_folders(path, file_system)
    except OSError as error:
        raise CannotWriteError(path, error.strerror or str(error)) from None


def remove_partial_files(folder: Path, *, of: str = "*") -> None:
    """Removes partial files of killed writers.

    No other program may be writing these files.

    Args:
        folder: folder to clean.
        of: pattern of the final names.
    """
    for path in partial_files(folder, of=of):
        path.unlink(missing_ok=True)


def partial_files(folder: Path, *, of: str = "*") -> list[Path]:
    """Returns a folder's partial files by a pattern of final names."""
    return sorted(folder.glob(f".{of}.*{PARTIAL}"))


def _write_and_rename(content: bytes, path: Path, file_system: FileSystem) -> None:
    _make_folders(path.parent, file_system)
    # Two machines may write the same file into a shared folder.
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
    """Makes a folder and its missing parents, each synced."""
    if path.is_dir():
        return
    _make_folders(path.parent, file_system)
    file_system.make_folder(path)
    file_system.sync_folder(path.parent)


def check_output_files(
    *files: Path | None, force: bool, inputs: Iterable[Path] = (), ending: str = ""
) -> None:
    """Refuses output files that cannot be written or overlap inputs.

    Args:
        files: output files of one command; None entries are skipped.
        force: overwrite existing files.
        inputs: input files of the command, never overwritten.
        ending: required ending of the names; empty for any.

    Raises:
        AlreadyExistsError: a file exists and `force` is not set.
        CannotWriteError: a path is not a regular file.
        FlightError: two outputs, or an output and an input, are the same file; or a name has another ending.
    """
    taken = {os.path.realpath(path): f"the input {path}" for path in inputs}
    for path in (file for file in files if file is not None):
        if path.suffix.lower() != ending and ending:
            raise FlightError(f"expected a name that ends with {ending}, got {path}")
        target = os.path.realpath(path)
        if target in taken:
            raise FlightError(f"{path}: expected another file than {taken[target]}, got the same")
        file_target(path, force=force)
        taken[target] = f"the output {path}"


def check_output_folder(folder: Path, *, force: bool) -> None:
    """Refuses an output folder that is not empty or no folder.

    Raises:
        AlreadyExistsError: the folder is not empty, and `force` is not set.
        CannotWriteError: the path is not a folder.
    """
    if (folder.exists() or folder.is_symlink()) and not folder.is_dir():
        raise CannotWriteError(folder, "expected the name of a folder, got something else")
    if folder.is_dir() and any(folder.iterdir()) and not force:
        raise AlreadyExistsError(folder)
