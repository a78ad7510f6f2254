"""Coverage claim of interpolated primitives, calibrated by cross-validation.

A flown primitive is left out, and its bounds are interpolated from the others. The factor by which they must
be scaled to hold every sample of all its flights is its *score*. All flown primitives of a kind are left out
in turn, and the errors of interpolated ones are scaled by the (k + 1)-th largest score. With m scores the
share of primitives whose score is at most this factor follows a Beta(m - k, k + 1) distribution: inverted, it
gives the share claimed at a confidence (`coverage.order_statistic_coverage`; Wilks 1941; for split conformal
prediction Vovk, Machine Learning 92, 2013, proposition 2a). k is the largest number that still gives the
wanted coverage; it depends on m alone, not on the scores.

The claim is about the kind: for a share of at least `coverage` of the interpolated primitives, the bounds
hold all numbers of as many flights as each flown one has. (A new flight of a randomly drawn interpolated
primitive is then inside with at least that probability.) Assumptions:

- An interpolated primitive is no harder to interpolate than a flown one left out. It is easier where it lies
  between flown ones; and a maneuver is left out together with all others that share a trim with it, because
  an interpolated trim has no flown maneuver either.
- Scores are identically distributed and independent. All come from almost the same spline and from the same
  flights, with their mean wind and sensor errors; gusts differ.

Neither is proved, so `library test` flies interpolated primitives and tests the claim.
"""

import numpy as np
from jaxtyping import Float

from flight.automaton.statistics import InterpolationClaim
from identification.statistics.coverage import most_exceedances, order_statistic_coverage


def calibrate_claim(
    scores: Float[np.ndarray, "m"], *, flights: int, coverage: float, confidence: float
) -> InterpolationClaim:
    """Returns the claim and factor of a kind from its scores.

    Args:
        scores: score of each flown primitive of the kind; at least one.
        flights: number of flights of each.
        coverage: wanted share of interpolated primitives.
        confidence: confidence of that share.
    """
    exceeding = most_exceedances(len(scores), coverage=coverage, confidence=confidence)
    factor = float(np.sort(scores)[len(scores) - 1 - exceeding])
    return InterpolationClaim(
        left_out=len(scores),
        exceeding=exceeding,
        flights=flights,
        # Interpolated deviations are never scaled down.
        factor=max(1.0, factor),
        coverage=order_statistic_coverage(len(scores), exceeding=exceeding, confidence=confidence),
        confidence=confidence,
    )
