"""What identification keeps of one log."""

from dataclasses import dataclass, replace
from typing import Literal

from flight.errors import FlightError
from flight.library import Library
from flight.log import ESTIMATE, TRUTH, FlightHeader, FlightLog, Series

from .segmentation import Segments, segment

NOMINAL = "nominal"
"""Kind, in the log's header, of the flights that give a maneuver's values and not its bounds."""

COMPLETED = "completed"

StateJudged = Literal["truth", "estimate"]
"""Whose deviations are taken: those of what was so, or of what the vehicle believed."""


@dataclass(frozen=True, slots=True)
class FlightEvidence:
    """What identification keeps of one log.

    Attributes:
        name: what to call the log in an error.
        sha256: of the log's bytes, as hexadecimal digits.
        header: the log's header.
        library: the library flown with.
        segments: its primitives.
        duration: of the flight, seconds.
        of: whose motion was cut into primitives.
        found_by: what showed where they begin: the `command change`, or the `motion`.
    """

    name: str
    sha256: str
    header: FlightHeader
    library: Library
    segments: Segments
    duration: float = 0.0
    of: StateJudged = "truth"
    found_by: str = "command change"

    @property
    def lost(self) -> bool:
        """Whether the flight ended before its time."""
        return self.header.outcome != COMPLETED

    @property
    def never_reached(self) -> frozenset[int]:
        """Ids of trims that a maneuver led to without settling there."""
        unsettled = {segment.id for segment in self.segments.maneuvers if not segment.settled}
        return frozenset(row.to_trim for row in self.library.maneuvers if row.id in unsettled)


def evidence(log: FlightLog, *, name: str, sha256: str, of: StateJudged = "truth") -> FlightEvidence:
    """Returns what identification keeps of a log.

    Raises:
        FlightError: the log lacks something; its text begins with the log's name.
    """
    of = state_judged(log, of)
    try:
        judged = believed(log) if of == "estimate" else log
        return FlightEvidence(name, sha256, log.header, log.library(), segment(judged), log.duration, of)
    except FlightError as error:
        raise FlightError(f"{name}: {error}") from None


def state_judged(log: FlightLog, of: StateJudged = "truth") -> StateJudged:
    """Returns whose deviations can be taken of a log: the vehicle's belief where it knows no truth."""
    return of if log.motion.topic is TRUTH else "estimate"


def believed(log: FlightLog) -> FlightLog:
    """Returns the log as the vehicle would tell it: the estimate stands where the truth stood.

    Raises:
        MissingTopicError: the log has no estimate.
    """
    estimate = log[ESTIMATE]
    told = Series(TRUTH, estimate.time, estimate.values)
    return replace(log, series={**log.series, TRUTH.name: told})
