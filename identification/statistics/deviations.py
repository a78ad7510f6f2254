"""Trims and maneuvers with errors and coverage from many flights."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.sign_convention import signed_maneuver_error, signed_trim_error
from flight.automaton.statistics import (
    COMMAND,
    NOMINAL_FLIGHTS,
    SAME_FLIGHTS,
    AveragedError,
    Centre,
    ScalarStatistics,
    Statistics,
)
from flight.automaton.trim import Trim
from flight.se2 import SE2, Twist

from .box import Box, box_around, smallest_box
from .coverage import joint_coverage
from .digits import rounded, rounded_down, rounded_up, row4
from .samples import MANEUVER_SCALARS, TRIM_SCALARS, Samples


@dataclass(frozen=True, slots=True, eq=False)
class DurationBin:
    """Samples of a trim's averages over coasts of some duration, s."""

    shortest: float
    longest: float
    samples: Samples


def identify_trim(
    trim: Trim,
    samples: Samples,
    confidence: float,
    *,
    commanded: bool = True,
    averaged: tuple[DurationBin, ...] = (),
) -> Trim:
    """Returns the trim with its largest deviations as errors.

    A commanded velocity was fixed before any flight, so one value is fitted per scalar. For a velocity found
    in the same flights two are counted, because the box contains the smallest box of the samples.

    Args:
        trim: the trim with its velocity.
        samples: samples of the wanted kind of error.
        confidence: confidence of the coverage.
        commanded: True if the velocity was fixed before the flights.
        averaged: samples averaged over coasts, by bin.
    """
    centre = np.array([trim.velocity.forward, trim.velocity.side, trim.velocity.yaw_rate])

    def box_of(part: Samples) -> Box:
        box = box_around(centre, part.low, part.high)
        return _in_digits(box if commanded else replace(box, support=2 * box.support))

    def signed(size: Float[np.ndarray, "3"]) -> Twist:
        return signed_trim_error(Twist(*size.tolist()), trim.velocity)

    box = box_of(samples)
    source: Centre = COMMAND if commanded else SAME_FLIGHTS
    return replace(
        trim,
        error=signed(box.size),
        statistics=_statistics(TRIM_SCALARS, samples, box, source, confidence),
        averaged=tuple(_averaged_error(part, box_of(part.samples), signed, confidence) for part in averaged),
    )


def identify_maneuver(
    maneuver: Maneuver,
    samples: Samples,
    *,
    nominal: Samples | None,
    left: Trim,
    reached: Trim,
    confidence: float,
) -> Maneuver:
    """Returns the maneuver with its values and largest deviations.

    With nominal flights the values are their means, a centre independent of the other flights. Without, the
    box is the smallest around all samples, its middle the value, with two values fitted per scalar.

    Args:
        maneuver: the maneuver; its numbers are not used.
        samples: samples of the flights for the bounds.
        nominal: samples of the flights for the values; None where there are none.
        left: the trim left.
        reached: the trim reached.
        confidence: confidence of the coverage.
    """
    centre: Centre
    if nominal is None:
        fitted, centre = smallest_box(samples.low, samples.high), SAME_FLIGHTS
    else:
        fitted, centre = box_around(nominal.rows.mean(axis=0), samples.low, samples.high), NOMINAL_FLIGHTS
    # Half widths are those about the centre as it is written.
    middle = np.array(row4(fitted.centre))
    box = _in_digits(replace(box_around(middle, samples.low, samples.high), support=fitted.support))
    duration, forward, side, heading_change = box.centre.tolist()
    return Maneuver(
        id=maneuver.id,
        from_trim=maneuver.from_trim,
        to_trim=maneuver.to_trim,
        duration=duration,
        displacement=SE2(forward, side, heading_change),
        error=signed_maneuver_error(
            ManeuverError(*box.size.tolist()), left=left.velocity, reached=reached.velocity
        ),
        statistics=_statistics(MANEUVER_SCALARS, samples, box, centre, confidence),
    )


def _in_digits(box: Box) -> Box:
    """Returns the box with half widths of six digits, rounded up."""
    return replace(box, size=np.array([rounded_up(size) for size in box.size.tolist()]))


def _averaged_error(
    part: DurationBin, box: Box, signed: Callable[[Float[np.ndarray, "3"]], Twist], confidence: float
) -> AveragedError:
    return AveragedError(
        shortest=rounded(part.shortest),
        longest=rounded(part.longest),
        error=signed(box.size),
        samples=part.samples.count,
        coverage=_coverage(part.samples, box, confidence),
    )


def _coverage(samples: Samples, box: Box, confidence: float) -> float:
    return rounded_down(
        joint_coverage(
            samples.count, support=box.support, confidence=confidence, discarded=len(samples.discarded)
        )
    )


def _statistics(
    names: tuple[str, ...], samples: Samples, box: Box, centre: Centre, confidence: float
) -> Statistics:
    return Statistics(
        samples=samples.count,
        timeouts=samples.timeouts,
        coverage=_coverage(samples, box, confidence),
        confidence=confidence,
        scalars=_scalars(names, samples.rows, box.size),
        discarded=len(samples.discarded),
        cut=samples.cut,
        support=box.support,
        centre=centre,
    )


def _scalars(
    names: tuple[str, ...], rows: Float[np.ndarray, "n scalars"], largest: Float[np.ndarray, "scalars"]
) -> tuple[ScalarStatistics, ...]:
    sigma = rows.std(axis=0, ddof=1) if len(rows) > 1 else np.zeros(len(names))
    columns = zip(names, rows.mean(axis=0).tolist(), sigma.tolist(), largest.tolist(), strict=True)
    return tuple(
        ScalarStatistics(name, rounded(mean), rounded(spread), furthest)
        for name, mean, spread, furthest in columns
    )
