"""Coverage of future samples by boxes and order statistics."""

from math import comb

from scipy.stats import beta


def joint_coverage(samples: int, *, support: int, confidence: float, discarded: int = 0) -> float:
    """Returns the share of future samples inside a box, at a confidence.

    The box is the solution of a scenario program: the smallest that holds every sample but the discarded
    ones. At most `support` of the samples determine it, so the probability that a new sample lies outside
    exceeds v with a probability of at most

        C(k + s - 1, k) * sum over i < k + s of C(n, i) v^i (1 - v)^(n - i)

    with n samples, s of support and k discarded (Campi and Garatti, J. Optim. Theory Appl. 148, 2011,
    theorem 2.1; k = 0 is SIAM J. Optim. 19(3), 2008, theorem 1). The binomial tail is inverted exactly,
    through the beta distribution. The combinatorial factor is needed although the discarded samples are not
    chosen: their number is random, and without the factor 5 % become up to 6.3 % (with it the claim holds for
    every probability of a discarded sample; a test computes both).

    Args:
        samples: independent, identically distributed samples, the discarded ones included.
        support: number of values fitted to the samples: one per scalar where the centre was fixed before, two
            per scalar where the smallest and largest sample fix the sides.
        confidence: probability, over the samples drawn, that the claim holds.
        discarded: samples that the box need not hold; each counts as outside.

    Returns:
        The share in [0, 1]; 0 for too few samples.
    """
    if discarded:
        # For a support of 1 the factor is 1 and does not cover the random number; a support of 2 does.
        support = max(support, 2)
    counted = support + discarded
    if samples < counted:
        return 0.0
    failure = (1.0 - confidence) / comb(counted - 1, discarded)
    return 1.0 - float(beta.isf(failure, counted, samples - counted + 1))


def order_statistic_coverage(count: int, *, exceeding: int, confidence: float) -> float:
    """Returns the population share below an order statistic, at a confidence.

    Of `count` independent draws the limit is the (`exceeding` + 1)-th largest, chosen before the draws. The
    share above it then follows a Beta(exceeding + 1, count - exceeding) distribution for any continuous
    population (Wilks, Ann. Math. Statist. 12, 1941); for others the coverage is larger.

    Args:
        count: number of draws.
        exceeding: draws above the limit, fewer than all.
        confidence: probability, over the draws, that the share holds.
    """
    if not 0 <= exceeding < count:
        return 0.0
    return 1.0 - float(beta.isf(1.0 - confidence, exceeding + 1, count - exceeding))


def most_exceedances(count: int, *, coverage: float, confidence: float) -> int:
    """Returns the most draws above the limit that still give a coverage."""
    exceeding = 0
    while order_statistic_coverage(count, exceeding=exceeding + 1, confidence=confidence) >= coverage:
        exceeding += 1
    return exceeding


def samples_needed(coverage: float, *, support: int, confidence: float, discarded: int = 0) -> int:
    """Returns the least number of samples for a coverage, at a confidence.

    Args:
        coverage: wanted share, inside (0, 1).
        support: as in `joint_coverage`.
        confidence: as in `joint_coverage`, inside (0, 1).
        discarded: as in `joint_coverage`.

    Raises:
        ValueError: coverage or confidence is not inside (0, 1).
    """
    for name, value in (("coverage", coverage), ("confidence", confidence)):
        if not 0 < value < 1:
            raise ValueError(f"{name} must be between 0 and 1, got {value}")

    def enough(samples: int) -> bool:
        claimed = joint_coverage(samples, support=support, confidence=confidence, discarded=discarded)
        return claimed >= coverage

    low, high = 0, support + discarded
    while not enough(high):
        low, high = high, 2 * high
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if enough(middle) else (middle, high)
    return high
