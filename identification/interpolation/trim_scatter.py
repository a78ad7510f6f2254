"""How far trims scatter that were never flown, or are entered as they never were.

A maneuver ends inside a band, not at the trim, so a coast begins with what is left of the step before it: its
*tail*. Where a step is small beside the band the tail is most of what a coast deviates, and it depends on the
step, not on the trim. So the tail is computed, from the responses that fit the flown maneuvers and for all
maneuvers that lead to the trim; interpolated is the rest, which the wind makes. Both add as independent
deviations do: in squares.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from flight.automaton.statistics import InterpolationClaim
from flight.automaton.trim import Trim
from identification.statistics.samples import TRIM_SCALARS

from .cross_validation import (
    InterpolationFit,
    largest_deviation,
    least_flights,
    root_mean_square,
    scaled_velocity,
)
from .interpolation_claim import calibrate_claim
from .spline import Spline

# So much of a deviation, at least, is the wind's: the computed tail may come out above what was flown.
_WIND = 0.25

Table = Float[np.ndarray, "n 3"]


@dataclass(frozen=True, slots=True, eq=False)
class TrimScatter:
    """What is claimed of trims that grown maneuvers lead to.

    Attributes:
        sizes: by id, bounds of forward, side and yaw rate.
        claim: of all of them.
        fits: how well the wind's part interpolates.
    """

    sizes: dict[int, Float[np.ndarray, "3"]]
    claim: InterpolationClaim
    fits: tuple[InterpolationFit, ...]


def trim_scatter(
    flown: Sequence[Trim],
    wanted: Sequence[Trim],
    *,
    tails_flown: Table,
    tails_wanted: Table,
    coverage: float,
    confidence: float,
) -> TrimScatter:
    """Returns the bounds of trims, interpolated between flown ones.

    A flown trim among those wanted is bounded by what its neighbours give, as it was when it was left out,
    and never closer than it was flown.

    Args:
        flown: with statistics.
        wanted: trims that grown maneuvers lead to.
        tails_flown: of each flown trim the largest tail of the maneuvers that led to it in flight: forward,
            side, yaw rate.
        tails_wanted: of each wanted trim that of all maneuvers that lead to it.
        coverage: share of the wanted trims that are to hold as many flights as were flown.
        confidence: of that share.
    """
    deviations = np.array(
        [[largest_deviation(trim.statistics, one) for one in TRIM_SCALARS] for trim in flown]
    )
    wind = np.sqrt(np.maximum(deviations**2 - tails_flown**2, (_WIND * deviations) ** 2))
    splines = [Spline.fit(_scaled_velocities(flown), np.log(column)) for column in wind.T]
    left_out = wind / np.exp(np.column_stack([one.left_out for one in splines]))
    claim = calibrate_claim(
        (deviations / np.hypot(tails_flown, left_out)).max(axis=1),
        flights=least_flights(trim.statistics for trim in flown),
        coverage=coverage,
        confidence=confidence,
    )
    between = np.exp(np.column_stack([one.at(_scaled_velocities(wanted)) for one in splines]))
    known = {trim.id: row for row, trim in enumerate(flown)}
    sizes = {}
    for trim, tail, rest in zip(wanted, tails_wanted, between, strict=True):
        row = known.get(trim.id)
        size = claim.factor * np.hypot(tail, rest if row is None else left_out[row])
        sizes[trim.id] = size if row is None else np.maximum(size, deviations[row])
    fits = tuple(
        InterpolationFit(f"trim {name}", root_mean_square(one.left_out), one.smoothing)
        for name, one in zip(TRIM_SCALARS, splines, strict=True)
    )
    return TrimScatter(sizes, claim, fits)


def _scaled_velocities(trims: Sequence[Trim]) -> Float[np.ndarray, "n 2"]:
    return np.array([scaled_velocity(trim.velocity) for trim in trims]).reshape(-1, 2)
