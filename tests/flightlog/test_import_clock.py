"""Tests of the clocks of imported files."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from jaxtyping import Float
from mcap.writer import Writer

from flightlog.file.reader import read_log
from flightlog.file.writer import log_bytes
from flightlog.imports.clock import SECONDS, ClockError, check_unit, order_by_time
from flightlog.imports.measured_motion import velocity_disagreement
from flightlog.topics import ESTIMATE
from maneuver.app import run
from review.page.spectra import amplitude_density
from tests.support.motion_log import motion_log

RATE, SAMPLES = 50, 500
TIME = np.arange(SAMPLES) / RATE

Column = Float[np.ndarray, "n"]


def circle(folder: Path, stamps: Column) -> Path:
    """Writes a circle of 20 m radius at 4 m/s, sampled at `TIME`, with these stamps."""
    path, turned = folder / "flight.csv", 0.2 * TIME
    columns = [stamps, 20 * np.sin(turned), 20 * (1 - np.cos(turned)), 4 * np.cos(turned), 4 * np.sin(turned)]
    rows = np.column_stack([*columns, turned])
    np.savetxt(path, rows, delimiter=",", header="time,x,y,vx,vy,yaw", comments="", fmt="%.9f")
    return path


def shifted(place: int, seconds: float) -> Column:
    return TIME + np.where(np.arange(SAMPLES) >= place, seconds, 0.0)


@pytest.mark.parametrize(
    ("stamps", "words"),
    [
        ((1.7e9 + TIME) * 1e9, "give --time-unit ns (50 Hz)"),
        (TIME * 1e6, "give --time-unit us (50 Hz)"),
        (TIME * 1e3, "give --time-unit ms (50 Hz)"),
        (TIME / 86400, "expected sample intervals of 0.0001 to 0.5 s"),
        (250.0 * TIME, "give --time-unit s (0.2 Hz) or ms (200 Hz)"),
        (shifted(300, 1.7e9), "give --part N, one of 1: rows 1 to 300, 0.000000 to 5.980000 s; 2: rows 301"),
        (shifted(300, -4.0), "2: rows 301 to 500, 2.000000 to 5.980000 s"),
        (np.full(SAMPLES, np.nan), "expected at least two rows with a time, got 0"),
        (np.full(SAMPLES, 5.0), "500 rows have 1 different times"),
        (np.floor(TIME), "500 rows have 10 different times: for rows at equal intervals give --rate 50 (Hz)"),
    ],
)
def test_times_of_no_flight_are_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], stamps: Column, words: str
) -> None:
    out = tmp_path / "flight.mcap"
    assert run(["import", str(circle(tmp_path, stamps)), "--out", str(out)]) == 2
    refusal = capsys.readouterr().err
    assert words in refusal
    assert refusal.count("\n") == 1
    assert not out.exists()


@pytest.mark.parametrize("unit", SECONDS)
def test_the_unit_that_is_named_is_the_one_to_give(tmp_path: Path, unit: str) -> None:
    out = tmp_path / "flight.mcap"
    path = circle(tmp_path, (1.7e9 + TIME) / SECONDS[unit])  # type: ignore[index]
    assert run(["import", str(path), "--time-unit", unit, "--out", str(out)]) == 0
    estimate = read_log(out)[ESTIMATE]
    # Nanoseconds since 1970 leave a double 256 ns.
    np.testing.assert_allclose(estimate.time, TIME, atol=1e-6)
    np.testing.assert_allclose(estimate["forward"], 4.0, atol=1e-6)


def test_a_stated_unit_may_be_slow_and_not_impossibly_fast() -> None:
    minutes = 60.0 * np.arange(20)
    check_unit(minutes, "s")
    with pytest.raises(ClockError, match="got 60 s if times are in s: give --time-unit ms"):
        check_unit(minutes, None)
    with pytest.raises(ClockError, match=r"got 2e-11 s if times are in ns: give --time-unit s \(50 Hz\)"):
        check_unit(TIME, "ns")


def test_a_table_with_the_latest_row_first_is_read_from_its_end(tmp_path: Path) -> None:
    path, out = circle(tmp_path, TIME), tmp_path / "flight.mcap"
    headings, *rows = path.read_text().splitlines()
    path.write_text("\n".join([headings, *reversed(rows)]))
    assert run(["import", str(path), "--out", str(out)]) == 0
    estimate = read_log(out)[ESTIMATE]
    np.testing.assert_allclose(estimate.time, TIME, atol=1e-9)
    np.testing.assert_allclose(estimate["north"], 20 * np.sin(0.2 * TIME), atol=1e-6)


@given(st.floats(-3.9, -0.4), st.floats(0.0, 1.7e9), st.integers(2, 400))
def test_an_even_clock_of_a_flight_is_seconds(exponent: float, start: float, count: int) -> None:
    time = start + 10.0**exponent * np.arange(count)
    check_unit(time, None)
    assert len(order_by_time(time, sample="row").rows) == count


@given(st.lists(st.integers(0, SAMPLES - 2), max_size=30), st.integers(0, 2**32 - 1))
def test_neighbours_that_changed_places_are_sorted(places: list[int], seed: int) -> None:
    time, rows = np.array(TIME), np.arange(SAMPLES)
    for place in places:
        rows[[place, place + 1]] = rows[[place + 1, place]]
    part = order_by_time(time[rows], sample="row")
    assert part.lost <= len(places)
    np.testing.assert_array_equal(np.diff(part.time) > 0.0, True)
    np.testing.assert_array_equal(time[rows][part.rows], part.time)
    shuffled = np.argsort(TIME + 0.05 * np.random.default_rng(seed).random(SAMPLES))
    np.testing.assert_array_equal(order_by_time(TIME[shuffled], sample="row").time, TIME)


@given(st.integers(20, SAMPLES - 20), st.sampled_from([1e9, 1e5, 5.0, -3.0, -1e9]))
def test_one_corrupt_stamp_is_left_out_and_nothing_else(place: int, wrong: float) -> None:
    time = np.array(TIME)
    time[place] += wrong
    part = order_by_time(time, sample="row")
    kept = np.delete(np.arange(SAMPLES), place)
    np.testing.assert_array_equal(part.rows, kept)
    assert part.left_out == {"with a time out of order": 1}


@given(st.integers(20, SAMPLES - 20), st.floats(0.1, 1e4), st.sampled_from([1, 2]))
def test_a_clock_that_was_set_back_makes_two_parts(place: int, back: float, number: int) -> None:
    time = shifted(place, -back)
    if time[place] + TIME[-1] - TIME[place] < 0.0:
        # Without an overlap nothing tells that the clock was set back.
        return
    with pytest.raises(ClockError, match="give --part N"):
        order_by_time(time, sample="row")
    part = order_by_time(time, sample="row", part=number)
    rows = np.arange(SAMPLES)
    np.testing.assert_array_equal(part.rows, rows[:place] if number == 1 else rows[place:])


def test_more_than_one_percent_left_out_is_a_loss(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stamps = np.where(np.arange(SAMPLES) % 40 == 5, np.nan, TIME)
    out = tmp_path / "flight.mcap"
    assert run(["import", str(circle(tmp_path, stamps)), "--out", str(out)]) == 3
    assert "13 of 500 rows left out: 13 without a time" in capsys.readouterr().err
    assert len(read_log(out)[ESTIMATE]) == 487


def test_one_row_left_out_is_listed_and_no_loss(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stamps, out = np.where(np.arange(SAMPLES) == 300, 1e6, TIME), tmp_path / "flight.mcap"
    assert run(["import", str(circle(tmp_path, stamps)), "--out", str(out)]) == 0
    assert "1 of 500 rows left out: 1 with a time out of order" in capsys.readouterr().out
    estimate = read_log(out)[ESTIMATE]
    np.testing.assert_allclose(estimate["north"], 20 * np.sin(0.2 * estimate.time), atol=1e-6)
    assert estimate.time[-1] == pytest.approx(TIME[-1])


@pytest.mark.parametrize("number", [1, 2])
def test_a_part_is_imported_by_its_number(tmp_path: Path, number: int) -> None:
    path, out = circle(tmp_path, shifted(300, -4.0)), tmp_path / "flight.mcap"
    assert run(["import", str(path), "--part", str(number), "--out", str(out)]) == 0
    estimate, rows = read_log(out)[ESTIMATE], slice(300) if number == 1 else slice(300, None)
    np.testing.assert_allclose(estimate["north"], 20 * np.sin(0.2 * TIME[rows]), atol=1e-6)


def test_rows_at_equal_intervals_need_no_times(tmp_path: Path) -> None:
    path, out = circle(tmp_path, np.floor(TIME)), tmp_path / "flight.mcap"
    assert run(["import", str(path), "--rate", "50", "--out", str(out)]) == 0
    estimate = read_log(out)[ESTIMATE]
    np.testing.assert_allclose(estimate.time, TIME, atol=1e-9)
    np.testing.assert_allclose(estimate["forward"], 4.0, atol=1e-6)


def test_a_rate_of_no_sensor_is_another_unit() -> None:
    with pytest.raises(ClockError, match=r"expected a message every 0\.0001 s or less often, got 500 in"):
        order_by_time(TIME / 1e3, sample="message")


def test_what_is_made_of_a_log_does_not_grow_with_its_time_alone() -> None:
    """Gives a thousand samples over 31 years, which would need gigabytes."""
    time = np.concatenate([TIME, 1e9 + TIME])
    log = motion_log(vehicle="any", time=time, north=2.0 * time / 1e3, east=0 * time, heading=0 * time)
    assert len(log_bytes(log)) < 1_000_000
    assert velocity_disagreement(log.motion) is not None
    assert amplitude_density(time, np.sin(time)) is None
    assert amplitude_density(TIME, np.sin(TIME)) is not None


def bag(folder: Path, *, stamps: Column, logged: Column) -> Path:
    """Writes poses in JSON with these stamps and log times, both in seconds."""
    path = folder / "bag.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start()
        schema = writer.register_schema("Pose", "jsonschema", b"{}")
        channel = writer.register_channel("/odom", "json", schema)
        for stamp, at in zip(stamps, logged, strict=True):
            header = {"stamp": {"sec": int(stamp), "nanosec": round(stamp % 1 * 1e9)}}
            message = {"header": header, "position": {"x": 4.0 * at, "y": 0.0, "z": 0.0}}
            time = round(at * 1e9)
            writer.add_message(channel, log_time=time, publish_time=time, data=json.dumps(message).encode())
        writer.finish()  # type: ignore[no-untyped-call]
    return path


@pytest.mark.parametrize("stamps", [shifted(250, 1.7e9), 1e15 + TIME, -5.0 - TIME])
def test_stamps_of_no_clock_give_way_to_the_log_times(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], stamps: Column
) -> None:
    path, out = bag(tmp_path, stamps=stamps, logged=TIME), tmp_path / "out.mcap"
    assert run(["import", str(path), "--pose", "/odom", "--out", str(out)]) == 0
    assert "of logging" in capsys.readouterr().out
    np.testing.assert_allclose(read_log(out)[ESTIMATE].time, TIME, atol=1e-9)


@pytest.mark.parametrize(
    ("logged", "words"),
    [
        (shifted(250, 1.7e9), "give --part N, one of 1: /odom messages 1 to 250"),
        (TIME / 1e3, "expected a /odom message every 0.0001 s or less often"),
    ],
)
def test_log_times_of_no_flight_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], logged: Column, words: str
) -> None:
    path, out = bag(tmp_path, stamps=0.0 * TIME, logged=logged), tmp_path / "out.mcap"
    assert run(["import", str(path), "--pose", "/odom", "--out", str(out)]) == 2
    refusal = capsys.readouterr().err
    assert words in refusal
    assert refusal.count("\n") == 1
