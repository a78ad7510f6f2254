"""Planning latency: seconds, measured, or from a recorded flight."""

from pathlib import Path

from experiments.mission.mission_log import recorded_latency
from flight.errors import FlightError
from flightlog.file.reader import read_log
from planner.closed_loop.latency import Latency

MEASURED = "measured"


def latency_of(text: str) -> Latency:
    """Returns the planning latency of an option's text.

    Args:
        text: seconds, `measured`, or the path of a flight log, whose latencies are repeated.

    Raises:
        FlightError: it is none of these, or the log has no latencies.
    """
    if text == MEASURED:
        return Latency(measured=True)
    path = Path(text)
    if path.suffix == ".mcap":
        return recorded_latency(read_log(path), source=text)
    try:
        return Latency(float(text))
    except ValueError as error:
        problem = str(error) if str(error).startswith("latency") else f"got {text!r}"
        raise FlightError(
            f"--latency: expected seconds, {MEASURED!r} or a flight log (.mcap): {problem}"
        ) from None
