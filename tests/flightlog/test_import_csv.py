"""Tests of the import of CSV tables."""

import json
from math import pi
from pathlib import Path

import numpy as np
import pytest

from flightlog.file.reader import read_log
from flightlog.topics import ACTUATORS, ESTIMATE, TRUTH
from identification.segmentation.segmentation import ObservedWalk, TrimEntry, cut_into_segments
from maneuver.app import run
from tests.support.synthetic_log import STILL, synthetic_library, synthetic_log

# Data beside the project, not part of it.
DATA = Path(__file__).parents[3] / "shared" / "data"


def written(folder: Path, columns: dict[str, np.ndarray]) -> Path:
    path = folder / "flight.csv"
    rows = np.column_stack([*columns.values()])
    np.savetxt(path, rows, delimiter=",", header=",".join(columns), comments="", fmt="%.9f")
    return path


def eastward() -> dict[str, np.ndarray]:
    """Returns a straight climb to the east in axes east-north-up."""
    time = 0.05 * np.arange(200)
    zeros = np.zeros(200)
    columns = {"t": 1e6 + 1e3 * time, "px": 2.0 * time, "y": zeros, "z": 5.0 + 0.5 * time}
    return {**columns, "roll": zeros + 0.1, "pitch": zeros, "yaw": zeros, "u1": np.sin(time)}


def test_columns_are_taken_by_their_names_in_the_axes_stated(tmp_path: Path) -> None:
    path, out = written(tmp_path, eastward()), tmp_path / "flight.mcap"
    order = ["import", str(path), "--columns", "time=t", "x=px", "--time-unit", "ms", "--world", "enu"]
    assert run([*order, "--body", "flu", "--as", "truth", "--out", str(out)]) == 0
    log = read_log(out)
    truth = log[TRUTH]
    for field, value in (
        *(("north", 0.0), ("east", 2.0 * truth.time), ("down", -5.0 - 0.5 * truth.time)),
        *(("forward", 2.0), ("side", 0.0), ("descent", -0.5), ("heading", pi / 2.0), ("roll", 0.1)),
    ):
        np.testing.assert_allclose(truth[field], value, atol=1e-6, err_msg=field)
    assert log[ACTUATORS].topic.field_names == ("control_1",)
    assert not truth.has_fields("roll_rate")


def test_a_map_and_a_heading_are_enough_for_the_motion_in_the_plane(tmp_path: Path) -> None:
    time = 0.025 * np.arange(400)
    heading = 0.4 * time
    columns = {"time": time, "x": 5.0 * np.sin(heading), "y": 5.0 * (1.0 - np.cos(heading)), "yaw": heading}
    out = tmp_path / "flight.mcap"
    assert run(["import", str(written(tmp_path, columns)), "--out", str(out)]) == 0
    estimate = read_log(out)[ESTIMATE]
    assert set(estimate.topic.field_names) == {"north", "east", "forward", "side", "heading", "yaw_rate"}
    inner = slice(1, -1)
    np.testing.assert_allclose(estimate["forward"][inner], 2.0, atol=1e-3)
    np.testing.assert_allclose(estimate["side"][inner], 0.0, atol=1e-3)
    np.testing.assert_allclose(estimate["yaw_rate"], 0.4, atol=1e-6)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "expected --columns time=COLUMN"),
        (("--columns", "time=tt"), "no column 'tt'; it has t, px"),
        (("--columns", "date=t"), "unknown column name 'date'"),
        (("--columns", "time"), "expected NAME=HEADING, got 'time'"),
        (("--columns", "time=t", "time=px"), "time is given twice"),
        (("--columns", "time=t", "--pose", "/odom"), "--pose: not valid for a table"),
    ],
)
def test_columns_that_cannot_be_meant_are_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: tuple[str, ...], words: str
) -> None:
    out = tmp_path / "flight.mcap"
    assert run(["import", str(written(tmp_path, eastward())), *options, "--out", str(out)]) == 2
    refusal = capsys.readouterr().err
    assert words in refusal
    assert refusal.count("\n") == 1
    assert not out.exists()


def test_what_is_no_table_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "flight.csv"
    for content in (b"", b"\x00\xff\xfe", b"time,x\n", b"time,x,y,z\na,b,c,d\ne,f,g,h\n", b'"\n' * 50):
        path.write_bytes(content)
        assert run(["import", str(path), "--columns", "time=time", "--out", str(tmp_path / "o.mcap")]) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_without_positions_maneuvers_are_as_long_as_their_velocities_make_them() -> None:
    library = synthetic_library()
    log = synthetic_log(library, (1, 3, 7, 3), (4.0,) * 4, seed=1, noise=STILL)
    starts = log.series["/primitive"]
    entries = [
        TrimEntry(time, int(left), int(reached))
        for time, kind, left, reached in zip(
            starts.time, starts["kind"], starts["from_trim"], starts["to_trim"], strict=True
        )
        if kind == 1
    ]
    walk = ObservedWalk(1, tuple(entries))
    truth = log[TRUTH]
    fields = [name for name in truth.topic.field_names if name not in {"north", "east"}]
    blind_topic = TRUTH.only(fields)
    blind_values = np.column_stack([truth[name] for name in fields])
    blind = type(log)(
        log.header, {TRUTH.name: type(truth)(blind_topic, truth.time, blind_values)}, log.attachments
    )
    with_positions, without = (
        cut_into_segments(log, walk, library).maneuvers,
        cut_into_segments(blind, walk, library).maneuvers,
    )
    assert len(with_positions) == len(without) == 3
    for measured, reckoned in zip(with_positions, without, strict=True):
        assert reckoned.duration == measured.duration
        # The synthetic vehicle holds each velocity for a sample, so they differ by half a sample's distance.
        assert reckoned.displacement.x == pytest.approx(measured.displacement.x, abs=0.05)
        assert reckoned.displacement.y == pytest.approx(measured.displacement.y, abs=0.05)


@pytest.mark.skipif(not DATA.is_dir(), reason="no logs of others beside the project")
def test_a_real_table_is_imported_reviewed_and_identified_from(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "quadrotor.mcap"
    quaternion = [f"q{axis}=q{place}" for place, axis in enumerate("wxyz")]
    rates = [f"w{axis}=ang_vel_{axis}" for axis in "xyz"]
    columns = ["time=timestamp", *quaternion, *rates]
    order = ["import", str(DATA / "quadrotor_model.csv"), "--columns", *columns, "--time-unit", "us"]
    assert run([*order, "--out", str(out), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["absent_of_the_state"] == ["north", "east", "down"]
    estimate = read_log(out)[ESTIMATE]
    assert estimate.time[-1] == pytest.approx(55.63)
    # The derivative of its heading equals the yaw rate of its body rates.
    slope = np.gradient(estimate["heading"], estimate.time)
    assert np.sqrt(np.mean((slope - estimate["yaw_rate"]) ** 2)) < 0.05
    assert run(["review", str(out), "--html", "--out", str(tmp_path / "review"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["distance"] is None
