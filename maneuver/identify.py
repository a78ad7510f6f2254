"""`maneuver identify`: logs in, library out."""

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
from maneuver.library.publish import check_library_target, library_report, publish_library
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
    check_library_target(out, force=force, inputs=[*paths, *apart])
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
    sys.stdout.write(library_text(library) if json else library_report(library, out))
    for line in weak:
        print(line, file=sys.stderr)
    return COVERAGE_TOO_LOW if weak else 0


def _resolution(numbers: tuple[float, float, float]) -> Resolution:
    if not all(0 < number < inf for number in numbers):
        raise FlightError(f"--resolution must be three numbers > 0, got {numbers}")
    return Resolution(*numbers)
