"""Recognition of a finished regeneration, and removal of its flights."""

import shutil
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from flight.automaton.library import Library
from flight.automaton.library_file import read_library
from flight.errors import AlreadyExistsError, BadFileError
from flightlog.file.reader import read_log
from flightlog.identity.fingerprint import rounded_fingerprint
from identification.identify import TrimErrors
from identification.segmentation.flight_evidence import StateJudged
from runtime.atomic_write import write_atomically
from sim.campaign_flight import CampaignFlight

from .fly_campaign import CampaignOrder

_JUDGED_MOTIONS = {"truth": "true", "estimate": "believed"}


def find_made_library(
    path: Path, order: CampaignOrder, *, of: StateJudged, confidence: float, trim_errors: TrimErrors
) -> Library:
    """Returns an existing library if it is the ordered one.

    Its provenance must agree, and one of its flights, flown again, must give the recorded log.

    Raises:
        AlreadyExistsError: it is another library, or its data sheet is missing.
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
    found = {name: library.provenance.get(name) for name in wanted}
    kind, wind = library.conditions.trim_error_kind, library.conditions.wind
    same = (found, kind, wind, library.name) == (wanted, trim_errors, order.wind, path.stem)
    if not same or not path.with_suffix(".md").exists() or not _is_made_from(library, order):
        raise AlreadyExistsError(path)
    return library


def _is_made_from(library: Library, order: CampaignOrder) -> bool:
    """Flies the last flight again; returns True if the library lists it."""
    with TemporaryDirectory(prefix="maneuver-") as folder:
        flight = order.jobs(Path(folder))[-1]
        for path, content in flight.run().files:
            write_atomically(content, path)
        known = library.provenance.get("logs_by_seed", {})
        return bool(known.get(str(flight.specification.seed)) == rounded_fingerprint(read_log(flight.path)))


def remove_flights(flights: Sequence[CampaignFlight], folder: Path) -> None:
    """Removes a campaign's logs atomically, unless the folder has other files."""
    if set(folder.iterdir()) <= {flight.path for flight in flights}:
        folder.rename(_removal_folder(folder))
        finish_removal(folder)


def finish_removal(folder: Path) -> None:
    """Removes the rest of logs after an interrupted removal."""
    shutil.rmtree(_removal_folder(folder), ignore_errors=True)


def _removal_folder(folder: Path) -> Path:
    return folder.with_name(f".{folder.name}.removed")
