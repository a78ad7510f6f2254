"""Libraries as files: `libraries/NAME.json`, schema `maneuver-library/1`."""

import hashlib
import json
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, FiniteFloat, JsonValue, WithJsonSchema

from flight.schema import FileModel, parse_json, read_text, schema_named
from flight.se2 import SE2

from .library import Library
from .library_schema import (
    AveragedErrorPart,
    ConditionsPart,
    InterpolatedPart,
    StatisticsPart,
    VelocityPart,
    averaged_error_content,
    conditions_content,
    interpolated_content,
    statistics_content,
    velocity_content,
)
from .maneuver import Maneuver, ManeuverError
from .statistics import InterpolationClaim, Statistics
from .trim import Trim

SCHEMA = "maneuver-library/1"


class _Trim(FileModel):
    id: int
    name: str
    velocity: VelocityPart
    error: VelocityPart = Field(description="signed; gamma scales it")
    statistics: StatisticsPart | None = None
    averaged: list[AveragedErrorPart] | None = Field(
        default=None, description="errors averaged over a coast, by its duration"
    )
    interpolated: InterpolatedPart | None = None


class _Displacement(FileModel):
    forward: FiniteFloat = Field(description="metres, along the heading at entry")
    side: FiniteFloat = Field(description="metres, to the right of the heading at entry")


class _ManeuverError(FileModel):
    duration: FiniteFloat
    forward: FiniteFloat
    side: FiniteFloat
    heading_change: FiniteFloat


class _Maneuver(FileModel):
    id: int
    from_trim: int = Field(alias="from")
    to_trim: int = Field(alias="to")
    duration: FiniteFloat = Field(ge=0, description="seconds")
    displacement: _Displacement
    heading_change: FiniteFloat = Field(description="radians, clockwise positive")
    error: _ManeuverError = Field(description="signed; gamma scales it")
    statistics: StatisticsPart | None = None
    notes: str | None = None
    interpolated: InterpolatedPart | None = None


class LibraryFile(FileModel):
    """A motion-primitive library, in SI units."""

    schema_name: Annotated[str, schema_named(SCHEMA), WithJsonSchema({"const": SCHEMA})] = Field(
        alias="schema"
    )
    name: str
    description: str
    vehicle: str
    conditions: ConditionsPart
    provenance: dict[str, JsonValue]
    trims: list[_Trim] = Field(min_length=1)
    maneuvers: list[_Maneuver]


def read_library(path: Path) -> Library:
    """Reads a library file.

    Raises:
        BadFileError: the file is missing, broken, newer, or contradicts itself; names the place.
    """
    return parse_library(read_text(path), path)


def parse_library(text: str | bytes, source: Path | str) -> Library:
    """Parses the text of a library; `source` is what errors call it.

    Raises:
        BadFileError: as `read_library`.
    """
    return parse_json(text, source, LibraryFile, _to_library)


def library_text(library: Library) -> str:
    """Returns the text of a library file: numbers round-trip exactly, equal libraries give equal bytes."""
    content = _from_library(library).model_dump(by_alias=True, exclude_none=True)
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def library_hash(library: Library) -> str:
    """Returns the SHA-256 of the library's text, as hexadecimal digits."""
    return hashlib.sha256(library_text(library).encode()).hexdigest()


def library_json_schema() -> dict[str, Any]:
    """Returns the JSON Schema of library files."""
    return LibraryFile.model_json_schema(by_alias=True)


def _to_library(content: LibraryFile) -> Library:
    return Library(
        name=content.name,
        description=content.description,
        vehicle=content.vehicle,
        trims=tuple(_to_trim(trim) for trim in content.trims),
        maneuvers=tuple(_to_maneuver(maneuver) for maneuver in content.maneuvers),
        conditions=content.conditions.conditions(),
        provenance=content.provenance,
    )


def _to_trim(content: _Trim) -> Trim:
    return Trim(
        id=content.id,
        name=content.name,
        velocity=content.velocity.twist(),
        error=content.error.twist(),
        statistics=_to_statistics(content.statistics),
        averaged=tuple(part.averaged_error() for part in content.averaged or ()),
        interpolated=_to_claim(content.interpolated),
    )


def _to_maneuver(content: _Maneuver) -> Maneuver:
    return Maneuver(
        id=content.id,
        from_trim=content.from_trim,
        to_trim=content.to_trim,
        duration=content.duration,
        displacement=SE2(content.displacement.forward, content.displacement.side, content.heading_change),
        error=ManeuverError(**content.error.model_dump()),
        statistics=_to_statistics(content.statistics),
        notes=content.notes or "",
        interpolated=_to_claim(content.interpolated),
    )


def _to_statistics(content: StatisticsPart | None) -> Statistics | None:
    return None if content is None else content.statistics()


def _to_claim(content: InterpolatedPart | None) -> InterpolationClaim | None:
    return None if content is None else content.interpolated()


def _from_library(library: Library) -> LibraryFile:
    content = {
        "schema": SCHEMA,
        "name": library.name,
        "description": library.description,
        "vehicle": library.vehicle,
        "conditions": conditions_content(library.conditions),
        "provenance": dict(library.provenance),
        "trims": [_trim_content(trim) for trim in library.trims],
        "maneuvers": [_maneuver_content(maneuver) for maneuver in library.maneuvers],
    }
    return LibraryFile.model_validate(content)


def _trim_content(trim: Trim) -> dict[str, Any]:
    return {
        "id": trim.id,
        "name": trim.name,
        "velocity": velocity_content(trim.velocity),
        "error": velocity_content(trim.error),
        "statistics": statistics_content(trim.statistics),
        "averaged": [averaged_error_content(part) for part in trim.averaged] or None,
        "interpolated": interpolated_content(trim.interpolated),
    }


def _maneuver_content(maneuver: Maneuver) -> dict[str, Any]:
    error = maneuver.error
    return {
        "id": maneuver.id,
        "from": maneuver.from_trim,
        "to": maneuver.to_trim,
        "duration": maneuver.duration,
        "displacement": {"forward": maneuver.displacement.x, "side": maneuver.displacement.y},
        "heading_change": maneuver.displacement.heading,
        "error": {
            "duration": error.duration,
            "forward": error.forward,
            "side": error.side,
            "heading_change": error.heading_change,
        },
        "statistics": statistics_content(maneuver.statistics),
        "notes": maneuver.notes or None,
        "interpolated": interpolated_content(maneuver.interpolated),
    }
