"""Tests of the recovery of damaged logs."""

import io
import struct
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import SeekingReader
from mcap.writer import CompressionType, Writer

from flightlog.file.reader import read_log
from flightlog.file.recovery import contains_salvage, recovered_bytes, salvage
from flightlog.file.writer import log_bytes
from flightlog.log import FlightLog
from maneuver.app import run
from tests.support.synthetic_log import synthetic_library, synthetic_log

ZSTD = b"\x04\x00\x00\x00zstd"


@cache
def whole_log() -> FlightLog:
    return synthetic_log(synthetic_library(), trims=(1, 2, 3, 2), coasting_times=(5.0, 6.0, 5.0, 9.0), seed=5)


@cache
def whole_content() -> bytes:
    return log_bytes(whole_log())


@pytest.fixture
def log() -> FlightLog:
    return whole_log()


@pytest.fixture
def content() -> bytes:
    return whole_content()


def another_writers_log(compression: CompressionType) -> bytes:
    stream = io.BytesIO()
    writer = Writer(stream, chunk_size=2000, compression=compression)
    writer.start(profile="ros2", library="another")
    schema = writer.register_schema("text", "jsonschema", b"{}")
    channel = writer.register_channel("/text", "json", schema, {"who": "another"})
    for number in range(500):
        writer.add_message(channel, number * 10**7, b'{"n": %d}' % number, number * 10**7, number)
    writer.finish()  # type: ignore[no-untyped-call]
    return stream.getvalue()


def test_a_log_that_lacks_only_its_summary_is_recovered_without_loss(
    log: FlightLog, content: bytes, tmp_path: Path
) -> None:
    damaged, out = tmp_path / "cut.mcap", tmp_path / "whole.mcap"
    damaged.write_bytes(content[:-200])
    assert run(["recover", str(damaged), "--out", str(out)]) == 0
    recovered = read_log(out)
    assert recovered.header == log.header
    assert recovered.attachments == log.attachments
    for name, series in log.series.items():
        np.testing.assert_array_equal(recovered.series[name].values, series.values)


def test_a_truncated_log_keeps_its_intact_chunks_and_is_marked_as_incomplete(
    log: FlightLog, content: bytes, tmp_path: Path
) -> None:
    damaged, out = tmp_path / "cut.mcap", tmp_path / "whole.mcap"
    damaged.write_bytes(content[: len(content) * 2 // 3])
    assert run(["recover", str(damaged), "--out", str(out)]) == 3
    recovered = read_log(out)
    assert recovered.header.outcome.startswith("recovered with loss")
    assert 0 < recovered.duration < log.duration
    for name, series in recovered.series.items():
        np.testing.assert_array_equal(series.values, log.series[name].values[: len(series)])


def test_a_chunk_damaged_in_the_middle_is_left_out_and_the_rest_kept(content: bytes) -> None:
    damaged = bytearray(content)
    damaged[content.index(ZSTD, content.index(ZSTD) + 1) + 100] ^= 0x40
    found = salvage(bytes(damaged))
    assert found.damaged_chunks == 1
    assert not found.lossless
    assert found.announced is not None
    assert 0 < len(found.messages) < found.announced
    assert contains_salvage(recovered_bytes(found), found)


def test_altered_words_beside_the_messages_are_no_lossless_recovery(content: bytes) -> None:
    place = content.index(b"reference model")
    found = salvage(content[:place] + b"Reference" + content[place + 9 :])
    assert not found.lossless
    assert found.announced == len(found.messages)


@pytest.mark.parametrize("compression", list(CompressionType))
def test_another_writers_log_is_recovered_too(compression: CompressionType) -> None:
    content = another_writers_log(compression)
    found = salvage(content[: len(content) // 2])
    assert not found.lossless
    whole = recovered_bytes(found)
    numbers = [message.sequence for _, _, message in SeekingReader(io.BytesIO(whole)).iter_messages()]
    assert numbers == list(range(len(numbers)))
    assert 0 < len(numbers) < 500
    assert salvage(content).lossless


@settings(deadline=None)
@given(
    compression=st.sampled_from(CompressionType),
    share=st.floats(0, 1),
    flips=st.lists(st.floats(0, 1), max_size=3),
)
def test_recovered_messages_are_a_subset_of_the_original_ones(
    compression: CompressionType, share: float, flips: list[float]
) -> None:
    content = another_writers_log(compression)
    damaged = bytearray(content[: int(share * len(content))])
    for flip in flips:
        if damaged:
            damaged[int(flip * (len(damaged) - 1))] ^= 0x10
    found, original = salvage(bytes(damaged)), salvage(content)
    true = {(m.channel_id, m.log_time, m.data) for m in original.messages}
    assert {(m.channel_id, m.log_time, m.data) for m in found.messages} <= true
    if found.messages:
        assert contains_salvage(recovered_bytes(found), found)
    if found.lossless:
        assert len(found.messages) == len(original.messages)


def test_a_chunk_that_unpacks_to_more_than_its_stated_size_is_damaged(content: bytes) -> None:
    place = content.index(ZSTD) - 12
    (size,) = struct.unpack_from("<Q", content, place)
    bomb = content[:place] + struct.pack("<Q", 2**40) + content[place + 8 :]
    assert size < 2**40
    assert salvage(bomb).damaged_chunks == 1


@pytest.mark.parametrize("rubbish", [b"", b"no log", b"\x89MCAP0\r\n", bytes(5000)])
def test_where_there_is_nothing_to_save_nothing_is_written(
    rubbish: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    damaged, out = tmp_path / "rubbish.mcap", tmp_path / "out.mcap"
    damaged.write_bytes(rubbish)
    assert run(["recover", str(damaged), "--out", str(out)]) == 1
    assert "nothing to recover" in capsys.readouterr().out
    assert not out.exists()


def test_the_damaged_log_is_never_overwritten(content: bytes, tmp_path: Path) -> None:
    damaged = tmp_path / "cut.mcap"
    damaged.write_bytes(content[:-200])
    assert run(["recover", str(damaged), "--out", str(damaged), "--force"]) == 2
    assert damaged.read_bytes() == content[:-200]
