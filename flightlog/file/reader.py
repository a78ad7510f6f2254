"""Reading of MCAP flight logs with verification of every checksum.

A message whose fields are all doubles numbered 1 to 15 has a fixed layout, a tag byte and eight bytes each,
so a block of messages is a NumPy array, written and read as one piece.
"""

import io
import struct
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, fields
from pathlib import Path
from typing import Any

import numpy as np
import zstandard
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import ChunkIndex, Schema
from mcap.summary import Summary

from flight.errors import BadFileError
from flight.schema import check_schema_name
from flightlog.alarm import ALARM
from flightlog.consistency import check_log_consistency
from flightlog.decision import DECISION
from flightlog.header import FlightHeader
from flightlog.log import FlightLog
from flightlog.series import Series, Topic
from flightlog.topics import SCHEMA, TOPICS

from .message_block import constant_fields, empty_messages, topic_type, view_at_every_byte
from .writer import (
    CONVENTIONS_METADATA,
    HEADER_METADATA,
    LARGEST_LOG,
    described_fields,
)

MAGIC = b"\x89MCAP0\r\n"
_IMPORT = "; `maneuver import` converts logs of other programs"
_RECOVER = "; `maneuver recover` saves the undamaged part"
_FOOTER = struct.Struct("<BQQQI")
_DATA_END = struct.Struct("<BQI")


def read_log(path: Path, *, topics: Sequence[Topic] = (*TOPICS, DECISION, ALARM)) -> FlightLog:
    """Reads a flight log and verifies every checksum.

    Args:
        path: file to read.
        topics: topics to unpack, where present; fewer are read faster.

    Raises:
        BadFileError: the file is missing, too large, truncated, damaged, or not a flight log.
    """
    try:
        size = path.stat().st_size
        if size > LARGEST_LOG:
            raise BadFileError(path, f"expected at most {LARGEST_LOG} bytes, got {size}")
        content = path.read_bytes()
    except OSError as error:
        raise BadFileError(path, f"cannot be read: {error.strerror or error}") from None
    _check_complete(content, path)
    try:
        return _parse(content, topics)
    except (
        McapError,
        ValueError,
        KeyError,
        TypeError,
        struct.error,
        zstandard.ZstdError,
        MemoryError,
    ) as error:
        raise BadFileError(path, f"is not a flight log: {error}") from None


def _check_complete(content: bytes, path: Path) -> None:
    """Refuses content with an incomplete start, end or wrong checksum."""
    if not content.startswith(MAGIC):
        raise BadFileError(path, f"expected an MCAP file, got something else{_IMPORT}")
    end = len(content) - len(MAGIC) - _FOOTER.size
    if end < len(MAGIC) or not content.endswith(MAGIC):
        raise BadFileError(path, f"is truncated after {len(content)} bytes{_RECOVER}")
    opcode, _, summary_start, _, summary_crc = _FOOTER.unpack_from(content, end)
    data_end = summary_start - _DATA_END.size
    if opcode != Opcode.FOOTER or not len(MAGIC) <= data_end <= end:
        raise BadFileError(path, f"is damaged: its footer has an invalid offset{_RECOVER}")
    opcode, _, data_crc = _DATA_END.unpack_from(content, data_end)
    if not data_crc or not summary_crc:
        raise BadFileError(path, f"expected checksums of data and summary, got none{_IMPORT}")
    if opcode != Opcode.DATA_END or zlib.crc32(content[:data_end]) != data_crc:
        raise BadFileError(path, f"is damaged: its data do not match their checksum{_RECOVER}")
    if zlib.crc32(content[summary_start : end + _FOOTER.size - 4]) != summary_crc:
        raise BadFileError(path, f"is damaged: its summary does not match its checksum{_RECOVER}")


def _parse(content: bytes, topics: Sequence[Topic]) -> FlightLog:
    reader = SeekingReader(io.BytesIO(content), validate_crcs=True)
    summary = reader.get_summary()
    if summary is None:
        raise ValueError("it has no summary")
    metadata = {record.name: record.metadata for record in reader.iter_metadata()}
    check_schema_name(metadata.get(CONVENTIONS_METADATA, {}).get("schema", SCHEMA), SCHEMA)
    if HEADER_METADATA not in metadata:
        raise ValueError(f"expected metadata {HEADER_METADATA!r}, got {sorted(metadata)}{_IMPORT}")
    if sum(index.uncompressed_size for index in summary.chunk_indexes) > LARGEST_LOG:
        raise ValueError(f"expected at most {LARGEST_LOG} bytes of content, got more")
    log = FlightLog(
        header=_parse_header(metadata[HEADER_METADATA]),
        series=_parse_series(content, summary, topics),
        attachments={record.name: record.data for record in reader.iter_attachments()},
    )
    check_log_consistency(log)
    return log


def _parse_header(metadata: Mapping[str, str]) -> FlightHeader:
    names = {field.name for field in fields(FlightHeader)}
    # Logs of older versions lack the fields with defaults.
    needed = {field.name for field in fields(FlightHeader) if field.default is MISSING}
    if not needed <= set(metadata) <= names:
        raise ValueError(f"expected header fields {sorted(names)}, got {sorted(metadata)}")
    return FlightHeader(**{**metadata, "seed": int(metadata["seed"])})  # type: ignore[arg-type]


def _parse_series(content: bytes, summary: Summary, wanted: Sequence[Topic]) -> dict[str, Series]:
    by_name = {topic.name: topic for topic in wanted}
    topics = {
        channel.id: _topic_of_schema(by_name[channel.topic], summary.schemas[channel.schema_id])
        for channel in summary.channels.values()
        if channel.topic in by_name
    }
    blocks: dict[int, list[np.ndarray[Any, Any]]] = {number: [] for number in topics}
    for index in summary.chunk_indexes:
        for number, block in _chunk_blocks(content, index, topics):
            blocks[number].append(block)
    series = {}
    for number, topic in topics.items():
        messages = np.concatenate([np.empty(0, topic_type(topic)), *blocks[number]])
        values = np.stack([messages[f"v{number}"] for number in topic.numbers], axis=1)
        series[topic.name] = Series(topic, messages["log_time"] * 1e-9, values)
    return series


def _topic_of_schema(topic: Topic, schema: Schema) -> Topic:
    """Returns a topic with the fields that the file's schema has."""
    described = described_fields(schema.data, topic.message)
    expected = dict(zip(topic.field_names, topic.numbers, strict=True))
    if not described or not described.items() <= expected.items():
        raise ValueError(
            f"schema {schema.name!r}: expected fields of {topic.message}, got {sorted(described)}"
        )
    return topic.only(described)


def _chunk_blocks(
    content: bytes, index: ChunkIndex, topics: Mapping[int, Topic]
) -> Iterator[tuple[int, np.ndarray[Any, Any]]]:
    """Yields channel and messages of a chunk with verified checksum."""
    if topics.keys().isdisjoint(index.message_index_offsets):
        return
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
        yield number, _messages_at(records, entries[:, 1], topic_type(topics[number]))


def _messages_at(records: bytes, offsets: np.ndarray[Any, Any], kind: np.dtype[Any]) -> np.ndarray[Any, Any]:
    raw = np.frombuffer(records, np.uint8)
    if len(offsets) and int(offsets.max()) + kind.itemsize > len(raw):
        raise ValueError("a message lies outside its chunk")
    messages: np.ndarray[Any, Any] = view_at_every_byte(raw, kind)[offsets.astype(np.int64)].view(kind)
    expected = empty_messages(kind, 1)
    for name in constant_fields(kind):
        if not (messages[name] == expected[name]).all():
            raise ValueError("a message does not have the layout of its topic")
    return messages
