"""Joint laws of a primitive's values over flights: means, covariances, samples, paths.

Row k of every primitive's deviations comes from the same flight, so that what a flight shares survives; where
a flight lacks a primitive, the next flight that has it stands in.
"""

from dataclasses import dataclass
from math import exp, sqrt
from typing import Annotated

from pydantic import Field, NonNegativeFloat, PositiveFloat

from flight.file_value import FileValue, Omittable, Share
from flight.se2 import Twist

MOST_DEVIATIONS = 64
"""Rows of joint deviations that a law keeps at most."""

PATH_INSTANTS = 9
"""Instants of a maneuver's path: at shares 0, 1/8 ... 1 of its duration."""

Row3 = tuple[float, float, float]
Row4 = tuple[float, float, float, float]
_Spread3 = tuple[NonNegativeFloat, NonNegativeFloat, NonNegativeFloat]


@dataclass(frozen=True, slots=True)
class PathInstant(FileValue):
    """One instant of a maneuver's path, in the body frame at entry.

    Attributes:
        mean: metres forward, metres to the right, radians of heading.
        standard_deviation: of each, over flights.
    """

    mean: Annotated[Row3, Field(description="metres forward, metres right, radians")]
    standard_deviation: _Spread3


@dataclass(frozen=True, slots=True)
class PreviousShift(FileValue):
    """Shift of a maneuver's values right after another maneuver.

    Attributes:
        maneuver: id of the maneuver before.
        shift: seconds, metres forward, metres to the right, radians.
    """

    maneuver: int
    shift: Row4


@dataclass(frozen=True, slots=True)
class EntryDependence(FileValue):
    """Dependence of a maneuver's values on how it was entered.

    The mean after a coast of t seconds is base + shift exp(-t / fade_time) + velocity (v - trim), with the
    body velocity v that the vehicle believes at entry and the commanded velocity of the trim left.

    Attributes:
        base: mean long after any maneuver, from the commanded velocity of the trim.
        previous: shifts by previous maneuver; one that is not listed shifts nothing.
        fade_time: seconds in which a shift falls to 1/e.
        velocity: what each value gains per m/s, m/s and rad/s of entry velocity.
        covariance: of the values about this mean.
        deviations: rows of joint deviations from this mean, of the same flights as the law's.
        bounds: largest absolute deviations from this mean; None where none were identified.
        coverage: share of future flights inside all bounds at once, at the confidence of the maneuver's
            statistics; 0 without a claim.
    """

    base: Row4
    previous: tuple[PreviousShift, ...]
    fade_time: Annotated[PositiveFloat, Field(description="seconds")]
    velocity: tuple[Row3, Row3, Row3, Row3]
    covariance: tuple[Row4, Row4, Row4, Row4]
    deviations: Annotated[tuple[Row4, ...], Field(max_length=MOST_DEVIATIONS)]
    bounds: Row4 | None = None
    coverage: Omittable[Share] = 0.0

    def mean_after(self, previous: int | None, coast: float, offset: Row3) -> Row4:
        """Returns the mean values for one way of entering.

        Args:
            previous: id of the maneuver before; None where there was none.
            coast: seconds since that maneuver ended.
            offset: believed entry velocity less the trim's command: m/s, m/s, rad/s.
        """
        shift = next((row.shift for row in self.previous if row.maneuver == previous), (0.0,) * 4)
        faded = exp(-coast / self.fade_time)
        duration, forward, side, heading = (
            value + faded * by + sum(slope * part for slope, part in zip(slopes, offset, strict=True))
            for value, by, slopes in zip(self.base, shift, self.velocity, strict=True)
        )
        return duration, forward, side, heading


@dataclass(frozen=True, slots=True)
class ManeuverLaw(FileValue):
    """Joint law of a maneuver's values as executed, averaged over entries.

    Values are the duration in seconds, the displacement forward and to the right in metres, and the heading
    change in radians.

    Attributes:
        mean: of the values.
        covariance: of the values.
        deviations: rows of joint deviations from the mean.
        path: instants at shares 0, 1/8 ... 1 of the duration.
        entry: dependence on how the maneuver was entered, where one was identified.
    """

    mean: Row4
    covariance: tuple[Row4, Row4, Row4, Row4]
    deviations: Annotated[tuple[Row4, ...], Field(max_length=MOST_DEVIATIONS)]
    path: Annotated[tuple[PathInstant, ...], Field(min_length=PATH_INSTANTS, max_length=PATH_INSTANTS)]
    entry: EntryDependence | None = None

    @property
    def claims_entries(self) -> bool:
        """True if bounds about the mean for an entry are claimed."""
        return self.entry is not None and self.entry.bounds is not None and self.entry.coverage > 0

    def mean_after(self, previous: int | None, coast: float, offset: Row3) -> Row4:
        """Returns the mean values for one way of entering, or for all."""
        return self.mean if self.entry is None else self.entry.mean_after(previous, coast, offset)


@dataclass(frozen=True, slots=True)
class VelocityFluctuation(FileValue):
    """Fluctuation of a trim's velocity within a coast.

    Attributes:
        standard_deviation: m/s, m/s, rad/s.
        correlation_time: seconds, of a first-order Gauss-Markov process.
    """

    standard_deviation: _Spread3
    correlation_time: tuple[PositiveFloat, PositiveFloat, PositiveFloat]

    def integrated_variance(self, coast: float) -> Row3:
        """Returns the variance of the velocity's integral over a coast in seconds."""
        forward, side, heading = (
            2 * spread**2 * time * (coast - time * (1.0 - exp(-coast / time)))
            for spread, time in zip(self.standard_deviation, self.correlation_time, strict=True)
        )
        return forward, side, heading


@dataclass(frozen=True, slots=True)
class TrimLaw(FileValue):
    """Law of a trim's velocity: mean, part between flights, part within.

    Attributes:
        mean: the mean velocity, beside the commanded one.
        covariance: of a flight's mean velocity, between flights.
        deviations: rows of a flight's mean velocity less the mean.
        within: fluctuation within a coast.
        bounds: standard deviations after a coast that forward, side and heading errors stay within, whatever
            the coast's duration; None where none were identified.
        coverage: share of future flights inside all bounds at all times of all coasts at once, at the
            confidence of the trim's statistics; 0 without a claim.
    """

    mean: Twist
    covariance: tuple[Row3, Row3, Row3]
    deviations: Annotated[tuple[Row3, ...], Field(max_length=MOST_DEVIATIONS)]
    within: VelocityFluctuation
    bounds: Row3 | None = None
    coverage: Omittable[Share] = 0.0

    def standard_deviation_after(self, coast: float) -> Row3:
        """Returns the standard deviations of the velocity's integral over a coast.

        Metres along and across the heading, and radians, after so many seconds.
        """
        forward, side, heading = (
            sqrt(self.covariance[place][place] * coast**2 + grown)
            for place, grown in enumerate(self.within.integrated_variance(coast))
        )
        return forward, side, heading

    def bounds_after(self, coast: float) -> Row3 | None:
        """Returns the bounds of these errors; None where none are claimed."""
        if self.bounds is None or not self.coverage:
            return None
        forward, side, heading = (
            factor * spread
            for factor, spread in zip(self.bounds, self.standard_deviation_after(coast), strict=True)
        )
        return forward, side, heading
