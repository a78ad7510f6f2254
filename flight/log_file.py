"""Flight logs as MCAP files: protobuf channels of doubles, every checksum written and every checksum read.

A message whose fields are all doubles numbered 1 to 15 has a fixed layout, a tag byte and eight bytes each,
so a block of messages is a NumPy array, written and read as one piece.
"""

import io
import os
import struct
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
import zstandard
from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorProto, FileDescriptorSet
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import ChunkIndex, MessageIndex
from mcap.summary import Summary
from mcap.writer import Writer

from .decision import DECISION
from .errors import AlreadyExistsError, BadFileError, CannotWriteError
from .log import TOPICS, FlightHeader, FlightLog, Series, Topic

CHUNK_SECONDS = 10.0
LARGEST_LOG = 2 * 1024**3
"""Bytes of a file, and of its content decompressed."""

_MAGIC = b"\x89MCAP0\r\n"
_HEADER_METADATA = "flight"
_FOOTER = struct.Struct("<BQQQI")
_DATA_END = struct.Struct("<BQI")
_MESSAGE_HEADER = [("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4")]
_MESSAGE_TIMES = [("log_time", "<u8"), ("publish_time", "<u8")]


def publish_log(log: FlightLog, path: Path, *, force: bool = False) -> None:
    """Writes a log whole or not at all: temporary file, sync, rename, sync of the folder.

    Raises:
        AlreadyExistsError: the file exists and `force` is not set.
    """
    publish_bytes(log_bytes(log), path, force=force)


def publish_bytes(content: bytes, path: Path, *, force: bool = False) -> None:
    """Writes a file whole or not at all.

    Raises:
        AlreadyExistsError: the file exists and `force` is not set.
        CannotWriteError: the system says no; nothing is left behind.
    """
    if path.exists() and not force:
        raise AlreadyExistsError(path)
    try:
        _publish(content, path)
    except OSError as error:
        raise CannotWriteError(path, error.strerror or str(error)) from None


def _publish(content: bytes, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.{os.getpid()}.partial")
    try:
        with partial.open("wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def log_bytes(log: FlightLog) -> bytes:
    """Returns the log as the bytes of an MCAP file; equal logs give equal bytes."""
    stream = io.BytesIO()
    writer = Writer(stream, chunk_size=LARGEST_LOG, enable_data_crcs=True)
    writer.start(profile="", library="maneuver")
    writer.add_metadata(_HEADER_METADATA, {key: str(value) for key, value in asdict(log.header).items()})
    for name, content in log.attachments.items():
        media_type = "application/json" if name.endswith(".json") else "application/octet-stream"
        writer.add_attachment(create_time=0, log_time=0, name=name, media_type=media_type, data=content)
    channels = {name: _register(writer, series.topic) for name, series in log.series.items()}
    last = max((float(series.time[-1]) for series in log.series.values() if len(series)), default=0.0)
    written = dict.fromkeys(channels, 0)
    for window in range(int(last // CHUNK_SECONDS) + 1):
        for name, series in log.series.items():
            end = int(np.searchsorted(series.time, (window + 1) * CHUNK_SECONDS))
            _add_block(writer, channels[name], series, slice(written[name], end))
            written[name] = end
        writer._Writer__finalize_chunk()  # type: ignore[attr-defined]
    writer.finish()  # type: ignore[no-untyped-call]
    return stream.getvalue()


def read_log(path: Path) -> FlightLog:
    """Reads a log, every byte of it checked.

    Raises:
        BadFileError: the file is missing, too large, cut short, damaged, or no flight log; one line.
    """
    try:
        size = path.stat().st_size
        if size > LARGEST_LOG:
            raise BadFileError(path, f"expected at most {LARGEST_LOG} bytes, got {size}")
        content = path.read_bytes()
    except OSError as error:
        raise BadFileError(path, f"cannot be read: {error.strerror or error}") from None
    _check(content, path)
    try:
        return _parse(content)
    except (
        McapError,
        ValueError,
        KeyError,
        TypeError,
        struct.error,
        zstandard.ZstdError,
        MemoryError,
    ) as error:
        raise BadFileError(path, f"is no flight log: {error}") from None


def _check(content: bytes, path: Path) -> None:
    """Refuses content whose beginning, end or checksums are not those of a complete file."""
    if not content.startswith(_MAGIC):
        raise BadFileError(path, "expected an MCAP file, got something else")
    end = len(content) - len(_MAGIC) - _FOOTER.size
    if end < len(_MAGIC) or not content.endswith(_MAGIC):
        raise BadFileError(path, f"is cut short after {len(content)} bytes; its end is missing")
    opcode, _, summary_start, _, summary_crc = _FOOTER.unpack_from(content, end)
    data_end = summary_start - _DATA_END.size
    if opcode != Opcode.FOOTER or not len(_MAGIC) <= data_end <= end:
        raise BadFileError(path, "is damaged: its footer points nowhere")
    opcode, _, data_crc = _DATA_END.unpack_from(content, data_end)
    if not data_crc or not summary_crc:
        raise BadFileError(path, "has no checksums; a flight log of this program has them all")
    if opcode != Opcode.DATA_END or zlib.crc32(content[:data_end]) != data_crc:
        raise BadFileError(path, "is damaged: its data do not match their checksum")
    if zlib.crc32(content[summary_start : end + _FOOTER.size - 4]) != summary_crc:
        raise BadFileError(path, "is damaged: its summary does not match its checksum")


def _parse(content: bytes) -> FlightLog:
    reader = SeekingReader(io.BytesIO(content), validate_crcs=True)
    summary = reader.get_summary()
    if summary is None:
        raise ValueError("it has no summary")
    metadata = {record.name: record.metadata for record in reader.iter_metadata()}
    if _HEADER_METADATA not in metadata:
        raise ValueError(f"expected metadata {_HEADER_METADATA!r}, got {sorted(metadata)}")
    if sum(index.uncompressed_size for index in summary.chunk_indexes) > LARGEST_LOG:
        raise ValueError(f"expected at most {LARGEST_LOG} bytes of content, got more")
    return FlightLog(
        header=_parse_header(metadata[_HEADER_METADATA]),
        series=_parse_series(content, summary),
        attachments={record.name: record.data for record in reader.iter_attachments()},
    )


def _parse_header(metadata: Mapping[str, str]) -> FlightHeader:
    names = {field.name for field in fields(FlightHeader)}
    if set(metadata) != names:
        raise ValueError(f"expected header fields {sorted(names)}, got {sorted(metadata)}")
    return FlightHeader(**{**metadata, "seed": int(metadata["seed"])})  # type: ignore[arg-type]


def _parse_series(content: bytes, summary: Summary) -> dict[str, Series]:
    by_name = {topic.name: topic for topic in (*TOPICS, DECISION)}
    topics = {
        channel.id: by_name[channel.topic]
        for channel in summary.channels.values()
        if channel.topic in by_name
    }
    blocks: dict[int, list[np.ndarray[Any, Any]]] = {number: [] for number in topics}
    for index in summary.chunk_indexes:
        for number, block in _chunk_blocks(content, index, topics):
            blocks[number].append(block)
    series = {}
    for number, topic in topics.items():
        messages = np.concatenate([np.empty(0, _message_type(topic)), *blocks[number]])
        values = np.stack([messages[f"v{i}"] for i in range(len(topic.fields))], axis=1)
        series[topic.name] = Series(topic, messages["log_time"] * 1e-9, values)
    return series


def _chunk_blocks(
    content: bytes, index: ChunkIndex, topics: Mapping[int, Topic]
) -> Iterator[tuple[int, np.ndarray[Any, Any]]]:
    """Yields channel and messages of one chunk; the data's checksum has been verified over the whole file."""
    if index.compression != "zstd":
        raise ValueError(f"expected chunks compressed by zstd, got {index.compression!r}")
    # Record head, times, size, checksum, name of the compression, size of what follows.
    start = index.chunk_start_offset + 9 + 8 + 8 + 8 + 4 + 4 + len(index.compression) + 8
    compressed = content[start : start + index.compressed_size]
    records = zstandard.ZstdDecompressor().decompress(compressed, max_output_size=index.uncompressed_size)
    if len(records) != index.uncompressed_size:
        raise ValueError(f"expected a chunk of {index.uncompressed_size} bytes, got {len(records)}")
    for number, offset in index.message_index_offsets.items():
        if number not in topics:
            continue
        (length,) = struct.unpack_from("<I", content, offset + 9 + 2)
        entries = np.frombuffer(content, "<u8", length // 8, offset + 9 + 2 + 4).reshape(-1, 2)
        yield number, _messages_at(records, entries[:, 1], _message_type(topics[number]))


def _messages_at(records: bytes, offsets: np.ndarray[Any, Any], kind: np.dtype[Any]) -> np.ndarray[Any, Any]:
    raw = np.frombuffer(records, np.uint8)
    if len(offsets) and int(offsets.max()) + kind.itemsize > len(raw):
        raise ValueError("a message lies outside its chunk")
    rows = raw[offsets.astype(np.int64)[:, None] + np.arange(kind.itemsize)]
    messages: np.ndarray[Any, Any] = rows.view(kind)[:, 0]
    expected = _empty_messages(kind, 1)
    for name in ("opcode", "length", *(n for n in kind.names or () if n.startswith("t"))):
        if not (messages[name] == expected[name]).all():
            raise ValueError("a message does not have the layout of its topic")
    return messages


def _register(writer: Writer, topic: Topic) -> int:
    schema = writer.register_schema(topic.message, "protobuf", _file_descriptor_set(topic))
    units = {field.name: f"{field.unit}; {field.meaning}" for field in topic.fields}
    return writer.register_channel(topic.name, "protobuf", schema, {"meaning": topic.meaning, **units})


def _add_block(writer: Writer, channel: int, series: Series, rows: slice) -> None:
    """Adds messages as one piece.

    The library's own `add_message` costs about 11 microseconds a message; this does the same to the same
    private members, which is why the dependency is pinned below its next major version and a test holds the
    two ways to the same content.
    """
    count = rows.stop - rows.start
    if count <= 0:
        return
    messages = _empty_messages(_message_type(series.topic), count)
    times = np.rint(series.time[rows] * 1e9).astype(np.uint64)
    messages["channel"] = channel
    messages["sequence"] = np.arange(rows.start, rows.stop)
    messages["log_time"] = messages["publish_time"] = times
    for place in range(len(series.topic.fields)):
        messages[f"v{place}"] = series.values[rows, place]
    first, last = int(times[0]), int(times[-1])
    builder = writer._Writer__chunk_builder  # type: ignore[attr-defined]
    offsets = builder.count + messages.itemsize * np.arange(count)
    index = builder.message_indices.setdefault(channel, MessageIndex(channel_id=channel, records=[]))
    index.records.extend(zip(times.tolist(), offsets.tolist(), strict=True))
    builder.message_start_time = min(builder.message_start_time, first) if builder.num_messages else first
    builder.message_end_time = max(builder.message_end_time, last)
    builder.num_messages += count
    builder.record_writer.write(messages.tobytes())
    statistics = writer._Writer__statistics  # type: ignore[attr-defined]
    start = statistics.message_start_time
    statistics.message_start_time = min(start, first) if statistics.message_count else first
    statistics.message_end_time = max(statistics.message_end_time, last)
    statistics.channel_message_counts[channel] += count
    statistics.message_count += count


def _message_type(topic: Topic) -> np.dtype[Any]:
    payload = [part for i in range(len(topic.fields)) for part in ((f"t{i}", "u1"), (f"v{i}", "<f8"))]
    return np.dtype([*_MESSAGE_HEADER, *_MESSAGE_TIMES, *payload])


def _empty_messages(kind: np.dtype[Any], count: int) -> np.ndarray[Any, Any]:
    """Returns messages with what is the same in all of them: kind of record, length, protobuf tags."""
    messages = np.zeros(count, kind)
    messages["opcode"] = Opcode.MESSAGE
    messages["length"] = kind.itemsize - 9
    for number, name in enumerate((name for name in kind.names or () if name.startswith("t")), start=1):
        messages[name] = number << 3 | 1
    return messages


def _file_descriptor_set(topic: Topic) -> bytes:
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
