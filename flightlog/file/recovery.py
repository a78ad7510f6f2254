"""Recovery of the undamaged parts of an MCAP file.

Chunks and attachments are accepted by their checksums, other records if they parse to the last byte. After a
break in the chain of records the search resumes at the next complete chunk. Files of any writer are accepted.
"""

import io
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import Attachment, Channel, Chunk, Header, Message, Metadata, Schema, Statistics
from mcap.stream_reader import get_chunk_data_stream
from mcap.writer import Writer

from .reader import MAGIC
from .writer import HEADER_METADATA, LARGEST_LOG

RECOVERY_METADATA = "recovery"
"""Name of the metadata record that marks a recovered file."""

_HEAD = struct.Struct("<BQ")
# Times, size, checksum, then length and name of the compression.
_CHUNK_NAME = 9 + 8 + 8 + 8 + 4
_LONGEST_NAME = 16
_LAST_OPCODE = Opcode.DATA_END
_UNREADABLE = (
    McapError,
    ValueError,
    RuntimeError,
    OverflowError,
    EOFError,
    struct.error,
    zstandard.ZstdError,
    MemoryError,
)


class _DamagedError(ValueError):
    """Record that contradicts its own header."""


@dataclass(slots=True)
class Salvage:
    """Undamaged content of a file, and counts of the damage.

    Attributes:
        header: profile and writer; None if lost.
        schemas: schemas by id.
        channels: channels by id.
        messages: messages in file order.
        attachments: attachments in file order.
        metadata: metadata in file order.
        announced: number of messages by the file's statistics; None if lost.
        damaged_chunks: chunks with wrong checksum or content.
        damaged_attachments: attachments with wrong checksum.
        skipped_bytes: bytes outside any recognised record.
        orphans: messages of channels without description.
        ended: True if the data-end record was found.
        data_intact: True if the data match the checksum of that record; None if it has none.
    """

    header: Header | None = None
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    messages: list[Message] = field(default_factory=list)
    attachments: list[Attachment] = field(default_factory=list)
    metadata: list[Metadata] = field(default_factory=list)
    announced: int | None = None
    damaged_chunks: int = 0
    damaged_attachments: int = 0
    skipped_bytes: int = 0
    orphans: int = 0
    ended: bool = False
    data_intact: bool | None = None

    @property
    def lossless(self) -> bool:
        """True if every message and attachment was provably recovered."""
        if self.data_intact is not None:
            return self.data_intact
        damage = self.damaged_chunks or self.damaged_attachments or self.skipped_bytes or self.orphans
        return self.ended and not damage and self.announced in {None, len(self.messages)}

    @property
    def last_time(self) -> float:
        """Time of the last message in seconds, on the file's clock."""
        return max((message.log_time for message in self.messages), default=0) * 1e-9


def salvage(content: bytes) -> Salvage:
    """Returns the undamaged content of an MCAP file's bytes."""
    found, unpacked = Salvage(), 0
    for opcode, start, end in _records(content, found):
        body = content[start:end]
        try:
            if opcode == Opcode.CHUNK:
                unpacked += _add_chunk(body, found, limit=LARGEST_LOG - unpacked)
            elif opcode == Opcode.DATA_END:
                _check_data_end(content[: start - _HEAD.size], body, found)
            else:
                _add_record(opcode, body, found)
        except _UNREADABLE:
            if opcode == Opcode.CHUNK:
                found.damaged_chunks += 1
            elif opcode == Opcode.ATTACHMENT:
                found.damaged_attachments += 1
            else:
                found.skipped_bytes += end - start
    known = [message for message in found.messages if message.channel_id in found.channels]
    found.orphans, found.messages = len(found.messages) - len(known), known
    return found


def recovered_bytes(found: Salvage) -> bytes:
    """Returns a complete MCAP file of the salvaged content.

    The outcome of a flight log with losses is set to `recovered with loss`.
    """
    stream = io.BytesIO()
    writer = Writer(stream, enable_data_crcs=True)
    writer.start(
        profile=found.header.profile if found.header else "",
        library=found.header.library if found.header else "",
    )
    for metadata in found.metadata:
        content = dict(metadata.metadata)
        if metadata.name == HEADER_METADATA and not found.lossless:
            content["outcome"] = f"recovered with loss: complete up to {found.last_time:.2f} s at most"
        writer.add_metadata(metadata.name, content)
    writer.add_metadata(RECOVERY_METADATA, {"lossless": str(found.lossless).lower()})
    for part in found.attachments:
        writer.add_attachment(part.create_time, part.log_time, part.name, part.media_type, part.data)
    schemas = {
        number: writer.register_schema(schema.name, schema.encoding, schema.data)
        for number, schema in found.schemas.items()
    }
    channels = {
        number: writer.register_channel(
            channel.topic, channel.message_encoding, schemas.get(channel.schema_id, 0), channel.metadata
        )
        for number, channel in found.channels.items()
    }
    for message in found.messages:
        writer.add_message(
            channels[message.channel_id],
            message.log_time,
            message.data,
            message.publish_time,
            message.sequence,
        )
    writer.finish()  # type: ignore[no-untyped-call]
    return stream.getvalue()


def contains_salvage(content: bytes, found: Salvage) -> bool:
    """Returns True if a file, read anew, holds the salvaged messages."""
    reader = SeekingReader(io.BytesIO(content), validate_crcs=True, record_size_limit=LARGEST_LOG)
    try:
        read = reader.iter_messages(log_time_order=False)
        same = all(
            (channel.topic, message.log_time, message.data)
            == (found.channels[salvaged.channel_id].topic, salvaged.log_time, salvaged.data)
            for salvaged, (_, channel, message) in zip(found.messages, read, strict=True)
        )
        attachments = [part.data for part in reader.iter_attachments()]
    except _UNREADABLE:
        return False
    return same and attachments == [part.data for part in found.attachments]


def _records(content: bytes, found: Salvage) -> Iterator[tuple[int, int, int]]:
    """Yields opcode, begin and end of each record; counts skipped bytes."""
    position = len(MAGIC) if content.startswith(MAGIC) else _next_chunk(content, 0)
    found.skipped_bytes += 0 if content.startswith(MAGIC) else position
    last = len(content) - len(MAGIC) if content.endswith(MAGIC) else len(content)
    while position + _HEAD.size <= last:
        opcode, length = _HEAD.unpack_from(content, position)
        end = position + _HEAD.size + length
        if not 0 < opcode <= _LAST_OPCODE or end > last or not _is_plausible_chunk(content, position):
            resumed = _next_chunk(content, position + 1)
            found.skipped_bytes += resumed - position
            position = resumed
            continue
        yield opcode, position + _HEAD.size, end
        position = end
    found.skipped_bytes += max(last - position, 0)


def _next_chunk(content: bytes, position: int) -> int:
    """Returns the start of the next plausible chunk, or the end."""
    code = bytes([Opcode.CHUNK])
    while (position := content.find(code, position)) >= 0:
        if _is_plausible_chunk(content, position):
            return position
        position += 1
    return len(content)


def _is_plausible_chunk(content: bytes, position: int) -> bool:
    """Returns True unless a chunk's length contradicts its parts."""
    opcode, length = content[position], 0
    if opcode != Opcode.CHUNK:
        return True
    try:
        _, length = _HEAD.unpack_from(content, position)
        (name,) = struct.unpack_from("<I", content, position + _CHUNK_NAME)
        if name > _LONGEST_NAME:
            return False
        (size,) = struct.unpack_from("<Q", content, position + _CHUNK_NAME + 4 + name)
    except struct.error:
        return False
    return bool(length == _CHUNK_NAME - 9 + 4 + name + 8 + size and position + 9 + length <= len(content))


def _add_chunk(body: bytes, found: Salvage, *, limit: int) -> int:
    """Adds the messages of a verified chunk; returns its unpacked size."""
    chunk = Chunk.read(ReadDataStream(io.BytesIO(body)))
    if chunk.uncompressed_size > limit:
        raise _DamagedError(f"expected at most {limit} bytes, got {chunk.uncompressed_size}")
    stream, size = get_chunk_data_stream(chunk, validate_crc=True)
    if size != chunk.uncompressed_size:
        raise _DamagedError(f"expected {chunk.uncompressed_size} bytes, got {size}")
    part = Salvage()
    while stream.count < size:
        opcode, length = stream.read1(), stream.read8()
        _add_record(opcode, stream.read(length), part)
    found.schemas.update(part.schemas)
    found.channels.update(part.channels)
    found.messages.extend(part.messages)
    return size


def _check_data_end(before: bytes, body: bytes, found: Salvage) -> None:
    """Records the end of the data and verifies its checksum."""
    found.ended = True
    checksum = int.from_bytes(body, "little")
    found.data_intact = zlib.crc32(before) == checksum if checksum else None


def _add_record(opcode: int, body: bytes, found: Salvage) -> None:
    """Adds a record other than a chunk."""
    stream = ReadDataStream(io.BytesIO(body))
    match opcode:
        case Opcode.HEADER:
            found.header = Header.read(stream)
        case Opcode.SCHEMA:
            schema = Schema.read(stream)
            found.schemas[schema.id] = schema
        case Opcode.CHANNEL:
            channel = Channel.read(stream)
            found.channels[channel.id] = channel
        case Opcode.MESSAGE:
            found.messages.append(Message.read(stream, len(body)))
        case Opcode.METADATA:
            found.metadata.append(Metadata.read(stream))
        case Opcode.STATISTICS:
            found.announced = Statistics.read(stream).message_count
        case Opcode.ATTACHMENT:
            if zlib.crc32(body[:-4]) != int.from_bytes(body[-4:], "little"):
                raise _DamagedError("an attachment does not match its checksum")
            found.attachments.append(Attachment.read(stream))
            return
        case _:
            return
    if stream.count != len(body):
        raise _DamagedError(f"expected a record of {stream.count} bytes, got {len(body)}")
