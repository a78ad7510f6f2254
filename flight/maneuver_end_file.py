"""The maneuver-end rule as it stands in files: libraries and campaigns write it alike."""

from typing import Any

from pydantic import Field, FiniteFloat

from .file_model import FileModel
from .maneuver_end import Band, ManeuverEnd


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
