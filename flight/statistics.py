"""How an error was found: what was observed, how often, and what may be claimed from it."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ScalarStatistics:
    """One number of a primitive over all its samples, in the number's own unit.

    Attributes:
        name: the number's name in the library, such as `forward` or `duration`.
        mean: of a maneuver's performances; of a trim's averages over a flight.
        standard_deviation: of the same (n - 1 in the denominator; 0 for one).
        largest_deviation: largest absolute deviation from the value in the library, over performances; for a
            trim over every instant of its coasts.
    """

    name: str
    mean: float
    standard_deviation: float
    largest_deviation: float


@dataclass(frozen=True, slots=True)
class Statistics:
    """The evidence behind the errors of one primitive.

    Attributes:
        samples: independent samples (one a flight).
        timeouts: samples among them that ended by time-out.
        coverage: share of future samples inside all of the primitive's bounds at once.
        confidence: confidence of that share.
        scalars: one entry per number.
    """

    samples: int
    timeouts: int
    coverage: float
    confidence: float
    scalars: tuple[ScalarStatistics, ...]
