"""Evidence from logs: reading and segmentation, independent of the simulator."""

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from itertools import repeat
from pathlib import Path

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.errors import FlightError
from flightlog.attachment_names import LIBRARY_ATTACHMENT
from flightlog.file.reader import read_log
from flightlog.identity.fingerprint import rounded_fingerprint
from flightlog.motion.continuity import continuous_parts
from flightlog.topics import PRIMITIVE
from identification.segmentation.flight_evidence import (
    FlightEvidence,
    StateJudged,
    extract_evidence,
    judged_motion_name,
)
from identification.segmentation.motion_model import sampled_motion
from identification.segmentation.motion_walk import walks_of
from identification.segmentation.segmentation import ObservedWalk, cut_into_segments
from identification.segmentation.trim_discovery import Resolution, discover_automaton
from runtime.progress import show_progress


class NoManeuversError(FlightError):
    """No discovered maneuver was flown to its end."""


def gather_evidence(
    paths: Sequence[Path], *, executor: Executor, of: StateJudged = "truth"
) -> list[FlightEvidence]:
    """Reads and segments logs.

    Raises:
        FlightError: a log is broken or lacks something.
    """
    segmented = executor.map(partial(evidence_of, of=of), paths)
    return list(show_progress(segmented, total=len(paths), what="identifying"))


def gather_motion_evidence(
    paths: Sequence[Path],
    *,
    executor: Executor,
    trims: Library | None = None,
    resolution: Resolution | None = None,
) -> list[FlightEvidence]:
    """Reads logs and segments them by their motion alone.

    Args:
        paths: the log files.
        executor: executor that reads them.
        trims: automaton and maneuver-end rule; where None, those of the logs, or else those discovered in the
            motion.
        resolution: least difference between two discovered trims.

    Raises:
        FlightError: a log is broken or lacks something.
    """
    read = list(show_progress(executor.map(_motions_of, paths), total=len(paths), what="reading"))
    records = [record for part in read for record in part]
    motions = [record.motion for record in records]
    library = trims or records[0].library
    discovered = library is None
    if library is None:
        library = discover_automaton(motions, vehicle=records[0].vehicle, resolution=resolution)
    walks = walks_of(motions, library)
    parts = [record.part for record in records]
    cut = [path for path, part in zip(paths, read, strict=True) for _ in part]
    cutting = executor.map(_motion_evidence_of, cut, parts, walks, repeat(library))
    flights = list(show_progress(cutting, total=len(cut), what="identifying"))
    return _drop_unobserved_trims(flights, library) if discovered else flights


def has_commands(path: Path) -> bool:
    """Returns True if a log has the commanded primitives of a library."""
    log = read_log(path)
    return PRIMITIVE.name in log.series and LIBRARY_ATTACHMENT in log.attachments


@dataclass(frozen=True, slots=True, eq=False)
class MotionRecord:
    """Motion of a log's part without holes, with its vehicle and library."""

    part: int
    vehicle: str
    library: Library | None
    motion: Float[np.ndarray, "n 3"]


def _motions_of(path: Path) -> list[MotionRecord]:
    """Returns the motions of a log's parts that are long enough.

    Raises:
        FlightError: none is long enough.
    """
    log = read_log(path)
    library = log.library() if LIBRARY_ATTACHMENT in log.attachments else None
    found: list[MotionRecord] = []
    refusal: FlightError | None = None
    for place, part in enumerate(continuous_parts(log)):
        try:
            found.append(MotionRecord(place, log.header.vehicle, library, sampled_motion(part)))
        except FlightError as error:
            refusal = refusal or error
    if not found:
        raise FlightError(f"{path}: {refusal}") from None
    return found


def _motion_evidence_of(path: Path, place: int, walk: ObservedWalk, library: Library) -> FlightEvidence:
    log = continuous_parts(read_log(path))[place]
    return FlightEvidence(
        str(path),
        rounded_fingerprint(log),
        log.header,
        library,
        cut_into_segments(log, walk, library),
        log.duration,
        found_by="motion",
        judged=judged_motion_name(log),
    )


def _drop_unobserved_trims(flights: list[FlightEvidence], library: Library) -> list[FlightEvidence]:
    """Drops discovered trims without a coast, and maneuvers without an end."""
    held = {coast.trim for flight in flights for coast in flight.segments.coasts}
    rule = library.conditions.maneuver_end
    ended = {part.id for flight in flights for part in flight.segments.maneuvers if part.settled}
    maneuvers = tuple(
        row for row in library.maneuvers if {row.from_trim, row.to_trim} <= held and row.id in ended
    )
    if rule is None or not maneuvers:
        raise NoManeuversError(
            f"expected a maneuver between two held trims, flown to its end, got none with {len(held)} of "
            f"{len(library.trims)} trims held for {rule.dwell if rule else 0.0:g} s: change --resolution, "
            "give --trims, or longer flights with steps between trims"
        )
    bands = {trim: band for trim, band in rule.bands.items() if trim in held}
    kept = replace(
        library,
        trims=tuple(trim for trim in library.trims if trim.id in held),
        maneuvers=maneuvers,
        conditions=replace(library.conditions, maneuver_end=replace(rule, bands=bands)),
    )
    return [replace(flight, library=kept, trims_commanded=False) for flight in flights]


def evidence_of(path: Path, of: StateJudged = "truth") -> FlightEvidence:
    """Reads and segments one log.

    Raises:
        FlightError: the log is broken or lacks something.
    """
    log = read_log(path)
    return extract_evidence(log, name=str(path), sha256=rounded_fingerprint(log), of=of)


def log_paths(logs: list[Path]) -> list[Path]:
    """Returns the given logs and those in the given folders.

    Raises:
        FlightError: there are none.
    """
    paths = []
    for path in logs:
        found = sorted(path.glob("*.mcap")) if path.is_dir() else [path]
        if not found:
            raise FlightError(f"{path}: expected a folder of *.mcap logs, got none")
        paths.extend(found)
    if not paths:
        raise FlightError("expected flight logs or folders of them, got none")
    return paths
