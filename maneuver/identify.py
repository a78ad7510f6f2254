"""`maneuver identify`: logs in, library out."""

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from flight.errors import FlightError
from flight.library import Library
from flight.library_file import library_hash, library_text
from flight.log_file import publish_bytes
from identification.data_sheet import data_sheet
from identification.identify import identify as identify_library

from .evidence import gather_evidence
from .files import refuse_existing
from .numbers import Count
from .workers import default_workers, worker_pool


def identify(
    logs: Annotated[list[Path], Parameter(negative="")],
    /,
    *,
    out: Path,
    name: str | None = None,
    confidence: float = 0.95,
    workers: Count | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Identifies a motion-primitive library from flight logs, and from nothing else.

    A maneuver is entered when the command changes and ends by the rule that the logs carry. Values are means,
    errors the largest deviations of the true motion, signed by the convention. Beside the library stands its
    data sheet, OUT with the ending .md.

    For example:

        maneuver identify flights/ --out mine.json

        maneuver identify flights/gtmax-0000.mcap flights/gtmax-0001.mcap --out mine.json

    Args:
        logs: flight logs, or folders of them.
        out: where the library goes.
        name: of the library; OUT's by default.
        confidence: with which the coverage is claimed.
        workers: processes that read logs; one for each processor by default.
        force: overwrite OUT.
        json: print the library as JSON.
    """
    if not 0 < confidence < 1:
        raise FlightError(f"--confidence must be between 0 and 1, got {confidence}")
    refuse_existing(out, force=force)
    with worker_pool(workers or default_workers()) as executor:
        flights = gather_evidence(_log_paths(logs), executor=executor)
    library = identify_library(flights, name=name or out.stem, confidence=confidence)
    publish_library(library, out, force=force)
    sys.stdout.write(library_text(library) if json else report(library, out))
    return 0


def publish_library(library: Library, path: Path, *, force: bool) -> None:
    """Writes a library and its data sheet, each whole or not at all."""
    publish_bytes(library_text(library).encode(), path, force=force)
    publish_bytes(data_sheet(library).encode(), path.with_suffix(".md"), force=force)


def report(library: Library, path: Path) -> str:
    """Returns what is said of a library that was just made."""
    statistics = [trim.statistics for trim in library.trims]
    statistics += [maneuver.statistics for maneuver in library.maneuvers]
    known = [entry for entry in statistics if entry is not None]
    samples = sorted({entry.samples for entry in known})
    return (
        f"{len(library.trims)} trims, {len(library.maneuvers)} maneuvers, "
        f"{'-'.join(map(str, dict.fromkeys((samples[0], samples[-1]))))} flights each, "
        f"{sum(entry.timeouts for entry in known)} time-outs\n"
        f"library    {path}\n"
        f"data sheet {path.with_suffix('.md')}\n"
        f"sha256     {library_hash(library)}\n"
    )


def _log_paths(logs: list[Path]) -> list[Path]:
    paths = []
    for path in logs:
        found = sorted(path.glob("*.mcap")) if path.is_dir() else [path]
        if not found:
            raise FlightError(f"{path}: expected a folder of *.mcap logs, got none")
        paths.extend(found)
    if not paths:
        raise FlightError("expected flight logs or folders of them, got none")
    return paths
