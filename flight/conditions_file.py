"""Conditions as they stand in a library file."""

from typing import Any

from pydantic import Field, FiniteFloat

from .conditions import Conditions, TrimErrorKind
from .file_model import FileModel
from .maneuver_end_file import ManeuverEndPart, maneuver_end_content


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
