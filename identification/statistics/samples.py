"""Samples of one primitive: one sample per flight."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError
from identification.segmentation.flight_evidence import FlightEvidence
from identification.segmentation.segmentation import CoastSegment, ManeuverSegment, SegmentEnd

TRIM_SCALARS = ("forward", "side", "yaw_rate")
MANEUVER_SCALARS = ("duration", "forward", "side", "heading_change")

Hull = tuple[Float[np.ndarray, "scalars"], Float[np.ndarray, "scalars"]]
"""Lowest and highest values."""


class NeverFlownError(FlightError):
    """No log has a primitive of the automaton."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """Samples of one primitive.

    Attributes:
        low: lowest value of each scalar, a row per flight with the primitive.
        high: highest value of each scalar.
        rows: values for mean and standard deviation.
        discarded: seeds of flights outside the bounds: lost, or the primitive timed out.
        timeouts: performances that ended by time-out.
        cut: performances cut by the next command or the log's end, which have no values.
    """

    low: Float[np.ndarray, "n scalars"]
    high: Float[np.ndarray, "n scalars"]
    rows: Float[np.ndarray, "m scalars"]
    discarded: tuple[int, ...] = ()
    timeouts: int = 0
    cut: int = 0

    @property
    def count(self) -> int:
        """Number of samples, the discarded ones included."""
        return len(self.low) + len(self.discarded)

    def require(self, what: str) -> "Samples":
        """Returns these samples, after a check that there are some.

        Raises:
            NeverFlownError: no flight has the primitive.
        """
        if not len(self.low):
            raise NeverFlownError(
                f"expected {what} in at least one log, got none: command it, fly longer, or change "
                "--trims or --resolution"
            )
        return self


def coasts_of(flight: FlightEvidence, trim: int) -> list[CoastSegment]:
    """Returns a flight's coasts in a trim."""
    return [coast for coast in flight.segments.coasts if coast.trim == trim]


def performances_of(flight: FlightEvidence, maneuver: int) -> list[ManeuverSegment]:
    """Returns a flight's performances of a maneuver, whatever its end."""
    return [segment for segment in flight.segments.maneuvers if segment.id == maneuver]


def trim_samples(
    flights: Sequence[FlightEvidence], trim: int, *, hull: Callable[[list[CoastSegment]], Hull | None]
) -> Samples:
    """Returns the samples of a trim.

    A flight without the trim is no sample; lost flights are discarded samples, and so are flights in which
    all maneuvers to the trim timed out.

    Args:
        flights: one per log.
        trim: id of the trim.
        hull: function for the lowest and highest velocity of a flight's coasts; None for too short coasts.
    """
    hulls, rows, discarded = [], [], []
    for flight in flights:
        coasts = coasts_of(flight, trim)
        found = hull(coasts) if coasts else None
        if flight.lost or (not coasts and trim in flight.never_reached):
            discarded.append(flight.header.seed)
        elif found is not None:
            hulls.append(found)
            rows.append(np.concatenate([coast.velocity for coast in coasts]).mean(axis=0, keepdims=True))
    return _samples(hulls, rows, discarded, 0, len(TRIM_SCALARS))


def maneuver_samples(flights: Sequence[FlightEvidence], maneuver: int) -> Samples:
    """Returns the samples of a maneuver: extremes of each flight.

    A flight with a time-out is a discarded sample; so is a lost flight. A flight in which the maneuver was
    not flown, or always cut, is no sample.
    """
    hulls, rows, discarded, timeouts, cut = [], [], [], 0, 0
    for flight in flights:
        performed = performances_of(flight, maneuver)
        settled = [segment for segment in performed if segment.settled]
        late = sum(segment.end is SegmentEnd.TIMED_OUT for segment in performed)
        timeouts += late
        cut += len(performed) - len(settled) - late
        if flight.lost or late:
            discarded.append(flight.header.seed)
        elif settled:
            values = np.array([maneuver_row(segment) for segment in settled])
            hulls.append((values.min(axis=0), values.max(axis=0)))
            rows.append(values)
    samples = _samples(hulls, rows, discarded, timeouts, len(MANEUVER_SCALARS))
    return replace(samples, cut=cut)


def maneuver_row(segment: ManeuverSegment) -> tuple[float, float, float, float]:
    """Returns a performance's values in the order of `MANEUVER_SCALARS`."""
    displacement = segment.displacement
    return segment.duration, displacement.x, displacement.y, displacement.heading


def _samples(
    hulls: list[Hull],
    rows: list[Float[np.ndarray, "_ scalars"]],
    discarded: list[int],
    timeouts: int,
    scalars: int,
) -> Samples:
    low = np.array([low for low, _ in hulls]).reshape(-1, scalars)
    high = np.array([high for _, high in hulls]).reshape(-1, scalars)
    together = np.concatenate(rows) if rows else np.empty((0, scalars))
    return Samples(low, high, together, tuple(discarded), timeouts)
