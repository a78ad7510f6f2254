"""Topics and their messages: named, with units, as columns over time."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError


class MissingFieldError(FlightError):
    """A series lacks a number that is needed; absent is not zero."""

    def __init__(self, topic: "Topic", field: str) -> None:
        super().__init__(f"the log's {topic.name} has no {field}; it has {list(topic.field_names)}")


@dataclass(frozen=True, slots=True)
class Field:
    """One number of a topic: its name, its unit, and what it means."""

    name: str
    unit: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Topic:
    """A channel of the log: every message holds all fields, as doubles, in this order.

    Attributes:
        name: of the channel.
        message: name of its schema.
        meaning: in words.
        fields: what a message holds.
        numbers: of the fields on the wire, rising; from 1 on unless some of the contract's fields are absent.
    """

    name: str
    message: str
    meaning: str
    fields: tuple[Field, ...]
    numbers: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Keeps the wire layout fixed: field numbers above 15 would take a second tag byte."""
        if not self.numbers:
            object.__setattr__(self, "numbers", tuple(range(1, len(self.fields) + 1)))
        assert len(self.numbers) == len(self.fields), self.name
        assert max(self.numbers, default=0) <= 15, self.name

    @property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields, in their order."""
        return tuple(field.name for field in self.fields)

    def only(self, names: Iterable[str]) -> "Topic":
        """Returns the topic of a log that knows no more than some of its fields; they keep their numbers."""
        wanted = set(names)
        kept = [pair for pair in zip(self.fields, self.numbers, strict=True) if pair[0].name in wanted]
        fields, numbers = zip(*kept, strict=True)
        return replace(self, fields=fields, numbers=numbers)


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """The messages of one topic.

    Attributes:
        topic: what the columns are.
        time: seconds since the flight's start, not decreasing.
        values: a row for each time, a column for each field.
    """

    topic: Topic
    time: Float[np.ndarray, "n"]
    values: Float[np.ndarray, "n fields"]

    def __post_init__(self) -> None:
        """Holds the shape to the topic."""
        if self.values.shape != (len(self.time), len(self.topic.fields)):
            raise ValueError(
                f"{self.topic.name}: values must be ({len(self.time)}, {len(self.topic.fields)}), "
                f"got {self.values.shape}"
            )

    def __getitem__(self, field: str) -> Float[np.ndarray, "n"]:
        """Returns the column of a field.

        Raises:
            MissingFieldError: the log does not know it.
        """
        if not self.has_fields(field):
            raise MissingFieldError(self.topic, field)
        return np.asarray(self.values[:, self.topic.field_names.index(field)])

    def has_fields(self, *fields: str) -> bool:
        """Whether the log knows all these fields; one of another vehicle may lack some."""
        return set(fields) <= set(self.topic.field_names)

    def __len__(self) -> int:
        return len(self.time)
