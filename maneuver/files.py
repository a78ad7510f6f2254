"""Names on the command line: a file's path, or the name of something shipped."""

import os
from collections.abc import Iterable
from pathlib import Path

import campaigns
import faults
import libraries
import missions
import sequences
from flight.campaign import Campaign, read_campaign
from flight.errors import AlreadyExistsError, BadFileError, CannotWriteError, FlightError, UnknownTrimError
from flight.fault_matrix import FaultMatrix, read_fault_matrix
from flight.library import Library
from flight.library_file import read_library
from flight.mission import Mission, read_mission
from flight.publishing import file_target
from flight.sequence import Sequence, read_sequence


class NoSuchFileError(FlightError):
    """Neither a file nor anything shipped has the name that was given."""

    def __init__(self, kind: str, name: str, shipped: list[str]) -> None:
        super().__init__(f"no {kind} {name!r}: no such file, and the shipped ones are {shipped}")


def find_library(name: str) -> Library:
    """Reads a library by path or shipped name.

    Raises:
        FlightError: there is none, or it is broken.
    """
    return read_library(library_path(name))


def library_path(name: str) -> Path:
    """Returns where a library is, by path or shipped name.

    Raises:
        NoSuchFileError: there is none.
    """
    return _find("library", name, libraries.FOLDER, ".json")


def find_mission(name: str, library: Library | None = None) -> Mission:
    """Reads a mission by path or shipped name.

    Args:
        name: path or name.
        library: that has to have its trims, where one is given.

    Raises:
        FlightError: there is none, it is broken, or the library lacks a trim.
    """
    path = mission_path(name)
    mission = read_mission(path)
    known = None if library is None else [trim.id for trim in library.trims]
    for key, trim in (("start.trim", mission.start_trim), ("goal.trim", mission.goal_trim)):
        if known is not None and trim is not None and trim not in known:
            raise BadFileError(path, f"{key}: {UnknownTrimError(trim, known)}")
    return mission


def mission_path(name: str) -> Path:
    """Returns where a mission is, by path or shipped name.

    Raises:
        NoSuchFileError: there is none.
    """
    return _find("mission", name, missions.FOLDER, ".toml")


def find_sequence(name: str) -> Sequence:
    """Reads a sequence by path or shipped name.

    Raises:
        FlightError: there is none, or it is broken.
    """
    return read_sequence(sequence_path(name))


def sequence_path(name: str) -> Path:
    """Returns where a sequence is, by path or shipped name.

    Raises:
        NoSuchFileError: there is none.
    """
    return _find("sequence", name, sequences.FOLDER, ".toml")


def find_campaign(name: str) -> Campaign:
    """Reads a campaign by path or shipped name.

    Raises:
        FlightError: there is none, or it is broken.
    """
    return read_campaign(_find("campaign", name, campaigns.FOLDER, ".toml"))


def find_fault_matrix(name: str) -> FaultMatrix:
    """Reads a fault matrix by path or shipped name.

    Raises:
        FlightError: there is none, or it is broken.
    """
    return read_fault_matrix(_find("fault matrix", name, faults.FOLDER, ".toml"))


def refuse_files(*files: Path | None, force: bool, inputs: Iterable[Path] = (), ending: str = "") -> None:
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


def refuse_folder(folder: Path, *, force: bool) -> None:
    """Refuses, before any work is done, a folder for results that has something in it, or is none.

    Raises:
        AlreadyExistsError: the folder has something in it, and `force` is not set.
        CannotWriteError: something else than a folder has the name.
    """
    if (folder.exists() or folder.is_symlink()) and not folder.is_dir():
        raise CannotWriteError(folder, "expected the name of a folder, got something else")
    if folder.is_dir() and any(folder.iterdir()) and not force:
        raise AlreadyExistsError(folder)


def _find(kind: str, name: str, folder: Path, suffix: str) -> Path:
    path = Path(name)
    if path.exists():
        return path
    shipped = folder / f"{name}{suffix}"
    if path.name == name and shipped.exists():
        return shipped
    names = sorted(file.stem for file in folder.glob(f"*{suffix}") if not file.stem.endswith(".schema"))
    raise NoSuchFileError(kind, name, names)
