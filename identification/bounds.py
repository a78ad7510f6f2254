"""What share of future samples a box of largest deviations covers, with which confidence."""

from scipy.stats import beta


def joint_coverage(samples: int, *, support: int, confidence: float) -> float:
    """Returns the share of future samples that a box around all samples covers, at a confidence.

    The box is the solution of a scenario program: the smallest that holds every sample. At most `support`
    of the samples determine it, so the probability that a new sample lies outside exceeds v with a
    probability of at most sum over i < support of C(n, i) v^i (1 - v)^(n - i) (Campi and Garatti, SIAM J.
    Optim. 19(3), 2008, theorem 1). The binomial tail is inverted exactly, through the beta distribution.

    Args:
        samples: independent, identically distributed samples.
        support: numbers that the box is fitted to: one for each scalar where the centre was fixed before,
            two for each scalar where only the smallest and largest sample fix the sides.
        confidence: probability, over the samples drawn, with which the claim holds.

    Returns:
        The share in [0, 1]; 0 where there are too few samples to claim anything.
    """
    if samples < support:
        return 0.0
    outside = float(beta.ppf(confidence, support, samples - support + 1))
    return 1.0 - outside
