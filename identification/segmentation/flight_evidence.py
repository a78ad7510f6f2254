"""Evidence of one log for identification."""

from dataclasses import dataclass, replace
from typing import Literal

from flight.automaton.library import Library
from flight.errors import FlightError
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ESTIMATE, TRUTH

from .segmentation import SegmentEnd, Segments, segment

NOMINAL = "nominal"
"""Kind, in the log's header, of flights that give values of maneuvers, not bounds."""

COMPLETED = "completed"

StateJudged = Literal["truth", "estimate"]
"""State whose deviations are taken: true or estimated."""


@dataclass(frozen=True, slots=True)
class FlightEvidence:
    """Evidence of one log for identification.

    Attributes:
        name: name of the log in errors.
        sha256: hash of the flight to six digits (`flightlog.identity.fingerprint`), as hexadecimal digits.
        header: the log's header.
        library: the library flown with.
        segments: its primitives.
        duration: duration of the flight, seconds.
        found_by: source of the primitives' beginnings: `command change` or `motion`.
        judged: motion whose deviations are taken: `true`, or `believed` for the estimate.
        trims_commanded: True if the velocities of trims were fixed before the flights, not found in them.
    """

    name: str
    sha256: str
    header: FlightHeader
    library: Library
    segments: Segments
    duration: float = 0.0
    found_by: str = "command change"
    judged: str = "true"
    trims_commanded: bool = True

    @property
    def lost(self) -> bool:
        """True if the flight did not complete."""
        return self.header.outcome != COMPLETED

    @property
    def never_reached(self) -> frozenset[int]:
        """Ids of trims with a timed-out maneuver to them."""
        late = {part.id for part in self.segments.maneuvers if part.end is SegmentEnd.TIMED_OUT}
        return frozenset(row.to_trim for row in self.library.maneuvers if row.id in late)


def extract_evidence(log: FlightLog, *, name: str, sha256: str, of: StateJudged = "truth") -> FlightEvidence:
    """Extracts the evidence of a log.

    Raises:
        FlightError: the log lacks something; the message begins with the log's name.
    """
    try:
        judged = estimate_as_truth(log) if of == "estimate" else log
        cut = segment(judged)
    except FlightError as error:
        raise FlightError(f"{name}: {error}") from None
    motion = "believed" if of == "estimate" else judged_motion_name(log)
    return FlightEvidence(name, sha256, log.header, log.library(), cut, log.duration, judged=motion)


def judged_motion_name(log: FlightLog) -> str:
    """Returns `true`, or `believed` for a log without truth."""
    return "true" if log.motion.topic.name == TRUTH.name else "believed"


def estimate_as_truth(log: FlightLog) -> FlightLog:
    """Returns the log with the estimate in place of the truth.

    Raises:
        MissingTopicError: the log has no estimate.
    """
    estimate = log[ESTIMATE]
    truth = Series(TRUTH.only(estimate.topic.field_names), estimate.time, estimate.values)
    return replace(log, series={**log.series, TRUTH.name: truth})
