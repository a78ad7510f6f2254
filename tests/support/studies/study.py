"""Sizes, seed and figures of a test marked slow."""

from collections.abc import Callable
from dataclasses import dataclass

from scipy.stats import beta

SIZES = {
    "flights": "flights of a campaign",
    "kills": "times that a campaign is killed",
    "missions": "missions that are planned",
    "mutations": "files that are mutated",
    "primitives": "primitives that are identified",
    "seed": "seed of all that is drawn",
    "workers": "processes side by side",
}
"""Sizes that may be given on pytest's command line, each with its meaning."""


@dataclass(frozen=True, slots=True)
class Study:
    """A test whose size is given on the command line, and whose figures are printed.

    Attributes:
        option: returns the size given by its name; None where none is given.
        show: prints a line at once.
    """

    option: Callable[[str], int | None]
    show: Callable[[str], None]

    def size(self, name: str, default: int) -> int:
        """Returns the size given on the command line, or the default."""
        given = self.option(name)
        return default if given is None else given

    def show_share(self, wrong: int, trials: int, what: str) -> None:
        """Prints how many of the trials are wrong, with the upper limit of their share."""
        self.show(
            f"{what}: {wrong} of {trials} wrong, 95 % upper limit {100 * upper_limit(wrong, trials):.3f} %"
        )


def upper_limit(failures: int, trials: int, confidence: float = 0.95) -> float:
    """Returns the largest share of failures not refuted, one-sided (Clopper, Pearson).

    Args:
        failures: seen.
        trials: made, independent of one another; without any the limit is 1.
        confidence: of the limit.
    """
    assert 0 <= failures <= trials, (failures, trials)
    return 1.0 if failures == trials else float(beta.ppf(confidence, failures + 1, trials - failures))
