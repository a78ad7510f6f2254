"""Statistics of an error: samples, scatter, coverage claimed."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Annotated, Final, Literal

from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveInt

from flight.file_value import FileValue, InForm, Omittable, Share
from flight.se2 import Twist

Centre = Literal["command", "nominal flights", "same flights"]
"""Source of the value that deviations are counted from."""

COMMAND: Final = "command"
NOMINAL_FLIGHTS: Final = "nominal flights"
SAME_FLIGHTS: Final = "same flights"


@dataclass(frozen=True, slots=True)
class ScalarStatistics:
    """Statistics of one number of a primitive, in its own unit.

    Attributes:
        name: the number's name in the library, such as `forward` or `duration`.
        mean: of a maneuver's performances; of a trim's averages over a flight.
        standard_deviation: of the same (n - 1 in the denominator; 0 for one).
        largest_deviation: largest absolute deviation from the value in the library, over performances; for a
            trim over every instant, or every average, of its coasts.
    """

    name: str
    mean: float
    standard_deviation: float
    largest_deviation: float


@dataclass(frozen=True, slots=True)
class ScalarRow(FileValue):
    """Statistics of one number of a primitive, as files state them."""

    mean: float
    standard_deviation: NonNegativeFloat
    largest_deviation: NonNegativeFloat


def _listed(scalars: Mapping[str, ScalarRow]) -> tuple[ScalarStatistics, ...]:
    return tuple(
        ScalarStatistics(name, row.mean, row.standard_deviation, row.largest_deviation)
        for name, row in scalars.items()
    )


def _by_name(scalars: Iterable[ScalarStatistics]) -> dict[str, ScalarRow]:
    return {row.name: ScalarRow(row.mean, row.standard_deviation, row.largest_deviation) for row in scalars}


@dataclass(frozen=True, slots=True)
class Statistics(FileValue):
    """The evidence behind the errors of one primitive.

    Attributes:
        samples: independent samples (one a flight), the discarded ones included.
        timeouts: performances that ended by time-out.
        coverage: share of future samples inside all of the primitive's bounds at once.
        confidence: confidence of that share.
        discarded: samples that the bounds do not hold, because the flight was lost or a maneuver timed
            out; the claim accounts for them.
        cut: performances cut by the next command or the log's end; they have no values.
        support: number of values fitted to the samples; None if unknown.
        centre: source of the values; None if unknown.
        scalars: one entry per number; a file has them by their names.
    """

    samples: PositiveInt
    timeouts: NonNegativeInt
    coverage: Annotated[Share, Field(description="share of future samples inside all bounds at once")]
    confidence: Share
    discarded: Annotated[
        Omittable[NonNegativeInt], Field(description="samples outside the bounds; absent: none")
    ] = field(default=0, kw_only=True)
    cut: Annotated[
        Omittable[NonNegativeInt], Field(description="performances cut before their end; absent: none")
    ] = field(default=0, kw_only=True)
    support: Annotated[PositiveInt | None, Field(description="numbers fitted to the samples")] = field(
        default=None, kw_only=True
    )
    centre: Annotated[Centre | None, Field(description="where the values come from")] = field(
        default=None, kw_only=True
    )
    scalars: Annotated[tuple[ScalarStatistics, ...], InForm(dict[str, ScalarRow], _listed, _by_name)]


@dataclass(frozen=True, slots=True)
class InterpolationClaim(FileValue):
    """Coverage claim for primitives interpolated between flown ones.

    It is claimed of the kind as a whole: of the trims, or of the maneuvers, that were interpolated, a share
    of at least `coverage` holds `flights` flights with all numbers inside the bounds at once.

    Attributes:
        left_out: flown primitives of the kind, each of which was left out in turn.
        exceeding: number of them outside the bounds interpolated from the others.
        flights: number of flights of each.
        factor: by which interpolated deviations were inflated, so that no more exceed.
        coverage: share of the interpolated primitives that hold so many flights.
        confidence: confidence of that share.
    """

    left_out: Annotated[PositiveInt, Field(description="flown primitives, each left out in turn")]
    exceeding: Annotated[
        NonNegativeInt, Field(description="of them, those that the others' bounds did not hold")
    ]
    flights: Annotated[PositiveInt, Field(description="that each of them was flown in")]
    factor: Annotated[NonNegativeFloat, Field(description="by which interpolated deviations were inflated")]
    coverage: Annotated[Share, Field(description="share of primitives that hold so many flights")]
    confidence: Share


@dataclass(frozen=True, slots=True)
class AveragedError(FileValue):
    """Error of a trim's velocity averaged over a coast.

    Attributes:
        shortest: shortest duration that it holds for, seconds; never below the shortest coast flown.
        longest: longest duration.
        error: signed as the trim's error.
        samples: flights with a coast that long, the discarded ones included.
        coverage: share of future flights inside all three bounds at once, at the trim's confidence.
    """

    shortest: Annotated[NonNegativeFloat, Field(description="seconds")]
    longest: Annotated[NonNegativeFloat, Field(description="seconds")]
    error: Twist
    samples: PositiveInt
    coverage: Share
