"""A flight log as the bytes of an MCAP file: what programs read, and beside it what viewers draw."""

import io
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.writer import Writer

from .log import CONVENTIONS, FlightLog
from .message_block import bytes_type, empty_messages, topic_type
from .series import Series, Topic
from .viewer_channels import ViewerChannel, ViewerTopic, viewer_channels

CHUNK_SECONDS = 10.0
LARGEST_LOG = 2 * 1024**3
"""Bytes of a file, and of its content decompressed."""

HEADER_METADATA, CONVENTIONS_METADATA = "flight", "conventions"

_MEDIA_TYPES = {".json": "application/json", ".xml": "application/xml"}


@dataclass(slots=True, eq=False)
class _Index:
    """Times and offsets of a channel's messages in one chunk; takes the place of the library's own index."""

    channel: int
    entries: list[np.ndarray[Any, Any]]

    def write(self, stream: RecordBuilder) -> None:
        """Writes the record, times and offsets as one piece."""
        content = b"".join(part.tobytes() for part in self.entries)
        stream.start_record(Opcode.MESSAGE_INDEX)
        stream.write2(self.channel)
        stream.write4(len(content))
        stream.write(content)
        stream.finish_record()  # type: ignore[no-untyped-call]


@dataclass(frozen=True, slots=True, eq=False)
class _Block:
    """Messages of one channel, in the order of their times; first and last time in nanoseconds."""

    channel: int
    messages: np.ndarray[Any, Any]
    first: int
    last: int

    @classmethod
    def of(cls, channel: int, messages: np.ndarray[Any, Any]) -> "_Block":
        times = messages["log_time"]
        first, last = (int(times[0]), int(times[-1])) if len(times) else (0, -1)
        return cls(channel, messages, first, last)


def log_bytes(log: FlightLog) -> bytes:
    """Returns the log as the bytes of an MCAP file; equal logs give equal bytes.

    What programs read and what viewers draw stand in chunks of their own, so that neither reads the other's.
    """
    stream = io.BytesIO()
    writer = Writer(stream, chunk_size=LARGEST_LOG, enable_data_crcs=True)
    writer.start(profile="", library="maneuver")
    writer.add_metadata(HEADER_METADATA, {key: str(value) for key, value in asdict(log.header).items()})
    writer.add_metadata(CONVENTIONS_METADATA, CONVENTIONS)
    for name, content in log.attachments.items():
        media_type = _MEDIA_TYPES.get(name[name.rfind(".") :], "application/octet-stream")
        writer.add_attachment(create_time=0, log_time=0, name=name, media_type=media_type, data=content)
    series = [_series_block(writer, part) for part in log.series.values()]
    drawn = [block for channel in viewer_channels(log) for block in _viewer_blocks(writer, channel)]
    last = max((block.last for block in (*series, *drawn)), default=0)
    period = round(CHUNK_SECONDS * 1e9)
    for start in range(0, max(last, 0) + 1, period):
        for blocks in (series, drawn):
            for block in blocks:
                _add(writer, block, start, start + period)
            writer._Writer__finalize_chunk()  # type: ignore[attr-defined]
    writer.finish()  # type: ignore[no-untyped-call]
    return stream.getvalue()


def _series_block(writer: Writer, series: Series) -> _Block:
    topic = series.topic
    schema = writer.register_schema(topic.message, "protobuf", topic_descriptors(topic))
    units = {field.name: f"{field.unit}; {field.meaning}" for field in topic.fields}
    channel = writer.register_channel(topic.name, "protobuf", schema, {"meaning": topic.meaning, **units})
    messages = _messages(channel, topic_type(topic), np.rint(series.time * 1e9).astype(np.uint64))
    for place in range(len(topic.fields)):
        messages[f"v{place}"] = series.values[:, place]
    return _Block.of(channel, messages)


def _viewer_blocks(writer: Writer, channel: ViewerChannel) -> Iterator[_Block]:
    topic = channel.topic
    name = topic.message.DESCRIPTOR.full_name
    schema = writer.register_schema(name, "protobuf", _message_descriptors(topic))
    number = writer.register_channel(topic.name, "protobuf", schema, {"meaning": topic.meaning})
    written = 0
    for times, rows in channel.blocks:
        messages = _messages(number, bytes_type(rows.shape[1]), times.astype(np.uint64), first=written)
        messages["payload"] = rows
        written += len(rows)
        yield _Block.of(number, messages)


def _messages(
    channel: int, kind: np.dtype[Any], times: np.ndarray, *, first: int = 0
) -> np.ndarray[Any, Any]:
    messages = empty_messages(kind, len(times))
    messages["channel"] = channel
    messages["sequence"] = first + np.arange(len(times))
    messages["log_time"] = messages["publish_time"] = times
    return messages


def _add(writer: Writer, block: _Block, start: int, end: int) -> None:
    """Adds the messages of a block that are in a window of nanoseconds, as one piece.

    The library's own `add_message` costs about 11 microseconds a message; this does the same to the same
    private members, which is why the dependency is pinned below its next major version and a test holds the
    two ways to the same content.
    """
    if block.last < start or block.first >= end:
        return
    rows = slice(*np.searchsorted(block.messages["log_time"], [start, end]).tolist())
    messages = block.messages[rows]
    if not len(messages):
        return
    times = messages["log_time"]
    first, last, count = int(times[0]), int(times[-1]), len(messages)
    builder = writer._Writer__chunk_builder  # type: ignore[attr-defined]
    offsets = (builder.count + messages.itemsize * np.arange(count)).astype("<u8")
    index = builder.message_indices.setdefault(block.channel, _Index(block.channel, []))
    index.entries.append(np.stack([times, offsets], axis=1))
    builder.message_start_time = min(builder.message_start_time, first) if builder.num_messages else first
    builder.message_end_time = max(builder.message_end_time, last)
    builder.num_messages += count
    builder.record_writer.write(messages.tobytes())
    statistics = writer._Writer__statistics  # type: ignore[attr-defined]
    earliest = statistics.message_start_time
    statistics.message_start_time = min(earliest, first) if statistics.message_count else first
    statistics.message_end_time = max(statistics.message_end_time, last)
    statistics.channel_message_counts[block.channel] += count
    statistics.message_count += count


def topic_descriptors(topic: Topic) -> bytes:
    """Returns the schema of a topic: its serialised `FileDescriptorSet`."""
    package, _, message = topic.message.rpartition(".")
    file = FileDescriptorProto(name=f"{topic.message}.proto", package=package, syntax="proto3")
    description = file.message_type.add(name=message)
    for number, field in enumerate(topic.fields, start=1):
        description.field.add(
            name=field.name,
            number=number,
            type=FieldDescriptorProto.TYPE_DOUBLE,
            label=FieldDescriptorProto.LABEL_OPTIONAL,
        )
    content: bytes = FileDescriptorSet(file=[file]).SerializeToString(deterministic=True)
    return content


def _message_descriptors(topic: ViewerTopic) -> bytes:
    """Returns the descriptors of a well-known message and of all that it is made of, those first."""
    files = _all_files(topic.message.DESCRIPTOR.file)
    described = FileDescriptorSet()
    for file in files:
        file.CopyToProto(described.file.add())
    content: bytes = described.SerializeToString(deterministic=True)
    return content


def _all_files(file: Any) -> list[Any]:
    """Returns the files that a descriptor's file is made of, each once, what others need before them."""
    needed = [part for dependency in file.dependencies for part in _all_files(dependency)]
    return list({part.name: part for part in (*needed, file)}.values())
