"""A regeneration that is finished: known again, and its flights cleared away in one step."""

import shutil
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from flight.automaton.library import Library
from flight.automaton.library_file import read_library
from flight.errors import AlreadyExistsError, BadFileError
from flightlog.file.reader import read_log
from flightlog.fingerprint import fingerprint
from identification.identify import TrimErrors
from identification.segmentation.flight_evidence import StateJudged
from runtime.atomic_write import write_atomically
from sim.campaign_flight import CampaignFlight

from .fly_campaign import CampaignOrder

_JUDGED_MOTIONS = {"truth": "true", "estimate": "believed"}


def find_made_library(
    path: Path, order: CampaignOrder, *, of: StateJudged, confidence: float, trim_errors: TrimErrors
) -> Library:
    """Returns a library that is there, if it is the one that is to be made.

    It must say so, and one of its flights, flown again, must be the flight that it names.

    Raises:
        AlreadyExistsError: it is another, or its data sheet is missing.
    """
    try:
        library = read_library(path)
    except BadFileError:
        raise AlreadyExistsError(path) from None
    wanted = {
        "campaign": order.provenance(),
        "deviations_of": _JUDGED_MOTIONS[of],
        "confidence": confidence,
    }
    said = {name: library.provenance.get(name) for name in wanted}
    kind, wind = library.conditions.trim_error_kind, library.conditions.wind
    same = (said, kind, wind, library.name) == (wanted, trim_errors, order.wind, path.stem)
    if not same or not path.with_suffix(".md").exists() or not _is_made_from(library, order):
        raise AlreadyExistsError(path)
    return library


def _is_made_from(library: Library, order: CampaignOrder) -> bool:
    """Flies the last flight again, and returns whether the library names it."""
    with TemporaryDirectory(prefix="maneuver-") as folder:
        flight = order.jobs(Path(folder))[-1]
        for path, content in flight.run().files:
            write_atomically(content, path)
        known = library.provenance.get("logs_by_seed", {})
        return bool(known.get(str(flight.specification.seed)) == fingerprint(read_log(flight.path)))


def remove_flights(flights: Sequence[CampaignFlight], folder: Path) -> None:
    """Removes a campaign's logs all at once, unless something else stands beside them."""
    if set(folder.iterdir()) <= {flight.path for flight in flights}:
        folder.rename(_removal_folder(folder))
        finish_removal(folder)


def finish_removal(folder: Path) -> None:
    """Removes what is left of logs where the program was stopped while it removed them."""
    shutil.rmtree(_removal_folder(folder), ignore_errors=True)


def _removal_folder(folder: Path) -> Path:
    return folder.with_name(f".{folder.name}.removed")
