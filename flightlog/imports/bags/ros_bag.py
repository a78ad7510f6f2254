"""Messages of ROS bags: ROS 1, and ROS 2 as recorded."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from flight.errors import FlightError

from .raw_message import RawMessage

NEEDED = "ROS bags and messages of ROS 1 need the package rosbags: pip install rosbags"


class RosBag:
    """ROS 1 bag, or ROS 2 bag in a folder or file."""

    def __init__(self, path: Path) -> None:
        """Opens nothing yet.

        Args:
            path: bag file, or folder with its metadata.
        """
        self._path = path

    def topics(self) -> Mapping[str, str]:
        """Returns the type of the messages by topic."""
        with self._reader() as reader:
            return {each.topic: each.msgtype for each in reader.connections}

    def messages(self, topics: Sequence[str]) -> Iterator[RawMessage]:
        """Yields the messages of some topics in the order of logging."""
        with self._reader() as reader:
            wanted = [each for each in reader.connections if each.topic in topics]
            for each, time, data in reader.messages(connections=wanted):
                yield RawMessage(
                    each.topic, each.msgtype, time, partial(reader.deserialize, data, each.msgtype)
                )

    def _reader(self) -> Any:
        try:
            from rosbags.highlevel import AnyReader
            from rosbags.typesys import Stores, get_typestore
        except ImportError:
            raise FlightError(NEEDED) from None
        store = None if self._path.suffix == ".bag" else get_typestore(Stores.LATEST)
        return AnyReader([self._path], default_typestore=store)


def ros1_decoder(name: str, definition: str) -> Callable[[bytes], Any]:
    """Returns a decoder of ROS 1 messages.

    Raises:
        FlightError: rosbags is not installed.
    """
    try:
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore
    except ImportError:
        raise FlightError(NEEDED) from None
    store, full = get_typestore(Stores.EMPTY), name if "/msg/" in name else name.replace("/", "/msg/", 1)
    store.register(get_types_from_msg(definition, full))
    return lambda data: store.deserialize_ros1(data, full)


def idl_decoder(name: str, definition: str) -> Callable[[bytes], Any]:
    """Returns a decoder of CDR messages that are described in IDL.

    Raises:
        FlightError: rosbags is not installed.
    """
    try:
        from rosbags.typesys import Stores, get_types_from_idl, get_typestore
    except ImportError:
        raise FlightError(NEEDED) from None
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_idl(definition))
    return lambda data: store.deserialize_cdr(data, name)
