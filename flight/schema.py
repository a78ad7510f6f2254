"""The boundary between files and values: strict models, and errors that name the place in one line."""

import json
import tomllib
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError

from .errors import BadFileError, FlightError

LARGEST_FILE = 16 * 1024 * 1024
"""Bytes; far above any library or mission, far below what would fill the memory."""

Model = TypeVar("Model", bound="FileModel")
Value = TypeVar("Value")


class RepeatedKeyError(ValueError):
    """An object of a JSON text has a key twice."""


class FileModel(BaseModel):
    """Base of what stands in files: no unknown keys, no silent conversions, immutable."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


def schema_named(known: str) -> AfterValidator:
    """Returns what refuses every schema but one, by name."""
    return AfterValidator(partial(refuse_other_schema, known=known))


def refuse_other_schema(schema: str, known: str) -> str:
    """Returns the name of a file's schema, if it is the one that is known.

    Raises:
        ValueError: it is another; says both.
    """
    if schema != known:
        newer = schema.partition("/")[0] == known.partition("/")[0]
        instead = "; another version may read it" if newer else ""
        raise ValueError(f"this program reads {known}, the file is {schema:.60}{instead}")
    return schema


def read_toml(path: Path, model: type[Model], build: Callable[[Model], Value]) -> Value:
    """Reads a TOML file into a model, and builds a value from the model.

    Raises:
        BadFileError: names the file and the first place in it that is wrong.
    """
    text = read_text(path)
    try:
        # A strict model takes arrays for tuples only from JSON.
        as_json = json.dumps(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise BadFileError(path, f"is not TOML: {error}") from None
    except TypeError:
        raise BadFileError(path, "expected numbers, texts and arrays, got a date or time") from None
    except RecursionError:
        raise BadFileError(path, "is nested too deeply") from None
    return parse_json(as_json, path, model, build)


def parse_json(
    text: str | bytes, source: Path | str, model: type[Model], build: Callable[[Model], Value]
) -> Value:
    """Parses JSON text into a model, and builds a value from the model.

    Args:
        text: the document.
        source: what to call it in an error.
        model: what its content must look like.
        build: makes the value; a `ValueError` or `FlightError` of its own names the place.

    Raises:
        BadFileError: names the source and the first place in it that is wrong.
    """
    try:
        refuse_repeated_keys(text)
        return build(model.model_validate_json(text))
    except ValidationError as error:
        raise BadFileError(source, first_problem(error)) from None
    except (ValueError, FlightError) as error:
        raise BadFileError(source, str(error)) from None


def refuse_repeated_keys(text: str | bytes) -> None:
    """Refuses JSON text with a key twice in one object: readers differ in which of the two they take.

    Raises:
        RepeatedKeyError: there is one; says which.
    """
    try:
        json.loads(text, object_pairs_hook=_Keys)
    except RepeatedKeyError:
        raise
    except (ValueError, RecursionError):
        # What is no JSON is refused with its place by whoever reads it next.
        return


class _Keys:
    """Stands for an object of which only the keys were looked at."""

    def __init__(self, pairs: list[tuple[str, object]]) -> None:
        keys: set[str] = set()
        for key, _ in pairs:
            if key in keys:
                raise RepeatedKeyError(f"{key:.60}: stands twice in one object, expected it once")
            keys.add(key)


def read_text(path: Path) -> str:
    """Returns the text of a small UTF-8 file.

    Raises:
        BadFileError: the file cannot be read, is too large, or is not UTF-8.
    """
    try:
        with path.open("rb") as file:
            # A device says no size, and need have no end.
            content = file.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise BadFileError(path, f"expected at most {LARGEST_FILE} bytes, got more")
        return content.decode()
    except OSError as error:
        raise BadFileError(path, f"cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise BadFileError(path, f"expected UTF-8 text, got byte {error.object[error.start]:#x}") from None


def first_problem(error: ValidationError) -> str:
    """Returns the first of a model's complaints as one line: place, what is wrong, what came."""
    details = error.errors(include_url=False)
    first = details[0]
    place = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in first["loc"]).lstrip(".")
    message = "is missing" if first["type"] == "missing" else first["msg"].removeprefix("Value error, ")
    came = (
        "" if first["type"] in {"missing", "value_error", "json_invalid"} else f", got {first['input']!r:.60}"
    )
    # Of a file of another kind, nothing but that is worth saying.
    more = f" (and {len(details) - 1} more)" if len(details) > 1 and first["loc"] != ("schema",) else ""
    return f"{place or 'document'}: {message}{came}{more}"
