"""Lookup of scenarios and libraries by path or shipped name."""

from pathlib import Path

import libraries
from flight.automaton.library import Library
from flight.automaton.library_file import read_library
from flight.errors import BadFileError, FlightError, UnknownTrimError
from flight.mission.campaign import Campaign, read_campaign
from flight.mission.mission import Mission, read_mission
from flight.mission.sequence import Sequence, read_sequence

SCENARIO_FOLDER = Path(__file__).parent
MISSIONS = SCENARIO_FOLDER / "missions"
SEQUENCES = SCENARIO_FOLDER / "sequences"
CAMPAIGNS = SCENARIO_FOLDER / "campaigns"
FAULTS = SCENARIO_FOLDER / "faults"


class NoSuchFileError(FlightError):
    """Name of neither a file nor a shipped scenario."""

    def __init__(self, kind: str, name: str, shipped: list[str]) -> None:
        super().__init__(f"no {kind} {name!r}: expected an existing file or one of {shipped}")


def find_library(name: str) -> Library:
    """Reads a library by path or shipped name.

    Raises:
        FlightError: it does not exist or is invalid.
    """
    return read_library(library_path(name))


def library_path(name: str) -> Path:
    """Returns a library's path, by path or shipped name.

    Raises:
        NoSuchFileError: it does not exist.
    """
    return find_file("library", name, libraries.FOLDER, ".json")


def find_mission(name: str, library: Library | None = None) -> Mission:
    """Reads a mission by path or shipped name.

    Args:
        name: path or name.
        library: library that must contain the mission's trims; None to skip the check.

    Raises:
        FlightError: it does not exist, is invalid, or the library lacks a trim.
    """
    path = mission_path(name)
    mission = read_mission(path)
    known = None if library is None else [trim.id for trim in library.trims]
    for key, trim in (("start.trim", mission.start_trim), ("goal.trim", mission.goal_trim)):
        if known is not None and trim is not None and trim not in known:
            raise BadFileError(path, f"{key}: {UnknownTrimError(trim, known)}")
    return mission


def mission_path(name: str) -> Path:
    """Returns a mission's path, by path or shipped name.

    Raises:
        NoSuchFileError: it does not exist.
    """
    return find_file("mission", name, MISSIONS, ".toml")


def find_sequence(name: str) -> Sequence:
    """Reads a sequence by path or shipped name.

    Raises:
        FlightError: it does not exist or is invalid.
    """
    return read_sequence(sequence_path(name))


def sequence_path(name: str) -> Path:
    """Returns a sequence's path, by path or shipped name.

    Raises:
        NoSuchFileError: it does not exist.
    """
    return find_file("sequence", name, SEQUENCES, ".toml")


def find_campaign(name: str) -> Campaign:
    """Reads a campaign by path or shipped name.

    Raises:
        FlightError: it does not exist or is invalid.
    """
    return read_campaign(find_file("campaign", name, CAMPAIGNS, ".toml"))


def find_file(kind: str, name: str, folder: Path, suffix: str) -> Path:
    """Returns a file's path, by path or shipped name.

    Raises:
        NoSuchFileError: it does not exist.
    """
    path = Path(name)
    if path.exists():
        return path
    shipped = folder / f"{name}{suffix}"
    if path.name == name and shipped.exists():
        return shipped
    names = sorted(file.stem for file in folder.glob(f"*{suffix}") if not file.stem.endswith(".schema"))
    raise NoSuchFileError(kind, name, names)
