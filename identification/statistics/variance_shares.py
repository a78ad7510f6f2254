"""Shares of variance between flights by one-way random effects."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np
from scipy.stats import f

from flight.errors import FlightError
from identification.segmentation.flight_evidence import FlightEvidence

from .samples import MANEUVER_SCALARS, TRIM_SCALARS, coasts_of, maneuver_row, performances_of

CONFIDENCE = 0.95
"""Of the interval of a share."""


class TooFewRepetitionsError(FlightError):
    """Primitive that no two flights have, or none has twice."""

    def __init__(self, primitive: str) -> None:
        super().__init__(f"{primitive}: expected two flights and one with two performances, got fewer")


@dataclass(frozen=True, slots=True)
class VarianceShare:
    """Variance of one scalar between and within flights.

    Attributes:
        between: variance of the flights' means, at least 0.
        within: variance of the performances of a flight.
        share: part of the variance that a flight's performances share (intraclass correlation).
        low: lower end of the share's 95 % interval.
        high: upper end.
        flights: number of flights.
        performances: number of performances.
    """

    between: float
    within: float
    share: float
    low: float
    high: float
    flights: int
    performances: int

    @property
    def sigma(self) -> float:
        """Standard deviation of a performance of any flight."""
        return sqrt(self.between + self.within)


@dataclass(frozen=True, slots=True)
class ScalarVariance:
    """Variance of one scalar of one primitive.

    Attributes:
        primitive: such as `trim 2` or `maneuver 7`.
        scalar: name of the scalar.
        variance: its parts.
    """

    primitive: str
    scalar: str
    variance: VarianceShare


def variance_share(groups: Sequence[Sequence[float]], *, name: str = "scalar") -> VarianceShare:
    """Returns the share of variance between groups, by analysis of variance.

    The mean squares between and within groups give both variances; groups of different sizes count by their
    effective size (Searle, Casella, McCulloch 1992, 3.6). The interval is that of the F distribution, exact
    for groups of one size.

    Args:
        groups: performances, one sequence for each flight.
        name: name in errors.

    Raises:
        TooFewRepetitionsError: fewer than two groups, or none with two performances.
    """
    rows = [np.asarray(group, dtype=float) for group in groups if len(group)]
    count, total = len(rows), sum(map(len, rows))
    if count < 2 or total == count:
        raise TooFewRepetitionsError(name)
    grand = np.concatenate(rows).mean()
    inner = sum(float(((row - row.mean()) ** 2).sum()) for row in rows) / (total - count)
    outer = sum(len(row) * float(row.mean() - grand) ** 2 for row in rows) / (count - 1)
    size = (total - sum(len(row) ** 2 for row in rows) / total) / (count - 1)
    between = max(0.0, (outer - inner) / size)
    whole = between + inner
    low, high = _share_interval(outer, inner, size, (count - 1, total - count))
    return VarianceShare(between, inner, between / whole if whole else 0.0, low, high, count, total)


def _share_interval(
    outer: float, inner: float, size: float, freedoms: tuple[int, int]
) -> tuple[float, float]:
    if not inner:
        return (1.0, 1.0) if outer else (0.0, 1.0)
    tail = (1.0 - CONFIDENCE) / 2.0
    ends = []
    for quantile in (f.ppf(1.0 - tail, *freedoms), f.ppf(tail, *freedoms)):
        ratio = outer / inner / float(quantile)
        ends.append(min(1.0, max(0.0, (ratio - 1.0) / (ratio + size - 1.0))))
    return ends[0], ends[1]


def variances_of(flights: Sequence[FlightEvidence]) -> tuple[ScalarVariance, ...]:
    """Returns the variances of every scalar of every primitive.

    The scalars of a trim are means over a coast; those of a maneuver its settled performances'. Lost flights
    are left out.

    Raises:
        TooFewRepetitionsError: a primitive was not flown twice in a flight.
    """
    kept = [flight for flight in flights if not flight.lost]
    library = kept[0].library
    parts: list[ScalarVariance] = []
    for trim in library.trims:
        means = [
            [coast.velocity.mean(axis=0).tolist() for coast in coasts_of(flight, trim.id)] for flight in kept
        ]
        parts += _variances(f"trim {trim.id}", TRIM_SCALARS, means)
    for row in library.maneuvers:
        values = [
            [list(maneuver_row(one)) for one in performances_of(flight, row.id) if one.settled]
            for flight in kept
        ]
        parts += _variances(f"maneuver {row.id}", MANEUVER_SCALARS, values)
    return tuple(parts)


def _variances(
    primitive: str, scalars: tuple[str, ...], flights: Sequence[Sequence[Sequence[float]]]
) -> list[ScalarVariance]:
    return [
        ScalarVariance(
            primitive,
            scalar,
            variance_share([[row[place] for row in rows] for rows in flights], name=f"{primitive}, {scalar}"),
        )
        for place, scalar in enumerate(scalars)
    ]


def source_shares(
    sources: Mapping[str, Sequence[ScalarVariance]],
) -> dict[tuple[str, str], dict[str, float]]:
    """Returns each source's part of the variance, by primitive and scalar.

    Args:
        sources: variances with one source alone, by its name.
    """
    found: dict[tuple[str, str], dict[str, float]] = {}
    for name, rows in sources.items():
        for row in rows:
            found.setdefault((row.primitive, row.scalar), {})[name] = row.variance.sigma**2
    return {key: _normalised(parts) for key, parts in found.items()}


def _normalised(parts: dict[str, float]) -> dict[str, float]:
    whole = sum(parts.values())
    return {name: part / whole if whole else 0.0 for name, part in parts.items()}
