"""Dataclasses that are their own file format."""

import operator
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Annotated, Any, ClassVar, TypeVar, cast, get_origin

from pydantic import ConfigDict, Field, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

from .schema import FileModel

Value = TypeVar("Value")


class FileValue:
    """Base class of dataclasses that are their own file format.

    A file states every field that is not None, whether or not Python has a default for it, but for those that
    are `Omittable`. What a value works out by itself (`init=False`) is stated too, and worked out again.
    """

    __slots__ = ()
    __pydantic_config__: ClassVar[ConfigDict] = FileModel.model_config

    @classmethod
    def __get_pydantic_core_schema__(cls, source: type, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Returns pydantic's schema with the fields in their order."""
        schema: Any = handler(source)
        stated = {field["name"]: field for field in schema["schema"]["fields"]}
        for field in stated.values():
            inner = field["schema"]
            # Otherwise missing keys would be filled with defaults silently.
            if inner["type"] == "default" and inner.get("default", "") is not None:
                field["schema"] = inner if "serialization_exclude_if" in field else inner["schema"]
            field.pop("init", None)
        schema["schema"]["fields"] = [stated[field.name] for field in fields(source)]
        return cast(CoreSchema, schema)


@dataclass(frozen=True, slots=True)
class InForm:
    """Annotation of a value whose form in files differs from its type.

    Attributes:
        form: type of that form.
        load: makes the value of it; raises `ValueError` for invalid content.
        dump: makes it of the value.
    """

    form: Any
    load: Callable[[Any], object]
    dump: Callable[[Any], object]

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Returns the schema of the form in files."""
        form = handler.generate_schema(self.form)
        back = core_schema.plain_serializer_function_ser_schema(self.dump, return_schema=form)
        return core_schema.no_info_after_validator_function(self.load, form, serialization=back)


class _NullIsEmpty:
    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        empty = (get_origin(source) or source)()
        return core_schema.no_info_after_validator_function(
            lambda value: empty if value is None else value, core_schema.nullable_schema(handler(source))
        )


Omittable = Annotated[Value, _NullIsEmpty(), Field(exclude_if=operator.not_)]
"""A text, number or tuple that files omit if it is empty or 0; null means the same."""

Share = Annotated[float, Field(ge=0, le=1)]
"""A part of a whole, from 0 to 1."""
