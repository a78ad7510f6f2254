"""The flight log: what was commanded, believed and true, on one time axis.

This module is the contract of the channels that programs read: topics, fields, units, frames; those that
viewers draw are made from them by `flightlog.viewers.viewer_channels`, and never read back. World axes are
north,
east,
down. Velocities are given in the heading frame, the level body frame: forward along the heading, side to the
right, down. Angles are clockwise seen along the axis; headings are not wrapped. Times are seconds since the
flight's start.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from flight.automaton.library import Library
from flight.automaton.library_file import parse_library
from flight.errors import FlightError

from .attachment_names import LIBRARY_ATTACHMENT
from .channels import ESTIMATE, MOTION, TRUTH
from .header import FlightHeader
from .topic import Series, Topic


class MissingTopicError(FlightError):
    """A log lacks a topic that is needed; absent is not zero."""

    def __init__(self, topic: Topic, present: Mapping[str, object]) -> None:
        super().__init__(f"the log has no {topic.name}; it has {sorted(present)}")


@dataclass(frozen=True, slots=True, eq=False)
class FlightLog:
    """One flight: header, series by topic name, attachments by file name."""

    header: FlightHeader
    series: Mapping[str, Series]
    attachments: Mapping[str, bytes]

    def __getitem__(self, topic: Topic) -> Series:
        """Returns the series of a topic.

        Raises:
            MissingTopicError: the log has none.
        """
        try:
            return self.series[topic.name]
        except KeyError:
            raise MissingTopicError(topic, self.series) from None

    @property
    def motion(self) -> Series:
        """The true motion; where it is not known, what was believed of it, or what else there is."""
        known = (topic for topic in (TRUTH, ESTIMATE, MOTION) if topic.name in self.series)
        return self[next(known, TRUTH)]

    @property
    def duration(self) -> float:
        """Seconds from the start to the last state."""
        return float(self.motion.time[-1])

    def library(self) -> Library:
        """Returns the library flown with.

        Raises:
            FlightError: the log carries none, or a broken one.
        """
        try:
            text = self.attachments[LIBRARY_ATTACHMENT]
        except KeyError:
            raise FlightError(
                f"the log has no {LIBRARY_ATTACHMENT}; it has {sorted(self.attachments)}"
            ) from None
        return parse_library(text, LIBRARY_ATTACHMENT)
