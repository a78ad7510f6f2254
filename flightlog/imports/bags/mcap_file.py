"""Messages of an MCAP file, compressed or not, without its summary."""

import io
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import zstandard
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader

from flight.errors import FlightError
from flightlog.imports.mcap_messages import Decoder, decoder_of

from .raw_message import RawMessage

LARGEST_RECORD = 256 * 1024**2
"""Largest record that is read, in bytes."""

ZSTD = b"\x28\xb5\x2f\xfd"
"""First bytes of data compressed by zstd."""

_UNREADABLE = (McapError, zstandard.ZstdError, struct.error, ValueError, KeyError, EOFError)


class McapBag:
    """MCAP file, read as a stream."""

    def __init__(self, path: Path) -> None:
        """Opens nothing yet.

        Args:
            path: file, or file compressed by zstd as a whole.
        """
        self._path = path

    def topics(self) -> Mapping[str, str]:
        """Returns the schema, or the encoding, by topic."""
        found: dict[str, str] = {}
        schemas: dict[int, Schema] = {}
        for record in self._summary_records():
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                schema = schemas.get(record.schema_id)
                found[record.topic] = schema.name if schema else record.message_encoding
        return found

    def messages(self, topics: Sequence[str]) -> Iterator[RawMessage]:
        """Yields the messages of some topics in the order of the file."""
        schemas: dict[int, Schema] = {}
        channels: dict[int, tuple[Channel, str]] = {}
        decoders: dict[int, Decoder] = {}
        for record in self._records():
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel) and record.topic in topics:
                schema = schemas.get(record.schema_id)
                channels[record.id] = record, schema.name if schema else ""
                if record.id not in decoders:
                    decoders[record.id] = decoder_of(record, schema)
            elif isinstance(record, Message) and record.channel_id in channels:
                channel, name = channels[record.channel_id]
                decode = _Plain(decoders[record.channel_id], record.data)
                yield RawMessage(channel.topic, name, record.log_time, decode)

    def _summary_records(self) -> Iterator[Any]:
        """Yields schemas and channels of the summary, or of the whole file."""
        with self._open() as stream:
            summary = None
            if isinstance(stream, io.BufferedReader):
                try:
                    summary = make_reader(stream, validate_crcs=True).get_summary()
                except _UNREADABLE:
                    summary = None
            if summary is not None and summary.channels:
                yield from summary.schemas.values()
                yield from summary.channels.values()
                return
        yield from self._records()

    def _records(self) -> Iterator[Any]:
        with self._open() as stream:
            yield from StreamReader(stream, validate_crcs=True, record_size_limit=LARGEST_RECORD).records

    @contextmanager
    def _open(self) -> Iterator[IO[bytes]]:
        try:
            with self._path.open("rb") as stream:
                compressed = stream.read(len(ZSTD)) == ZSTD
                stream.seek(0)
                if compressed:
                    with zstandard.ZstdDecompressor().stream_reader(stream, read_across_frames=True) as plain:
                        yield _WholeReads(plain)  # type: ignore[misc]
                else:
                    yield stream
        except OSError as error:
            raise FlightError(f"cannot be read: {error.strerror or error}") from None


class _WholeReads:
    """Stream that returns as many bytes as asked for, until its end."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def read(self, size: int = -1) -> bytes:
        """Returns the next bytes."""
        parts, left = [], size
        while left:
            part = self._stream.read(left)
            if not part:
                break
            parts.append(part)
            left -= len(part)
        return b"".join(parts)


class _Plain:
    """Decoder of one message, which may be compressed by itself."""

    def __init__(self, decode: Callable[[bytes], Any], data: bytes) -> None:
        self._decode, self._data = decode, data

    def __call__(self) -> Any:
        data = self._data
        if data.startswith(ZSTD):
            data = zstandard.ZstdDecompressor().decompressobj().decompress(data)
        return self._decode(data)
