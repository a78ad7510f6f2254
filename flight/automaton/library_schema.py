"""Statistics as they stand in a library file."""

from dataclasses import asdict
from typing import Any

from pydantic import Field, FiniteFloat, PositiveInt

from flight.schema import FileModel
from flight.se2 import Twist

from .conditions import Conditions, TrimErrorKind
from .maneuver_end import Band, ManeuverEnd
from .statistics import AveragedError, Centre, InterpolationClaim, ScalarStatistics, Statistics


class VelocityPart(FileModel):
    """Body velocity, or its signed error."""

    forward: FiniteFloat = Field(description="metres per second")
    side: FiniteFloat = Field(description="metres per second, to the right")
    yaw_rate: FiniteFloat = Field(description="radians per second, right turns positive")

    def twist(self) -> Twist:
        """Returns the velocity."""
        return Twist(self.forward, self.side, self.yaw_rate)


class _Scalar(FileModel):
    mean: FiniteFloat
    standard_deviation: FiniteFloat = Field(ge=0)
    largest_deviation: FiniteFloat = Field(ge=0)


class StatisticsPart(FileModel):
    """How the errors of one primitive were found."""

    samples: PositiveInt
    timeouts: int = Field(ge=0)
    coverage: FiniteFloat = Field(ge=0, le=1, description="share of future samples inside all bounds at once")
    confidence: FiniteFloat = Field(ge=0, le=1)
    discarded: int | None = Field(default=None, ge=0, description="samples outside the bounds; absent: none")
    support: PositiveInt | None = Field(default=None, description="numbers fitted to the samples")
    centre: Centre | None = Field(default=None, description="where the values come from")
    scalars: dict[str, _Scalar]

    def statistics(self) -> Statistics:
        """Returns the statistics that the file states."""
        return Statistics(
            samples=self.samples,
            timeouts=self.timeouts,
            coverage=self.coverage,
            confidence=self.confidence,
            scalars=tuple(ScalarStatistics(name, **row.model_dump()) for name, row in self.scalars.items()),
            discarded=self.discarded or 0,
            support=self.support,
            centre=self.centre,
        )


class InterpolatedPart(FileModel):
    """What is claimed of the primitives of a kind whose errors were interpolated between flown ones."""

    left_out: PositiveInt = Field(description="flown primitives, each left out in turn")
    exceeding: int = Field(ge=0, description="of them, those that the others' bounds did not hold")
    flights: PositiveInt = Field(description="that each of them was flown in")
    factor: FiniteFloat = Field(ge=0, description="by which interpolated deviations were inflated")
    coverage: FiniteFloat = Field(ge=0, le=1, description="share of primitives that hold so many flights")
    confidence: FiniteFloat = Field(ge=0, le=1)

    def interpolated(self) -> InterpolationClaim:
        """Returns the claim that the file states."""
        return InterpolationClaim(**self.model_dump())


class AveragedErrorPart(FileModel):
    """The error of a trim averaged over coasts of some duration."""

    shortest: FiniteFloat = Field(ge=0, description="seconds")
    longest: FiniteFloat = Field(ge=0, description="seconds")
    error: VelocityPart
    samples: PositiveInt
    coverage: FiniteFloat = Field(ge=0, le=1)

    def averaged_error(self) -> AveragedError:
        """Returns the error that the file states."""
        return AveragedError(self.shortest, self.longest, self.error.twist(), self.samples, self.coverage)


def velocity_content(twist: Twist) -> dict[str, float]:
    """Returns the content of a file for a velocity."""
    return {"forward": twist.forward, "side": twist.side, "yaw_rate": twist.yaw_rate}


def averaged_error_content(part: AveragedError) -> dict[str, Any]:
    """Returns the content of a file for an averaged error."""
    return {
        "shortest": part.shortest,
        "longest": part.longest,
        "error": velocity_content(part.error),
        "samples": part.samples,
        "coverage": part.coverage,
    }


def interpolated_content(claim: InterpolationClaim | None) -> dict[str, Any] | None:
    """Returns the content of a file for the claim of interpolated primitives."""
    return None if claim is None else asdict(claim)


def statistics_content(statistics: Statistics | None) -> dict[str, Any] | None:
    """Returns the content of a file for statistics."""
    if statistics is None:
        return None
    return {
        "samples": statistics.samples,
        "timeouts": statistics.timeouts,
        "coverage": statistics.coverage,
        "confidence": statistics.confidence,
        "discarded": statistics.discarded or None,
        "support": statistics.support,
        "centre": statistics.centre,
        "scalars": {
            scalar.name: {
                "mean": scalar.mean,
                "standard_deviation": scalar.standard_deviation,
                "largest_deviation": scalar.largest_deviation,
            }
            for scalar in statistics.scalars
        },
    }


class BandPart(FileModel):
    """Half widths around one trim's velocity."""

    trim: int
    forward: FiniteFloat = Field(gt=0, description="metres per second")
    side: FiniteFloat = Field(gt=0, description="metres per second")
    yaw_rate: FiniteFloat = Field(gt=0, description="radians per second")


class ManeuverEndPart(FileModel):
    """The band around each trim, and the times in seconds, by which a maneuver was ended."""

    band: list[BandPart] = Field(min_length=1)
    dwell: FiniteFloat = Field(ge=0)
    timeout: FiniteFloat = Field(gt=0)

    def rule(self) -> ManeuverEnd:
        """Returns the rule.

        Raises:
            ValueError: two bands for one trim, or times that order wrongly.
        """
        bands = {part.trim: Band(part.forward, part.side, part.yaw_rate) for part in self.band}
        if len(bands) != len(self.band):
            raise ValueError(f"band: one for each trim, got {sorted(part.trim for part in self.band)}")
        return ManeuverEnd(bands, self.dwell, self.timeout)


def maneuver_end_content(rule: ManeuverEnd) -> dict[str, Any]:
    """Returns the rule as plain JSON values."""
    bands = [
        {"trim": trim, "forward": band.forward, "side": band.side, "yaw_rate": band.yaw_rate}
        for trim, band in sorted(rule.bands.items())
    ]
    return {"band": bands, "dwell": rule.dwell, "timeout": rule.timeout}


class ConditionsPart(FileModel):
    """Where a library's numbers hold."""

    wind: str
    altitude: FiniteFloat | None = Field(default=None, description="metres above ground")
    maneuver_end: ManeuverEndPart | None = None
    trim_error_kind: TrimErrorKind
    coasting_range: tuple[FiniteFloat, FiniteFloat] | None = Field(
        default=None, description="shortest and longest coast flown, seconds"
    )
    vehicle_hash: str | None = Field(default=None, description="SHA-256 of the vehicle's parameters")
    speed_range: tuple[FiniteFloat, FiniteFloat] | None = Field(
        default=None, description="lowest and highest forward speed commanded, metres per second"
    )
    entry_trims: list[int] | None = Field(default=None, description="trims left by maneuvers that were flown")

    def conditions(self) -> Conditions:
        """Returns the conditions that the file states."""
        rule, entries = self.maneuver_end, self.entry_trims
        return Conditions(
            wind=self.wind,
            altitude=self.altitude,
            maneuver_end=None if rule is None else rule.rule(),
            trim_error_kind=self.trim_error_kind,
            coasting_range=self.coasting_range,
            vehicle_hash=self.vehicle_hash,
            speed_range=self.speed_range,
            entry_trims=None if entries is None else tuple(entries),
        )


def conditions_content(conditions: Conditions) -> dict[str, Any]:
    """Returns the content of a file for conditions."""
    rule, entries = conditions.maneuver_end, conditions.entry_trims
    return {
        "wind": conditions.wind,
        "altitude": conditions.altitude,
        "maneuver_end": None if rule is None else maneuver_end_content(rule),
        "trim_error_kind": conditions.trim_error_kind,
        "coasting_range": conditions.coasting_range,
        "vehicle_hash": conditions.vehicle_hash,
        "speed_range": conditions.speed_range,
        "entry_trims": None if entries is None else list(entries),
    }
