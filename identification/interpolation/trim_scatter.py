"""Scatter of interpolated trims, and of trims entered by interpolated maneuvers.

A maneuver ends inside a band, not at the trim, so a coast begins with a residual of the step before it: its
*tail*. Where a step is small relative to the band, the tail is most of a coast's deviation, and it depends on
the step, not on the trim. The tail is therefore computed from the fitted responses, for all maneuvers that
lead to the trim; the rest, due to wind, is interpolated. Both add in squares, as independent deviations.
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

# Least share of a deviation due to wind; the computed tail may exceed the flown deviation.
_WIND = 0.25

Table = Float[np.ndarray, "_ 3"]


@dataclass(frozen=True, slots=True, eq=False)
class TrimScatter:
    """Bounds and claim of trims entered by interpolated maneuvers.

    Attributes:
        sizes: bounds of forward, side and yaw rate by trim id.
        claim: coverage claim of all of them.
        fits: cross-validation of the wind's part.
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
    """Interpolates the bounds of trims between flown ones.

    A flown trim among the wanted ones is bounded by its leave-one-out prediction, never below its flown
    deviations.

    Args:
        flown: flown trims with statistics.
        wanted: trims that interpolated maneuvers enter.
        tails_flown: largest tail of each flown trim over the flown maneuvers to it: forward, side, yaw rate.
        tails_wanted: largest tail of each wanted trim over all maneuvers to it.
        coverage: share of the wanted trims whose bounds hold as many flights as were flown.
        confidence: confidence of that share.
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
