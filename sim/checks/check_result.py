"""Result of one check of `maneuver verify`: measured value and limits."""

from dataclasses import dataclass
from math import isfinite


@dataclass(frozen=True, slots=True)
class CheckResult:
    """Measured value and its limits.

    Attributes:
        topic: topic of the check, such as `trim` or `margins`.
        name: name of the value, with its conditions.
        value: measured value.
        unit: unit of value and limits; `-` if dimensionless.
        low: lower limit; None without one.
        high: upper limit; None without one.
        beside: reference figure or conditions, in words.
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
        """True if the value is within its limits, or has none."""
        if self.low is None and self.high is None:
            return True
        above = self.low is None or self.value >= self.low
        below = self.high is None or self.value <= self.high
        return isfinite(self.value) and above and below

    @property
    def limit_text(self) -> str:
        """Limits as text; empty without limits."""
        limits = ((">=", self.low), ("<=", self.high))
        return ", ".join(f"{sign} {limit:.4g}" for sign, limit in limits if limit is not None)
