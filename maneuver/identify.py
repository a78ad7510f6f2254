"""`maneuver identify`: logs in, library out."""

import sys
from collections.abc import Iterable
from math import inf
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from flight.errors import FlightError
from flight.library import Library
from flight.library_file import library_hash, library_text
from flight.publishing import file_target, publish_again, remove_partials
from flight.words import counted
from identification.data_sheet import data_sheet
from identification.identify import StateJudged, TrimErrors
from identification.identify import identify as identify_library
from identification.steady_levels import Resolution

from .claims import CLAIMS_LESS, split_by_kind, weaker_claims
from .evidence import gather_evidence, gather_motion_evidence, has_commands
from .files import find_library, refuse_files
from .numbers import Count
from .workers import default_workers, worker_pool


def identify(
    logs: Annotated[list[Path], Parameter(negative="")],
    /,
    *,
    out: Path,
    name: str | None = None,
    by: Literal["commands", "motion"] | None = None,
    trims: str | None = None,
    resolution: tuple[float, float, float] | None = None,
    nominal: Annotated[list[Path] | None, Parameter(consume_multiple=True, negative="")] = None,
    coverage: float | None = None,
    confidence: float = 0.95,
    of: StateJudged = "truth",
    trim_errors: TrimErrors = "instantaneous",
    workers: Count | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Identifies a motion-primitive library from flight logs, and from nothing else.

    A maneuver is entered when the command changes, or, in logs without commands, where the motion shows it;
    it ends by the rule that the logs carry. The value of a maneuver is its mean over the nominal flights
    (those flown as such, and --nominal), errors are the largest deviations over the others, signed by the
    convention; without nominal flights the same flights give both and the claim is weaker. Beside the library
    stands its data sheet, OUT with the ending .md. The exit code is 1 where a primitive claims less than
    --coverage.

    Logs of another vehicle need `/truth`, `/estimate` or `/motion` at 20 Hz or more and nothing else. Which
    trims they hold, and when a maneuver has ended, is then found in them too, unless TRIMS says it.

    For example:

        maneuver identify flights/ --out mine.json

        maneuver identify flights/gtmax-0000.mcap flights/gtmax-0001.mcap --out mine.json

        maneuver identify flights/ --by motion --out from-motion.json

        maneuver identify later/ --nominal earlier/ --coverage 0.95 --out mine.json

    Args:
        logs: flight logs, or folders of them.
        out: where the library goes.
        name: of the library; OUT's by default.
        by: what shows where maneuvers begin; the commands by default, in logs that have them.
        trims: library that names the trims, the maneuvers and the rule for their ends, for logs that carry
            none; its other numbers are not used.
        resolution: least difference between two trims where they are to be found: m/s forward, m/s to the
            side, rad/s; 6 % of each one's range by default, at least 0.2 m/s and 0.02 rad/s.
        nominal: more logs, or folders of them, that give the values of maneuvers and no bounds.
        coverage: share of future flights that every primitive must claim to hold, all its numbers at once.
        confidence: with which the coverage is claimed.
        of: whose deviations: those of the true motion, or of what the vehicle believed.
        trim_errors: largest deviation of a trim at any instant, or averaged over a coast.
        workers: processes that read logs; one for each processor by default.
        force: overwrite OUT.
        json: print the library as JSON.
    """
    if not 0 < confidence < 1:
        raise FlightError(f"--confidence must be between 0 and 1, got {confidence}")
    paths, apart = log_paths(logs), log_paths(nominal) if nominal else []
    refuse_library(out, force=force, inputs=[*paths, *apart])
    if by == "commands" and (trims or resolution):
        raise FlightError("--trims and --resolution are for --by motion; with commands the logs say both")
    by_motion = by == "motion" or (by is None and (bool(trims) or not has_commands(paths[0])))
    if by_motion and of == "estimate":
        raise FlightError("--of estimate is for logs with commands; --by motion judges the truth where it is")
    named = find_library(trims) if trims else None
    least = _resolution(resolution) if resolution else None
    with worker_pool(workers or default_workers()) as executor:
        flights = (
            gather_motion_evidence([*paths, *apart], executor=executor, trims=named, resolution=least)
            if by_motion
            else gather_evidence([*paths, *apart], executor=executor, of=of)
        )
    bounding, centring = split_by_kind(flights[: len(paths)])
    library = identify_library(
        bounding,
        name=name or out.stem,
        nominal=[*centring, *flights[len(paths) :]],
        confidence=confidence,
        trim_errors=trim_errors,
    )
    weak = weaker_claims(library, coverage)
    publish_library(library, out, force=force)
    sys.stdout.write(library_text(library) if json else report(library, out))
    for line in weak:
        print(line, file=sys.stderr)
    return CLAIMS_LESS if weak else 0


def refuse_library(path: Path, *, force: bool, inputs: Iterable[Path] = ()) -> None:
    """Refuses, before any work is done, a library that could not be written with its data sheet.

    Raises:
        FlightError: as `refuse_files`.
    """
    # A path without a name has no sheet beside it either.
    file_target(path, force=force)
    refuse_files(path, path.with_suffix(".md"), force=force, inputs=inputs)


def publish_library(library: Library, path: Path, *, force: bool) -> None:
    """Writes a library and its data sheet, each whole or not at all."""
    sheet = path.with_suffix(".md")
    for target, text in ((path, library_text(library)), (sheet, data_sheet(library))):
        remove_partials(target.parent, of=target.name)
        publish_again(text.encode(), target, force=force)


def report(library: Library, path: Path) -> str:
    """Returns what is said of a library that was just made."""
    statistics = [trim.statistics for trim in library.trims]
    statistics += [maneuver.statistics for maneuver in library.maneuvers]
    known = [entry for entry in statistics if entry is not None]
    samples = sorted({entry.samples for entry in known})
    least, most = samples[0], samples[-1]
    flights = counted(least, "flight") if least == most else f"{least}-{most} flights"
    return (
        f"{counted(len(library.trims), 'trim')}, {counted(len(library.maneuvers), 'maneuver')}, "
        f"{flights} each, {counted(sum(entry.timeouts for entry in known), 'time-out')}\n"
        f"claim      {min(entry.coverage for entry in known):.1%} of future flights inside all bounds of a "
        f"primitive at once, with {known[0].confidence:.0%} confidence\n"
        f"library    {path}\n"
        f"data sheet {path.with_suffix('.md')}\n"
        f"sha256     {library_hash(library)}\n"
    )


def log_paths(logs: list[Path]) -> list[Path]:
    """Returns the logs named, and those in the folders named.

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


def _resolution(numbers: tuple[float, float, float]) -> Resolution:
    if not all(0 < number < inf for number in numbers):
        raise FlightError(f"--resolution must be three numbers > 0, got {numbers}")
    return Resolution(*numbers)
