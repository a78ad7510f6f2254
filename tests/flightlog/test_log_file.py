"""Tests of flight logs on disk: complete and unchanged, or refused."""

import io
from pathlib import Path

import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from mcap.reader import make_reader

from flight.errors import AlreadyExistsError, BadFileError, CannotWriteError
from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes, write_log
from flightlog.log import FlightLog, MissingTopicError
from flightlog.primitives import flown_primitives
from flightlog.topics import CONTROLS, TOPICS, TRUTH
from runtime.atomic_write import write_atomically
from tests.support.synthetic_log import synthetic_library, synthetic_log


@pytest.fixture(scope="module")
def log() -> FlightLog:
    return synthetic_log(synthetic_library(), [1, 2, 5, 7, 3, 1], [2.0, 3.0, 2.0, 3.0, 2.0, 2.0], seed=1)


@pytest.fixture(scope="module")
def content(log: FlightLog) -> bytes:
    return log_bytes(log)


def test_a_log_is_read_as_it_was_written(log: FlightLog, tmp_path: Path) -> None:
    path = tmp_path / "flight.mcap"
    write_log(log, path)
    read = read_log(path)
    assert read.header == log.header
    assert read.attachments == log.attachments
    assert read.series.keys() == log.series.keys()
    for name, series in log.series.items():
        np.testing.assert_array_equal(read.series[name].values, series.values)
        # Times are whole nanoseconds in the file.
        np.testing.assert_allclose(read.series[name].time, series.time, rtol=0, atol=0.51e-9)
    assert flown_primitives(read) == flown_primitives(log)


def test_equal_logs_give_equal_bytes(log: FlightLog, content: bytes) -> None:
    assert log_bytes(log) == content


def test_the_stock_decoder_reads_the_same_numbers(log: FlightLog, content: bytes) -> None:
    """Compares blocks, written past the MCAP library's writer, with its reader."""
    reader = make_reader(io.BytesIO(content), validate_crcs=True)
    classes = {}
    rows: dict[str, list[list[float]]] = {name: [] for name in log.series}
    times: dict[str, list[float]] = {name: [] for name in log.series}
    for schema, channel, message in reader.iter_messages():
        assert schema is not None
        if schema.name not in classes:
            pool = DescriptorPool()
            for file in FileDescriptorSet.FromString(schema.data).file:
                pool.Add(file)
            classes[schema.name] = GetMessageClass(pool.FindMessageTypeByName(schema.name))
        decoded = classes[schema.name].FromString(message.data)
        if channel.topic not in rows:
            continue
        rows[channel.topic].append([getattr(decoded, field.name) for field in decoded.DESCRIPTOR.fields])
        times[channel.topic].append(message.log_time * 1e-9)
    for name, series in log.series.items():
        np.testing.assert_array_equal(np.array(rows[name]), series.values)
        np.testing.assert_allclose(times[name], series.time, rtol=0, atol=0.51e-9)
    summary = reader.get_summary()
    assert summary is not None
    assert summary.statistics is not None
    counts = summary.statistics.channel_message_counts
    for number, channel in summary.channels.items():
        if channel.topic in log.series:
            assert counts[number] == len(log.series[channel.topic])
    assert summary.statistics.message_count == sum(counts.values())


def test_every_truncated_log_is_refused_in_one_line(content: bytes, tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    path = tmp_path / "cut.mcap"
    for length in [0, 1, 8, 100, len(content) - 1, *rng.integers(0, len(content), 40).tolist()]:
        path.write_bytes(content[:length])
        with pytest.raises(BadFileError) as caught:
            read_log(path)
        assert "\n" not in str(caught.value)


def test_every_flipped_bit_is_noticed(content: bytes, tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    path = tmp_path / "flipped.mcap"
    for place in rng.integers(0, len(content), 300).tolist():
        damaged = bytearray(content)
        damaged[place] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        with pytest.raises(BadFileError):
            read_log(path)


def test_text_is_no_log(tmp_path: Path) -> None:
    path = tmp_path / "notes.mcap"
    path.write_text("north, east\n" * 100)
    with pytest.raises(BadFileError, match="expected an MCAP file"):
        read_log(path)


def test_a_topic_that_is_absent_is_absent_not_zero(log: FlightLog) -> None:
    bare = FlightLog(log.header, {TRUTH.name: log[TRUTH]}, {})
    with pytest.raises(MissingTopicError, match=r"no /controls; it has \['/truth'\]"):
        bare[CONTROLS]


def test_a_log_is_not_overwritten_unless_forced(log: FlightLog, tmp_path: Path) -> None:
    path = tmp_path / "flight.mcap"
    write_log(log, path)
    with pytest.raises(AlreadyExistsError, match="--force"):
        write_log(log, path)
    write_log(log, path, force=True)


def test_a_write_that_fails_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "flight.mcap"

    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(CannotWriteError, match="cannot be written: No space left"):
        write_atomically(b"content", path)
    assert list(tmp_path.iterdir()) == []


def test_no_topic_needs_a_field_number_of_two_bytes() -> None:
    assert all(len(topic.fields) <= 15 for topic in TOPICS)
