"""The deviations of one primitive over many flights, and the errors that follow from them."""

import numpy as np
from jaxtyping import Float

from flight.maneuver import Maneuver, ManeuverError
from flight.se2 import SE2, Twist
from flight.sign_convention import signed_maneuver_error, signed_trim_error
from flight.statistics import ScalarStatistics, Statistics
from flight.trim import Trim

from .bounds import joint_coverage
from .segmentation import CoastSegment, ManeuverSegment

TRIM_SCALARS = ("forward", "side", "yaw_rate")
MANEUVER_SCALARS = ("duration", "forward", "side", "heading_change")


def identified_trim(trim: Trim, coasts_by_flight: list[list[CoastSegment]], confidence: float) -> Trim:
    """Returns the trim with the largest deviations from its commanded velocity as its errors.

    A flight is one sample: its largest deviation of each scalar at any instant of any of its coasts in this
    trim. The centre of the bounds is the command, fixed before any flight, so three numbers are fitted.

    Args:
        trim: names the trim and the velocity commanded.
        coasts_by_flight: for each flight that held the trim, its coasts; none empty.
        confidence: of the coverage claimed.
    """
    centre = np.array([trim.velocity.forward, trim.velocity.side, trim.velocity.yaw_rate])
    samples = [np.concatenate([coast.velocity for coast in coasts]) for coasts in coasts_by_flight]
    largest = np.array([np.abs(velocity - centre).max(axis=0) for velocity in samples])
    means = np.array([velocity.mean(axis=0) for velocity in samples])
    size = largest.max(axis=0)
    return Trim(
        id=trim.id,
        name=trim.name,
        velocity=trim.velocity,
        error=signed_trim_error(Twist(*size.tolist()), trim.velocity),
        statistics=Statistics(
            samples=len(samples),
            timeouts=0,
            coverage=joint_coverage(len(samples), support=len(TRIM_SCALARS), confidence=confidence),
            confidence=confidence,
            scalars=_scalars(TRIM_SCALARS, means, size),
        ),
    )


def identified_maneuver(
    maneuver: Maneuver,
    segments_by_flight: list[list[ManeuverSegment]],
    *,
    left: Trim,
    reached: Trim,
    confidence: float,
) -> Maneuver:
    """Returns the maneuver with its mean values, and its largest deviations from them as errors.

    A flight is one sample, however often it performs the maneuver. The centre is the mean of the same
    performances. The box around it contains the box from the smallest to the largest, for which the claim
    is made, with two numbers fitted for each scalar.

    Args:
        maneuver: names the maneuver; its numbers are not used.
        segments_by_flight: for each flight that performed it, its performances; none empty.
        left: the trim that the maneuver leaves.
        reached: the trim that it leads to.
        confidence: of the coverage claimed.
    """
    segments = [segment for flight in segments_by_flight for segment in flight]
    samples = len(segments_by_flight)
    rows = np.array([_maneuver_row(segment) for segment in segments])
    mean = rows.mean(axis=0)
    size = np.abs(rows - mean).max(axis=0)
    duration, forward, side, heading_change = mean.tolist()
    return Maneuver(
        id=maneuver.id,
        from_trim=maneuver.from_trim,
        to_trim=maneuver.to_trim,
        duration=duration,
        displacement=SE2(forward, side, heading_change),
        error=signed_maneuver_error(
            ManeuverError(*size.tolist()), left=left.velocity, reached=reached.velocity
        ),
        statistics=Statistics(
            samples=samples,
            timeouts=sum(not segment.settled for segment in segments),
            coverage=joint_coverage(samples, support=2 * len(MANEUVER_SCALARS), confidence=confidence),
            confidence=confidence,
            scalars=_scalars(MANEUVER_SCALARS, rows, size),
        ),
    )


def _maneuver_row(segment: ManeuverSegment) -> tuple[float, float, float, float]:
    displacement = segment.displacement
    return segment.duration, displacement.x, displacement.y, displacement.heading


def _scalars(
    names: tuple[str, ...], samples: Float[np.ndarray, "n scalars"], largest: Float[np.ndarray, "scalars"]
) -> tuple[ScalarStatistics, ...]:
    spread = samples.std(axis=0, ddof=1) if len(samples) > 1 else np.zeros(len(names))
    rows = zip(names, samples.mean(axis=0).tolist(), spread.tolist(), largest.tolist(), strict=True)
    return tuple(ScalarStatistics(*row) for row in rows)
