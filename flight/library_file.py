"""Libraries as files: `libraries/NAME.json`, schema `maneuver-library/1`."""

import hashlib
import json
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, Field, FiniteFloat, JsonValue, PositiveInt, WithJsonSchema

from .conditions import Conditions, TrimErrorKind
from .file_model import FileModel, parse_json, read_text
from .library import Library
from .maneuver import Maneuver, ManeuverError
from .maneuver_end_file import ManeuverEndPart, maneuver_end_content
from .se2 import SE2, Twist
from .statistics import ScalarStatistics, Statistics
from .trim import Trim

SCHEMA = "maneuver-library/1"


class _Velocity(FileModel):
    """Body velocity, or its signed error."""

    forward: FiniteFloat = Field(description="metres per second")
    side: FiniteFloat = Field(description="metres per second, to the right")
    yaw_rate: FiniteFloat = Field(description="radians per second, right turns positive")


class _Scalar(FileModel):
    mean: FiniteFloat
    standard_deviation: FiniteFloat = Field(ge=0)
    largest_deviation: FiniteFloat = Field(ge=0)


class _Statistics(FileModel):
    """How the errors of one primitive were found."""

    samples: PositiveInt
    timeouts: int = Field(ge=0)
    coverage: FiniteFloat = Field(ge=0, le=1, description="share of future samples inside all bounds at once")
    confidence: FiniteFloat = Field(ge=0, le=1)
    scalars: dict[str, _Scalar]


class _Trim(FileModel):
    id: int
    name: str
    velocity: _Velocity
    error: _Velocity = Field(description="signed; gamma scales it")
    statistics: _Statistics | None = None


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
    statistics: _Statistics | None = None
    notes: str | None = None


class _Conditions(FileModel):
    wind: str
    altitude: FiniteFloat | None = None
    maneuver_end: ManeuverEndPart | None = None
    trim_error_kind: TrimErrorKind
    coasting_range: tuple[FiniteFloat, FiniteFloat] | None = None


def _known_schema(schema: str) -> str:
    if schema != SCHEMA:
        raise ValueError(f"this program reads {SCHEMA}, the file is {schema}; another version may read it")
    return schema


class LibraryFile(FileModel):
    """A motion-primitive library, in SI units."""

    schema_name: Annotated[str, AfterValidator(_known_schema), WithJsonSchema({"const": SCHEMA})] = Field(
        alias="schema"
    )
    name: str
    description: str
    vehicle: str
    conditions: _Conditions
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
        conditions=_to_conditions(content.conditions),
        provenance=content.provenance,
    )


def _to_trim(content: _Trim) -> Trim:
    return Trim(
        id=content.id,
        name=content.name,
        velocity=Twist(**content.velocity.model_dump()),
        error=Twist(**content.error.model_dump()),
        statistics=_to_statistics(content.statistics),
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
    )


def _to_statistics(content: _Statistics | None) -> Statistics | None:
    if content is None:
        return None
    scalars = tuple(ScalarStatistics(name, **scalar.model_dump()) for name, scalar in content.scalars.items())
    return Statistics(content.samples, content.timeouts, content.coverage, content.confidence, scalars)


def _to_conditions(content: _Conditions) -> Conditions:
    rule = content.maneuver_end
    return Conditions(
        wind=content.wind,
        altitude=content.altitude,
        maneuver_end=None if rule is None else rule.rule(),
        trim_error_kind=content.trim_error_kind,
        coasting_range=content.coasting_range,
    )


def _from_library(library: Library) -> LibraryFile:
    rule = library.conditions.maneuver_end
    content = {
        "schema": SCHEMA,
        "name": library.name,
        "description": library.description,
        "vehicle": library.vehicle,
        "conditions": {
            "wind": library.conditions.wind,
            "altitude": library.conditions.altitude,
            "maneuver_end": None if rule is None else maneuver_end_content(rule),
            "trim_error_kind": library.conditions.trim_error_kind,
            "coasting_range": library.conditions.coasting_range,
        },
        "provenance": dict(library.provenance),
        "trims": [_trim_content(trim) for trim in library.trims],
        "maneuvers": [_maneuver_content(maneuver) for maneuver in library.maneuvers],
    }
    return LibraryFile.model_validate(content)


def _trim_content(trim: Trim) -> dict[str, Any]:
    return {
        "id": trim.id,
        "name": trim.name,
        "velocity": _twist_content(trim.velocity),
        "error": _twist_content(trim.error),
        "statistics": _statistics_content(trim.statistics),
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
        "statistics": _statistics_content(maneuver.statistics),
        "notes": maneuver.notes or None,
    }


def _twist_content(twist: Twist) -> dict[str, float]:
    return {"forward": twist.forward, "side": twist.side, "yaw_rate": twist.yaw_rate}


def _statistics_content(statistics: Statistics | None) -> dict[str, Any] | None:
    if statistics is None:
        return None
    return {
        "samples": statistics.samples,
        "timeouts": statistics.timeouts,
        "coverage": statistics.coverage,
        "confidence": statistics.confidence,
        "scalars": {
            scalar.name: {
                "mean": scalar.mean,
                "standard_deviation": scalar.standard_deviation,
                "largest_deviation": scalar.largest_deviation,
            }
            for scalar in statistics.scalars
        },
    }
