"""Upper confidence limit of a failure rate."""

from scipy.stats import beta


def upper_limit(failures: int, trials: int, confidence: float = 0.95) -> float:
    """Returns the one-sided upper confidence limit of failures (Clopper, Pearson).

    Args:
        failures: observed.
        trials: made, independent of one another; without any the limit is 1.
        confidence: level of the limit.

    Raises:
        ValueError: there are more failures than trials.
    """
    if not 0 <= failures <= trials:
        raise ValueError(f"failures must be 0 to {trials}, the trials, got {failures}")
    if failures == trials:
        return 1.0
    return float(beta.ppf(confidence, failures + 1, trials - failures))
