"""`maneuver replay`: logged flights flown again, compared byte by byte."""

import json as json_module
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from experiments.campaign.evidence import log_paths
from experiments.mission.repeat import repeat_flight
from flight.errors import FlightError
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes
from flightlog.identity.log_diff import count_differing_bytes, differences
from flightlog.log import FlightLog
from runtime.atomic_write import check_output_files, write_atomically
from runtime.code_version import code_version
from runtime.progress import show_progress

DIFFERENT = 1
# Differences that are printed of one flight.
_PRINTED = 5


@dataclass(frozen=True, slots=True)
class ReplayComparison:
    """A flight beside its repetition.

    Attributes:
        log: path of the flight's log.
        size: of that file, in bytes.
        differing: bytes in which the repetition's log differs; the name of the code is no part of that.
        differences: in words.
        code: version of the program and code that flew.
        code_here: the same of the repetition.
    """

    log: str
    size: int
    differing: int
    differences: tuple[str, ...]
    code: str
    code_here: str


def replay(
    logs: Annotated[list[Path], Parameter(negative="")],
    /,
    *,
    out: Path | None = None,
    force: Annotated[bool, Parameter(negative="")] = False,
    json: Annotated[bool, Parameter(negative="")] = False,
) -> int:
    """Flies logged flights again from their logs and compares the bytes.

    A log holds all inputs of its flight: specification with seed and faults, library, vehicle, mission,
    planner, and measured planning times, if any. The numeric back-end named in the log is required. The exit
    code is 0 if no byte differs. Equal bytes are not guaranteed on another processor family or with other
    package versions.

    For example:

        maneuver replay flight.mcap

        maneuver replay flights/ --json

    Args:
        logs: flight logs, or folders of them.
        out: log of the repeated flight, for a single log; none by default.
        force: overwrite OUT.
        json: print the comparisons as JSON.
    """
    paths = log_paths(logs)
    if out is not None:
        if len(paths) != 1:
            raise FlightError(f"--out: expected one log, got {len(paths)}")
        check_output_files(out, force=force, inputs=paths)
    compared = [
        _compare(path, out, force=force)
        for path in show_progress(paths, total=len(paths), what="flying again")
    ]
    if json:
        print(json_module.dumps([asdict(one) for one in compared]))
    else:
        for one in compared:
            _print_comparison(one)
    return DIFFERENT if any(one.differing for one in compared) else 0


def _compare(path: Path, out: Path | None, *, force: bool) -> ReplayComparison:
    log = read_log(path)
    try:
        repeated = repeat_flight(log)
    except FlightError as error:
        raise FlightError(f"{path}: {error}") from None
    # The code version identifies the program, not the flight.
    named: FlightLog = replace(
        repeated, header=replace(repeated.header, code_version=log.header.code_version)
    )
    content, original = log_bytes(named), path.read_bytes()
    if out is not None:
        write_atomically(log_bytes(repeated), out, force=force)
    return ReplayComparison(
        log=str(path),
        size=len(original),
        differing=count_differing_bytes(original, content),
        differences=differences(log, named),
        code=log.header.code_version,
        code_here=code_version(),
    )


def _print_comparison(one: ReplayComparison) -> None:
    print(f"{one.log}: {one.differing} of {one.size} bytes differ")
    for words in one.differences[:_PRINTED]:
        print(f"  {words}")
    if len(one.differences) > _PRINTED:
        print(f"  and {len(one.differences) - _PRINTED} more")
    if one.code != one.code_here:
        print(f"  flown with code {one.code}, repeated with {one.code_here}")
