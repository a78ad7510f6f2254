"""`maneuver identify`: library from flight logs."""

import sys
from math import inf
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from experiments.campaign.coverage_report import COVERAGE_TOO_LOW, split_by_kind, weaker_claims
from experiments.campaign.evidence import gather_evidence, gather_motion_evidence, has_commands, log_paths
from flight.automaton.library_file import library_text
from flight.errors import FlightError
from identification.identify import TrimErrors
from identification.identify import identify as identify_library
from identification.segmentation.flight_evidence import StateJudged
from identification.segmentation.trim_discovery import Resolution
from maneuver.library.library_files import check_library_target, library_report, write_library_files
from maneuver.options.numbers import Count
from runtime.executor import default_workers, worker_pool
from scenarios.find import find_library


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
    """Identifies a motion-primitive library from flight logs alone.

    A maneuver starts when the command changes, or, in logs without commands, where the motion shows a
    change. It ends by the maneuver-end rule in the logs. A maneuver's value is its mean over the nominal
    flights (logs marked as nominal, and --nominal). Its errors are the largest deviations in the other
    flights, signed by the sign convention. Without nominal flights, the same flights give values and errors,
    and the coverage claim is weaker. The data sheet is written beside the library, with the ending .md. The
    exit code is 1 if a primitive's claim is below --coverage.

    Logs of another vehicle need only `/truth`, `/estimate` or `/motion` at 20 Hz or more. Their trims and
    maneuver ends are then discovered from the motion, unless --trims names a library with both.

    For example:

        maneuver identify flights/ --out mine.json

        maneuver identify flights/gtmax-0000.mcap flights/gtmax-0001.mcap --out mine.json

        maneuver identify flights/ --by motion --out from-motion.json

        maneuver identify later/ --nominal earlier/ --coverage 0.95 --out mine.json

    Args:
        logs: flight logs, or folders of them.
        out: library file to write.
        name: name of the library; OUT's by default.
        by: source of the maneuvers' starts; the commands by default, in logs that have them.
        trims: library with trims, maneuvers and maneuver-end rule, for logs without them; its other numbers
            are not used.
        resolution: smallest difference between two discovered trims: forward in m/s, side in m/s, yaw rate in
            rad/s; 6 % of each range by default, at least 0.2 m/s and 0.02 rad/s.
        nominal: more logs, or folders of them, for the values of maneuvers only, not for bounds.
        coverage: required share of future flights inside all bounds of a primitive at once.
        confidence: confidence of the coverage.
        of: motion whose deviations are bounded: the truth or the vehicle's estimate.
        trim_errors: largest deviation of a trim at any instant, or averaged over a coast.
        workers: number of processes that read logs; one per processor by default.
        force: overwrite OUT.
        json: print the library as JSON.
    """
    if not 0 < confidence < 1:
        raise FlightError(f"--confidence must be between 0 and 1, got {confidence}")
    paths, nominal_paths = log_paths(logs), log_paths(nominal) if nominal else []
    check_library_target(out, force=force, inputs=[*paths, *nominal_paths])
    if by == "commands" and (trims or resolution):
        raise FlightError("--trims and --resolution: expected --by motion, got --by commands")
    by_motion = by == "motion" or (by is None and (bool(trims) or not has_commands(paths[0])))
    if by_motion and of == "estimate":
        raise FlightError("--of estimate: expected logs with commands and --by commands, got --by motion")
    named = find_library(trims) if trims else None
    least = _resolution(resolution) if resolution else None
    with worker_pool(workers or default_workers()) as executor:
        flights = (
            gather_motion_evidence([*paths, *nominal_paths], executor=executor, trims=named, resolution=least)
            if by_motion
            else gather_evidence([*paths, *nominal_paths], executor=executor, of=of)
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
    write_library_files(library, out, force=force)
    sys.stdout.write(library_text(library) if json else library_report(library, out))
    for line in weak:
        print(line, file=sys.stderr)
    return COVERAGE_TOO_LOW if weak else 0


def _resolution(numbers: tuple[float, float, float]) -> Resolution:
    if not all(0 < number < inf for number in numbers):
        raise FlightError(f"--resolution must be three numbers > 0, got {numbers}")
    return Resolution(*numbers)
