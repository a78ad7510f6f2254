"""How often something may go wrong that was seen to go wrong so seldom."""

from scipy.stats import beta


def upper_limit(failures: int, trials: int, confidence: float = 0.95) -> float:
    """Returns the share of failures that is not exceeded, with one-sided confidence (Clopper, Pearson).

    Args:
        failures: seen.
        trials: made, independent of one another; without any the limit is 1.
        confidence: of the limit.

    Raises:
        ValueError: there are more failures than trials.
    """
    if not 0 <= failures <= trials:
        raise ValueError(f"failures must be 0 to {trials}, the trials, got {failures}")
    if failures == trials:
        return 1.0
    return float(beta.ppf(confidence, failures + 1, trials - failures))
