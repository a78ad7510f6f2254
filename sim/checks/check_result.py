"""One measured number beside its bar: what `maneuver verify` prints and what the tests hold."""

from dataclasses import dataclass
from math import isfinite


@dataclass(frozen=True, slots=True)
class CheckResult:
    """A number with the range that it must lie in.

    Attributes:
        topic: what it belongs to, such as `trim` or `margins`.
        name: of the number, with its conditions.
        value: as measured.
        unit: of value and bars; `-` where it has none.
        low: least value that holds; None where there is no such bar.
        high: largest value that holds; None where there is no such bar.
        beside: a figure of other origin to read it against, in words.
    """

    topic: str
    name: str
    value: float
    unit: str
    low: float | None = None
    high: float | None = None
    beside: str = ""

    @property
    def passed(self) -> bool:
        """Whether the value is a number within its bars; a figure without bars is shown only."""
        if self.low is None and self.high is None:
            return True
        above = self.low is None or self.value >= self.low
        below = self.high is None or self.value <= self.high
        return isfinite(self.value) and above and below

    @property
    def limit_text(self) -> str:
        """The bars in words; empty where there are none."""
        bars = ((">=", self.low), ("<=", self.high))
        return ", ".join(f"{sign} {limit:.4g}" for sign, limit in bars if limit is not None)
