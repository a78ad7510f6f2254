"""Writing of MCAP flight logs, with channels for viewers."""

import io
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet
from google.protobuf.message import DecodeError
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.writer import Writer

from flightlog.log import FlightLog
from flightlog.series import Series, Topic
from flightlog.topics import CONVENTIONS
from flightlog.viewers.viewer_channels import ViewerChannel, ViewerTopic, viewer_channels
from runtime.atomic_write import write_atomically

from .message_block import bytes_type, empty_messages, topic_type, view_at_every_byte

CHUNK_SECONDS = 10.0

LARGEST_LOG = 2 * 1024**3
"""Largest size of a file, and of its decompressed content, in bytes."""

HEADER_METADATA, CONVENTIONS_METADATA = "flight", "conventions"

_MEDIA_TYPES = {".json": "application/json", ".xml": "application/xml"}


@dataclass(slots=True, eq=False)
class _Index:
    """Times and offsets of one channel's messages in a chunk.

    Replaces the index class of the MCAP library.
    """

    channel: int
    entries: list[np.ndarray[Any, Any]]

    def write(self, stream: RecordBuilder) -> None:
        """Writes the index record in one piece."""
        content = b"".join(part.tobytes() for part in self.entries)
        stream.start_record(Opcode.MESSAGE_INDEX)
        stream.write2(self.channel)
        stream.write4(len(content))
        stream.write(content)
        stream.finish_record()  # type: ignore[no-untyped-call]


@dataclass(frozen=True, slots=True, eq=False)
class _Block:
    """Messages of one channel by time; first and last in nanoseconds."""

    channel: int
    messages: np.ndarray[Any, Any]
    first: int
    last: int

    @classmethod
    def of(cls, channel: int, messages: np.ndarray[Any, Any]) -> "_Block":
        times = messages["log_time"]
        first, last = (int(times[0]), int(times[-1])) if len(times) else (0, -1)
        return cls(channel, messages, first, last)

    def between(self, start: int, end: int) -> np.ndarray[Any, Any]:
        """Returns the messages in a half-open time window."""
        if self.last < start or self.first >= end:
            return self.messages[:0]
        rows = slice(*np.searchsorted(self.messages["log_time"], [start, end]).tolist())
        return self.messages[rows]


def log_bytes(log: FlightLog) -> bytes:
    """Returns a log's MCAP file; equal logs give equal bytes.

    Topics and viewer channels are in separate chunks, so that a reader of one skips the other.
    """
    stream = io.BytesIO()
    # Without attachments the MCAP library would write an offset to a missing group.
    writer = Writer(
        stream, chunk_size=LARGEST_LOG, enable_data_crcs=True, use_summary_offsets=bool(log.attachments)
    )
    writer.start(profile="", library="maneuver")
    writer.add_metadata(HEADER_METADATA, {key: str(value) for key, value in asdict(log.header).items()})
    writer.add_metadata(CONVENTIONS_METADATA, CONVENTIONS)
    for name, content in log.attachments.items():
        media_type = _MEDIA_TYPES.get(name[name.rfind(".") :], "application/octet-stream")
        writer.add_attachment(create_time=0, log_time=0, name=name, media_type=media_type, data=content)
    series = [_series_block(writer, part) for part in log.series.values()]
    drawn = [block for channel in viewer_channels(log) for block in _viewer_blocks(writer, channel)]
    period = round(CHUNK_SECONDS * 1e9)
    for start in _window_starts((*series, *drawn), period):
        for blocks in (series, drawn):
            _add_chunk(writer, blocks, start, start + period)
    writer.finish()  # type: ignore[no-untyped-call]
    return stream.getvalue()


def _window_starts(blocks: Sequence[_Block], period: int) -> list[int]:
    """Returns the starts of the time windows that hold messages."""
    windows = {int(window) for block in blocks for window in np.unique(block.messages["log_time"] // period)}
    return [period * window for window in sorted(windows)]


def _series_block(writer: Writer, series: Series) -> _Block:
    topic = series.topic
    schema = writer.register_schema(topic.message, "protobuf", topic_descriptors(topic))
    units = {field.name: f"{field.unit}; {field.meaning}" for field in topic.fields}
    channel = writer.register_channel(topic.name, "protobuf", schema, {"meaning": topic.meaning, **units})
    messages = _messages(channel, topic_type(topic), np.rint(series.time * 1e9).astype(np.uint64))
    for number, column in zip(topic.numbers, series.values.T, strict=True):
        messages[f"v{number}"] = column
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


def _add_chunk(writer: Writer, blocks: Sequence[_Block], start: int, end: int) -> None:
    """Adds a time window's messages as one chunk, by time.

    The MCAP library's `add_message` takes about 11 microseconds a message. This function does the same to the
    same private members, so the dependency is pinned below its next major version, and a test compares the
    content of both.
    """
    parts = [(block.channel, block.between(start, end)) for block in blocks]
    parts = [(channel, messages) for channel, messages in parts if len(messages)]
    if not parts:
        return
    builder = writer._Writer__chunk_builder  # type: ignore[attr-defined]
    statistics = writer._Writer__statistics  # type: ignore[attr-defined]
    content, places = _merge_by_time([messages for _, messages in parts])
    for (channel, messages), offsets in zip(parts, places, strict=True):
        index = builder.message_indices.setdefault(channel, _Index(channel, []))
        index.entries.append(np.stack([messages["log_time"], builder.count + offsets], axis=1).astype("<u8"))
        statistics.channel_message_counts[channel] += len(messages)
    count = sum(len(messages) for _, messages in parts)
    first = min(int(messages["log_time"][0]) for _, messages in parts)
    last = max(int(messages["log_time"][-1]) for _, messages in parts)
    builder.message_start_time, builder.message_end_time = first, last
    builder.num_messages += count
    builder.record_writer.write(content)
    earliest = statistics.message_start_time
    statistics.message_start_time = min(earliest, first) if statistics.message_count else first
    statistics.message_end_time = max(statistics.message_end_time, last)
    statistics.message_count += count
    writer._Writer__finalize_chunk()  # type: ignore[attr-defined]


def _merge_by_time(parts: Sequence[np.ndarray[Any, Any]]) -> tuple[bytes, list[np.ndarray[Any, Any]]]:
    """Returns messages of several layouts by time, and their offsets."""
    times = np.concatenate([messages["log_time"] for messages in parts])
    sizes = np.concatenate([np.full(len(messages), messages.itemsize) for messages in parts])
    order = np.argsort(times, kind="stable")
    begins = np.empty(len(times), np.int64)
    begins[order] = np.cumsum(sizes[order]) - sizes[order]
    places = np.split(begins, np.cumsum([len(messages) for messages in parts])[:-1])
    content = np.empty(int(sizes.sum()), np.uint8)
    for messages, offsets in zip(parts, places, strict=True):
        places_of_part = view_at_every_byte(content, messages.dtype)
        places_of_part[offsets] = messages.view(places_of_part.dtype)
    return content.tobytes(), places


def topic_descriptors(topic: Topic) -> bytes:
    """Returns a topic's schema as a serialised `FileDescriptorSet`."""
    package, _, message = topic.message.rpartition(".")
    file = FileDescriptorProto(name=f"{topic.message}.proto", package=package, syntax="proto3")
    description = file.message_type.add(name=message)
    for number, field in zip(topic.numbers, topic.fields, strict=True):
        description.field.add(
            name=field.name,
            number=number,
            type=FieldDescriptorProto.TYPE_DOUBLE,
            label=FieldDescriptorProto.LABEL_OPTIONAL,
        )
    content: bytes = FileDescriptorSet(file=[file]).SerializeToString(deterministic=True)
    return content


def described_fields(descriptors: bytes, message: str) -> dict[str, int]:
    """Returns the double fields of a schema's message, with numbers.

    Raises:
        ValueError: the bytes are not a schema.
    """
    try:
        files = FileDescriptorSet.FromString(descriptors).file
    except DecodeError as error:
        raise ValueError(f"expected a schema of {message}: {error}") from None
    package, _, name = message.rpartition(".")
    return {
        field.name: field.number
        for file in files
        for description in file.message_type
        if (file.package, description.name) == (package, name)
        for field in description.field
        if field.type == FieldDescriptorProto.TYPE_DOUBLE
    }


def _message_descriptors(topic: ViewerTopic) -> bytes:
    """Returns the descriptors of a message and of its parts."""
    files = _all_files(topic.message.DESCRIPTOR.file)
    described = FileDescriptorSet()
    for file in files:
        file.CopyToProto(described.file.add())
    content: bytes = described.SerializeToString(deterministic=True)
    return content


def _all_files(file: Any) -> list[Any]:
    """Returns a descriptor's file and its dependencies, dependencies first."""
    needed = [part for dependency in file.dependencies for part in _all_files(dependency)]
    return list({part.name: part for part in (*needed, file)}.values())


def write_log(log: FlightLog, path: Path, *, force: bool = False) -> None:
    """Writes a log atomically.

    Raises:
        AlreadyExistsError: the file exists and `force` is not set.
        CannotWriteError: a system call failed; nothing is left behind.
    """
    write_atomically(log_bytes(log), path, force=force)
