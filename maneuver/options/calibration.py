"""Option of the file of time bounds, `--calibrate`."""

import sys
from collections.abc import Sequence
from pathlib import Path

from experiments.mission.result import MissionResult
from experiments.validation.time_bound_trial import find_time_bounds
from flight.automaton.library import Library
from flight.automaton.library_file import library_hash
from flight.errors import FlightError
from flight.plan.time_bound import time_bounds_text
from runtime.atomic_write import write_atomically

BOUND_SHARE = 0.9
"""Share of flights that finish within a calibrated time."""


def check_calibration(path: Path | None, suite: str, plant: str, *, plain: bool) -> None:
    """Checks that the flights can give time bounds.

    Args:
        path: file of time bounds, if any.
        suite: of the missions.
        plant: of the flights.
        plain: True for the default closed loop.

    Raises:
        FlightError: they cannot.
    """
    if path is None:
        return
    if (suite, plant) != ("random", "helicopter"):
        raise FlightError(f"--calibrate: expected --suite random and the helicopter, got {suite} and {plant}")
    if not plain:
        raise FlightError("--calibrate: expected default closed-loop settings, got others")


def write_time_bounds(
    path: Path | None,
    results: Sequence[MissionResult],
    library: Library,
    *,
    seed: int,
    command: str,
    force: bool,
) -> None:
    """Writes the time bounds of flights, or warns that there are none.

    Args:
        path: file of time bounds, if any.
        results: the flights.
        library: of their plans.
        seed: of the missions.
        command: command line of the flights.
        force: overwrite the file.
    """
    if path is None:
        return
    made, lacking = find_time_bounds(results, share=BOUND_SHARE, seed=seed)
    for policy in lacking:
        print(f"{policy}: too few successful flights for a time bound", file=sys.stderr)
    if not made:
        print(f"{path} is not written: no policy has a time bound", file=sys.stderr)
        return
    text = time_bounds_text(made, library_hash=library_hash(library), command=command)
    write_atomically(text.encode(), path, force=force)
