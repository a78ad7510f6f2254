"""What may be claimed of primitives that were never flown.

A flown primitive is left out, and its bounds are interpolated from the others. The ratio by which they would
have to be inflated to hold every sample of all its flights is its *score*. All flown primitives of a kind are
left out in turn, and the factor that inflates the grown ones is the largest score but k. With m scores the
share of primitives whose score is no larger than the factor then follows a Beta(m - k, k + 1) law: inverted,
it gives the share claimed at a confidence (`bounds.held_share`; Wilks 1941; for split conformal prediction
Vovk, Machine Learning 92, 2013, proposition 2a). As many primitives may exceed the factor as let the coverage
wanted be claimed still; k depends on m alone, never on the scores.

So the claim is one of the kind: of the grown primitives a share of at least `coverage` holds as many flights
as each flown one was flown in, with all numbers inside at once. (Then a new flight of a grown primitive drawn
by chance, too, is inside with at least that probability.) It takes for granted

- that a grown primitive is no harder to interpolate than a flown one left out. It is easier where it lies
  between flown ones; and a maneuver is left out with all others that share a trim with it, since no maneuver
  of a grown trim was flown either;
- that scores are alike and independent. Each is from the same spline but for what was left out, and all are
  from the same flights, whose mean wind and sensor errors they share; the gusts of each are its own.

Neither is proved, so `library test` flies grown primitives and holds the claim against them.
"""

import numpy as np
from jaxtyping import Float

from flight.automaton.statistics import InterpolationClaim
from identification.statistics.coverage import most_exceedances, order_statistic_coverage


def calibrate_claim(
    scores: Float[np.ndarray, "m"], *, flights: int, coverage: float, confidence: float
) -> InterpolationClaim:
    """Returns the factor that holds the flown primitives left out, with what it lets claim of grown ones.

    Args:
        scores: for each flown primitive of the kind, the factor at which the bounds that the others give hold
            every sample of it; at least one.
        flights: that each of them was flown in.
        coverage: share of grown primitives wanted.
        confidence: of that share.
    """
    exceeding = most_exceedances(len(scores), coverage=coverage, confidence=confidence)
    factor = float(np.sort(scores)[len(scores) - 1 - exceeding])
    return InterpolationClaim(
        left_out=len(scores),
        exceeding=exceeding,
        flights=flights,
        # Interpolated deviations are never made smaller.
        factor=max(1.0, factor),
        coverage=order_statistic_coverage(len(scores), exceeding=exceeding, confidence=confidence),
        confidence=confidence,
    )
