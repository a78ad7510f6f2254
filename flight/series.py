"""Topics and their messages: named, with units, as columns over time."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True, slots=True)
class Field:
    """One number of a topic: its name, its unit, and what it means."""

    name: str
    unit: str
    meaning: str


@dataclass(frozen=True, slots=True)
class Topic:
    """A channel of the log: every message holds all fields, as doubles, in this order."""

    name: str
    message: str
    meaning: str
    fields: tuple[Field, ...]

    def __post_init__(self) -> None:
        """Keeps the wire layout fixed: field numbers above 15 would take a second tag byte."""
        assert len(self.fields) <= 15, self.name

    @property
    def field_names(self) -> tuple[str, ...]:
        """Names of the fields, in their order."""
        return tuple(field.name for field in self.fields)


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
        """Returns the column of a field."""
        return np.asarray(self.values[:, self.topic.field_names.index(field)])

    def __len__(self) -> int:
        return len(self.time)
