"""Differences between two libraries, number by number."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from .library import Library
from .library_file import library_text

Value = str | float | int | bool | None
"""Value at a place; None where the library has no such place."""


@dataclass(frozen=True, slots=True)
class LibraryDifference:
    """One place in which two libraries differ.

    Attributes:
        part: `library`, `trim 3` or `maneuver 12`.
        place: within the part, such as `error.forward`; empty where the whole part is missing in one.
        first: value in the first library.
        second: value in the second library.
    """

    part: str
    place: str
    first: Value
    second: Value


def library_differences(first: Library, second: Library) -> tuple[LibraryDifference, ...]:
    """Returns the differences of two libraries; primitives are matched by id."""
    one, two = _parts(first), _parts(second)
    found: list[LibraryDifference] = []
    for part in [*one, *(part for part in two if part not in one)]:
        if part not in two:
            found.append(LibraryDifference(part, "", "there", None))
        elif part not in one:
            found.append(LibraryDifference(part, "", None, "there"))
        else:
            places = dict.fromkeys([*one[part], *two[part]])
            found += [
                LibraryDifference(part, place, one[part].get(place), two[part].get(place))
                for place in places
                if one[part].get(place) != two[part].get(place)
            ]
    return tuple(found)


def _parts(library: Library) -> dict[str, dict[str, Value]]:
    content = json.loads(library_text(library))
    parts = {f"trim {row['id']}": dict(_flatten(row)) for row in content.pop("trims")}
    parts |= {f"maneuver {row['id']}": dict(_flatten(row)) for row in content.pop("maneuvers")}
    return {"library": dict(_flatten(content)), **parts}


def _flatten(content: Any, place: str = "") -> Iterator[tuple[str, Value]]:
    """Yields every value with its path; an empty container is a value."""
    items = (
        content.items()
        if isinstance(content, dict)
        else enumerate(content)
        if isinstance(content, list)
        else ()
    )
    if not items:
        yield place, json.dumps(content) if isinstance(content, (dict, list)) else content
    for key, value in items:
        yield from _flatten(value, f"{place}.{key}" if place else str(key))
