"""Samples of one primitive: one sample per flight."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError
from identification.segmentation.flight_evidence import FlightEvidence
from identification.segmentation.segmentation import CoastSegment, ManeuverSegment

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
        discarded: seeds of flights outside the bounds: lost, or the primitive did not settle.
        timeouts: performances that did not settle.
    """

    low: Float[np.ndarray, "n scalars"]
    high: Float[np.ndarray, "n scalars"]
    rows: Float[np.ndarray, "m scalars"]
    discarded: tuple[int, ...] = ()
    timeouts: int = 0

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
            raise NeverFlownError(f"expected {what} in at least one log, got none")
        return self


def coasts_of(flight: FlightEvidence, trim: int) -> list[CoastSegment]:
    """Returns a flight's coasts in a trim."""
    return [coast for coast in flight.segments.coasts if coast.trim == trim]


def performances_of(flight: FlightEvidence, maneuver: int) -> list[ManeuverSegment]:
    """Returns a flight's performances of a maneuver, settled or not."""
    return [segment for segment in flight.segments.maneuvers if segment.id == maneuver]


def trim_samples(
    flights: Sequence[FlightEvidence], trim: int, *, hull: Callable[[list[CoastSegment]], Hull | None]
) -> Samples:
    """Returns the samples of a trim.

    A flight without the trim is no sample; lost flights are discarded samples, and so are flights in which no
    maneuver to the trim settled.

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

    A flight with an unsettled performance is a discarded sample; so is a lost flight. A flight without the
    maneuver is no sample.
    """
    hulls, rows, discarded, timeouts = [], [], [], 0
    for flight in flights:
        performed = performances_of(flight, maneuver)
        unsettled = sum(not segment.settled for segment in performed)
        timeouts += unsettled
        if flight.lost or unsettled:
            discarded.append(flight.header.seed)
        elif performed:
            values = np.array([maneuver_row(segment) for segment in performed])
            hulls.append((values.min(axis=0), values.max(axis=0)))
            rows.append(values)
    return _samples(hulls, rows, discarded, timeouts, len(MANEUVER_SCALARS))


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
