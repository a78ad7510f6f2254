"""Libraries as files: `libraries/NAME.json`, schemas `maneuver-library/2` and /1."""

from pathlib import Path
from typing import Any

from flight.schema import json_schema, parse_json, read_text

from .library import Library


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
    return parse_json(text, source, Library)


def library_text(library: Library) -> str:
    """Returns a library as file text; numbers round-trip exactly."""
    return library.text


def library_hash(library: Library) -> str:
    """Returns the SHA-256 of the library's text, as hexadecimal digits."""
    return library.sha256


def library_json_schema() -> dict[str, Any]:
    """Returns the JSON Schema of library files."""
    return json_schema(Library) | {"description": "A motion-primitive library, in SI units."}
