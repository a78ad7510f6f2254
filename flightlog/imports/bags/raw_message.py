"""A message before it is decoded."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True, slots=True)
class RawMessage:
    """A message before it is decoded.

    Attributes:
        topic: topic of the message.
        schema: name of its type; empty without one.
        logged: log time, nanoseconds.
        decode: returns the message.
    """

    topic: str
    schema: str
    logged: int
    decode: Callable[[], Any]


class Bag(Protocol):
    """File of messages on topics."""

    def topics(self) -> Mapping[str, str]:
        """Returns the type of the messages by topic."""
        ...

    def messages(self, topics: Sequence[str]) -> Iterator[RawMessage]:
        """Yields the messages of some topics."""
        ...
