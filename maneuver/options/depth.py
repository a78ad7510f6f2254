"""Option for the longest sequence: `--max-trims`."""

from dataclasses import replace

from flight.errors import FlightError
from flight.mission.mission import MAX_TRIMS, Mission


def at_depth(mission: Mission, max_trims: int | None) -> Mission:
    """Returns the mission with the given longest sequence, if any.

    Raises:
        FlightError: it is longer than can be searched.
    """
    changed = mission if max_trims is None else replace(mission, max_trims=max_trims)
    if changed.max_trims > MAX_TRIMS:
        raise FlightError(f"--max-trims: expected at most {MAX_TRIMS}, got {changed.max_trims}")
    return changed
