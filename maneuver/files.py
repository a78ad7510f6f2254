"""Names on the command line: a file's path, or the name of something shipped."""

from pathlib import Path

import campaigns
import faults
import libraries
import missions
import sequences
from flight.campaign import Campaign, read_campaign
from flight.errors import AlreadyExistsError, FlightError
from flight.fault_matrix import FaultMatrix, read_fault_matrix
from flight.library import Library
from flight.library_file import read_library
from flight.mission import Mission, read_mission
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


def find_mission(name: str) -> Mission:
    """Reads a mission by path or shipped name.

    Raises:
        FlightError: there is none, or it is broken.
    """
    return read_mission(_find("mission", name, missions.FOLDER, ".toml"))


def find_sequence(name: str) -> Sequence:
    """Reads a sequence by path or shipped name.

    Raises:
        FlightError: there is none, or it is broken.
    """
    return read_sequence(_find("sequence", name, sequences.FOLDER, ".toml"))


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


def refuse_existing(path: Path, *, force: bool) -> None:
    """Refuses to go on where a result would overwrite something, before any work is done.

    Raises:
        AlreadyExistsError: the file exists, or the folder has something in it, and `force` is not set.
    """
    taken = any(path.iterdir()) if path.is_dir() else path.exists()
    if taken and not force:
        raise AlreadyExistsError(path)


def _find(kind: str, name: str, folder: Path, suffix: str) -> Path:
    path = Path(name)
    if path.exists():
        return path
    shipped = folder / f"{name}{suffix}"
    if path.name == name and shipped.exists():
        return shipped
    names = sorted(file.stem for file in folder.glob(f"*{suffix}") if not file.stem.endswith(".schema"))
    raise NoSuchFileError(kind, name, names)
