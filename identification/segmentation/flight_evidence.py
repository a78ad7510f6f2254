"""What identification keeps of one log."""

from dataclasses import dataclass, replace
from typing import Literal

from flight.automaton.library import Library
from flight.errors import FlightError
from flightlog.channels import ESTIMATE, TRUTH
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.topic import Series

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
        sha256: of what the log holds (`flightlog.fingerprint`), as hexadecimal digits.
        header: the log's header.
        library: the library flown with.
        segments: its primitives.
        duration: of the flight, seconds.
        found_by: what showed where they begin: the `command change`, or the `motion`.
        judged: the motion that was judged: `true`, or `believed` where that was wanted or no truth is known.
        trims_commanded: whether the velocities of trims were fixed before the flights, not found in them.
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
        """Whether the flight ended before its time."""
        return self.header.outcome != COMPLETED

    @property
    def never_reached(self) -> frozenset[int]:
        """Ids of trims that a maneuver led to without settling there."""
        unsettled = {segment.id for segment in self.segments.maneuvers if not segment.settled}
        return frozenset(row.to_trim for row in self.library.maneuvers if row.id in unsettled)


def extract_evidence(log: FlightLog, *, name: str, sha256: str, of: StateJudged = "truth") -> FlightEvidence:
    """Returns what identification keeps of a log.

    Raises:
        FlightError: the log lacks something; its text begins with the log's name.
    """
    try:
        judged = estimate_as_truth(log) if of == "estimate" else log
        cut = segment(judged)
    except FlightError as error:
        raise FlightError(f"{name}: {error}") from None
    motion = "believed" if of == "estimate" else judged_motion_name(log)
    return FlightEvidence(name, sha256, log.header, log.library(), cut, log.duration, judged=motion)


def judged_motion_name(log: FlightLog) -> str:
    """Returns which motion of a log is judged: `true`, or `believed` where it has no truth."""
    return "true" if log.motion.topic.name == TRUTH.name else "believed"


def estimate_as_truth(log: FlightLog) -> FlightLog:
    """Returns the log as the vehicle would tell it: the estimate stands where the truth stood.

    Raises:
        MissingTopicError: the log has no estimate.
    """
    estimate = log[ESTIMATE]
    told = Series(TRUTH.only(estimate.topic.field_names), estimate.time, estimate.values)
    return replace(log, series={**log.series, TRUTH.name: told})
