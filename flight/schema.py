"""Strict parsing of files, with one-line errors that name the place."""

import json
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, TypeAdapter, ValidationError
from pydantic.config import ExtraValues

from .errors import BadFileError, FlightError

LARGEST_FILE = 16 * 1024 * 1024
"""Bytes; far above any library or mission, far below what would fill the memory."""

Value = TypeVar("Value")


_adapter: Callable[[Any], TypeAdapter[Any]] = cache(TypeAdapter)


class RepeatedKeyError(ValueError):
    """An object of a JSON text has a key twice."""


class FileModel(BaseModel):
    """Base class of file models: no unknown keys, no conversions, immutable."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, allow_inf_nan=False)


def schema_named(*known: str) -> AfterValidator:
    """Returns a validator that accepts only the known schemas."""
    return AfterValidator(lambda schema: check_schema_name(schema, *known))


def check_schema_name(schema: str, *known: str) -> str:
    """Returns the schema name of a file if it is known.

    Raises:
        ValueError: it is another.
    """
    if schema not in known:
        newer = schema.partition("/")[0] == known[0].partition("/")[0]
        instead = "; another version may read it" if newer else ""
        raise ValueError(f"expected {' or '.join(known)}, got {schema:.60}{instead}")
    return schema


def read_toml(path: Path, kind: type[Value]) -> Value:
    """Reads a TOML file into a `FileValue` or a `FileModel`.

    Raises:
        BadFileError: names the file and the first place in it that is wrong.
    """
    # What is strict takes arrays for tuples, and tables for values, only from JSON.
    return parse_json(json.dumps(toml_table(path)), path, kind)


def toml_table(path: Path) -> dict[str, Any]:
    """Reads a TOML file into plain JSON values.

    Raises:
        BadFileError: names the file, and where it is no TOML.
    """
    text = read_text(path)
    try:
        table = tomllib.loads(text)
        json.dumps(table)
    except ValueError as error:
        # Numbers of thousands of digits are refused by another error than TOML's own.
        raise BadFileError(path, f"is not TOML: {error}") from None
    except TypeError:
        raise BadFileError(path, "expected numbers, texts and arrays, got a date or time") from None
    except RecursionError:
        raise BadFileError(path, "is nested too deeply") from None
    return table


def parse_json(
    text: str | bytes, source: Path | str, kind: type[Value], *, extra: ExtraValues | None = None
) -> Value:
    """Parses JSON text into a value.

    Args:
        text: the document.
        source: name of the content in errors.
        kind: of the value: a `FileValue`, a `FileModel`, or a tuple of such.
        extra: handling of unknown keys, if not the kind's own.

    Raises:
        BadFileError: names the source and the first place in it that is wrong.
    """
    with refusing(source):
        check_unique_keys(text)
        value: Value = _adapter(kind).validate_json(text, extra=extra)
        return value


def json_content(value: object, *, exclude_none: bool = True) -> Any:
    """Returns a `FileValue` as JSON values, in the order of its fields."""
    return _adapter(type(value)).dump_python(value, mode="json", by_alias=True, exclude_none=exclude_none)


def json_schema(kind: type) -> dict[str, Any]:
    """Returns the JSON Schema of a value's type, described by docstrings."""
    schema = _adapter(kind).json_schema()
    for part in (schema, *schema["$defs"].values()):
        if "description" in part:
            part["description"] = part["description"].partition("\n\n")[0]
    return schema


@contextmanager
def refusing(source: Path | str) -> Iterator[None]:
    """Says in one line what is wrong with a file's content.

    Raises:
        BadFileError: names the source, and the first place in it that is wrong.
    """
    try:
        yield
    except ValidationError as error:
        raise BadFileError(source, first_problem(error)) from None
    except (ValueError, FlightError) as error:
        raise BadFileError(source, str(error)) from None


def check_unique_keys(text: str | bytes) -> None:
    """Checks that JSON text has no key twice in one object.

    Raises:
        RepeatedKeyError: there is one.
    """
    try:
        json.loads(text, object_pairs_hook=_UncheckedObject)
    except RepeatedKeyError:
        raise
    except (ValueError, RecursionError):
        # What is no JSON is refused with its place by whoever reads it next.
        return


class _UncheckedObject:
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
            # A device has no size and may have no end.
            content = file.read(LARGEST_FILE + 1)
        if len(content) > LARGEST_FILE:
            raise BadFileError(path, f"expected at most {LARGEST_FILE} bytes, got more")
        return content.decode()
    except OSError as error:
        raise BadFileError(path, f"cannot be read: {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise BadFileError(path, f"expected UTF-8 text, got byte {error.object[error.start]:#x}") from None


def first_problem(error: ValidationError) -> str:
    """Returns a model's first complaint in one line: place, problem, value."""
    details = error.errors(include_url=False)
    first = details[0]
    if first["type"] == "json_invalid":
        return f"is not JSON: {first['msg'].removeprefix('Invalid JSON: ')}"
    message = _WORDS.get(first["type"]) or first["msg"].removeprefix("Value error, ")
    if first["type"] == "value_error" and not first["loc"]:
        return message
    place = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in first["loc"]).lstrip(".")
    came = "" if first["type"] in {"missing", "value_error"} else f", got {first['input']!r:.60}"
    # Of a file of another kind, nothing but that is worth saying.
    more = f" (and {len(details) - 1} more)" if len(details) > 1 and first["loc"] != ("schema",) else ""
    return f"{place or 'document'}: {message}{came}{more}"


_WORDS = {"missing": "is missing", "unexpected_keyword_argument": "Extra inputs are not permitted"}
