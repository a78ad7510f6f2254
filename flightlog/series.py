"""Topics and their messages as columns over time."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from flight.errors import FlightError


class MissingFieldError(FlightError):
    """Missing field of a series."""

    def __init__(self, topic: "Topic", field: str) -> None:
        super().__init__(f"the log's {topic.name} has no {field}; it has {list(topic.field_names)}")


@dataclass(frozen=True, slots=True)
class Field:
    """Field of a topic: name, unit and meaning."""

    name: str
    unit: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Topic:
    """Channel of the log whose messages hold all fields as doubles.

    Attributes:
        name: name of the channel.
        message: name of its schema.
        meaning: meaning in words.
        fields: fields of a message, in order.
        numbers: increasing field numbers on the wire; from 1 unless some of the contract's fields are absent.
    """

    name: str
    message: str
    meaning: str
    fields: tuple[Field, ...]
    numbers: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        """Checks the wire layout: field numbers up to 15."""
        if not self.numbers:
            object.__setattr__(self, "numbers", tuple(range(1, len(self.fields) + 1)))
        assert len(self.numbers) == len(self.fields), self.name
        assert max(self.numbers, default=0) <= 15, self.name

    @property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields in order."""
        return tuple(field.name for field in self.fields)

    def only(self, names: Iterable[str]) -> "Topic":
        """Returns the topic with some of its fields, numbers unchanged."""
        selected = set(names)
        pairs = [pair for pair in zip(self.fields, self.numbers, strict=True) if pair[0].name in selected]
        fields, numbers = zip(*pairs, strict=True)
        return replace(self, fields=fields, numbers=numbers)


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """Messages of one topic.

    Attributes:
        topic: topic of the columns.
        time: seconds since the flight's start, not decreasing.
        values: one row for each time, one column for each field.
    """

    topic: Topic
    time: Float[np.ndarray, "n"]
    values: Float[np.ndarray, "n fields"]

    def __post_init__(self) -> None:
        """Checks the shape against the topic."""
        if self.values.shape != (len(self.time), len(self.topic.fields)):
            raise ValueError(
                f"{self.topic.name}: expected values of shape ({len(self.time)}, {len(self.topic.fields)}), "
                f"got {self.values.shape}"
            )

    def __getitem__(self, field: str) -> Float[np.ndarray, "n"]:
        """Returns the column of a field.

        Raises:
            MissingFieldError: the series lacks the field.
        """
        if not self.has_fields(field):
            raise MissingFieldError(self.topic, field)
        return np.asarray(self.values[:, self.topic.field_names.index(field)])

    def has_fields(self, *fields: str) -> bool:
        """Returns True if the series has all these fields."""
        return set(fields) <= set(self.topic.field_names)

    def __len__(self) -> int:
        return len(self.time)
