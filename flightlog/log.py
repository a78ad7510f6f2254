"""Flight log: commanded, estimated and true motion on one time axis.

`flightlog.topics` defines the topics: fields, units and frames. Channels for viewers are derived from them
by `flightlog.viewers.viewer_channels` and never read back. World axes are north, east, down. Velocities are
given in the heading frame, the level body frame: forward along the heading, side to the right, down. Angles
are clockwise seen along the axis; headings are not wrapped. Times are seconds since the flight's start.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from flight.automaton.library import Library
from flight.automaton.library_file import parse_library
from flight.errors import FlightError

from .attachment_names import LIBRARY_ATTACHMENT
from .header import FlightHeader
from .series import Series, Topic
from .topics import ESTIMATE, MOTION, TRUTH


class MissingTopicError(FlightError):
    """Missing topic of a log."""

    def __init__(self, topic: Topic, present: Mapping[str, object]) -> None:
        super().__init__(f"the log has no {topic.name}; it has {sorted(present)}")


@dataclass(frozen=True, slots=True, eq=False)
class FlightLog:
    """One flight: header, series by topic, attachments by file name."""

    header: FlightHeader
    series: Mapping[str, Series]
    attachments: Mapping[str, bytes]

    def __getitem__(self, topic: Topic) -> Series:
        """Returns the series of a topic.

        Raises:
            MissingTopicError: the log lacks the topic.
        """
        try:
            return self.series[topic.name]
        except KeyError:
            raise MissingTopicError(topic, self.series) from None

    @property
    def motion(self) -> Series:
        """True motion if logged, else the estimate, else planar motion."""
        known = (topic for topic in (TRUTH, ESTIMATE, MOTION) if topic.name in self.series)
        return self[next(known, TRUTH)]

    @property
    def duration(self) -> float:
        """Time from the start to the last state, seconds."""
        return float(self.motion.time[-1])

    def library(self) -> Library:
        """Returns the library flown with.

        Raises:
            FlightError: the library is missing or invalid.
        """
        try:
            text = self.attachments[LIBRARY_ATTACHMENT]
        except KeyError:
            raise FlightError(
                f"the log has no {LIBRARY_ATTACHMENT}; it has {sorted(self.attachments)}"
            ) from None
        return parse_library(text, LIBRARY_ATTACHMENT)
