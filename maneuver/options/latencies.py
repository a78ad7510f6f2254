"""Planning latency: seconds, measured, or those of a recorded flight."""

from pathlib import Path

from experiments.mission.recorded_latency import recorded_latency
from flight.errors import FlightError
from flightlog.file.reader import read_log
from planner.closed_loop.latency import Latency

MEASURED = "measured"


def latency_of(text: str) -> Latency:
    """Returns what is charged for each planning.

    Args:
        text: seconds, `measured`, or the path of a flight log, whose latencies are charged again.

    Raises:
        FlightError: it is none of these, or the log says nothing of latencies.
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
            f"--latency: expected seconds, {MEASURED!r} or the log of a flight to be repeated: {problem}"
        ) from None
