"""Tests of commands of imported logs, and of their levels."""

from pathlib import Path

import numpy as np
import pytest

from flightlog.file.reader import read_log
from flightlog.primitives import merged_primitives
from flightlog.topics import COMMAND, PRIMITIVE, TRUTH
from maneuver.app import run
from tests.support.external.flown_circle import text

# Data beside the project, not part of it.
DATA = Path(__file__).parents[3] / "shared" / "data" / "dart"


def test_commands_held_in_levels_are_primitives_with_their_velocity(tmp_path: Path) -> None:
    time = 0.02 * np.arange(1500)
    steering = np.select([time < 10.0, time < 20.0], [0.3, -0.1], 0.3)
    speed, rate = 2.0, 0.5 * steering
    heading = np.concatenate([[0.0], np.cumsum(0.02 * rate[:-1])])
    columns = {
        "time": time,
        "vx": speed * np.cos(heading),
        "vy": speed * np.sin(heading),
        "yaw": heading,
        "steering": steering,
        "throttle": np.full(len(time), 0.6),
    }
    path, out = tmp_path / "car.csv", tmp_path / "car.mcap"
    path.write_text(text(columns))
    order = ["import", str(path), "--command", "steering", "throttle", "--as", "truth", "--out", str(out)]
    assert run(order) == 0
    log = read_log(out)
    np.testing.assert_allclose(log[COMMAND]["input_1"], steering, atol=1e-9)
    np.testing.assert_allclose(log[COMMAND]["input_2"], 0.6, atol=1e-9)
    held = merged_primitives(log)
    assert [part.id for part in held] == [1, 2, 1]
    assert [part.start for part in held] == pytest.approx([0.0, 10.0, 20.0], abs=1e-9)
    for part, turning in zip(held, (0.15, -0.05, 0.15), strict=True):
        assert part.target.forward == pytest.approx(speed, abs=1e-6)
        assert part.target.yaw_rate == pytest.approx(turning, abs=1e-6)
    assert run(["review", str(out), "--html", "--png", "--out", str(tmp_path / "review")]) == 0


def test_commands_that_are_not_held_are_no_primitives(tmp_path: Path) -> None:
    time = 0.02 * np.arange(500)
    path, out = tmp_path / "car.csv", tmp_path / "car.mcap"
    path.write_text(
        text({"time": time, "vx": 1.0 + 0 * time, "vy": 0 * time, "yaw": 0 * time, "stick": np.sin(time)})
    )
    assert run(["import", str(path), "--command", "stick", "--out", str(out)]) == 0
    log = read_log(out)
    assert COMMAND.name in log.series
    assert PRIMITIVE.name not in log.series


def test_a_command_that_is_no_column_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "car.csv"
    path.write_text("time,x,y\n0,0,0\n0.1,1,1\n0.2,2,2\n")
    assert run(["import", str(path), "--command", "stick", "--out", str(tmp_path / "out.mcap")]) == 2
    assert "no column 'stick'; it has time, x, y" in capsys.readouterr().err


@pytest.mark.skipif(not DATA.is_dir(), reason="no logs of others beside the project")
def test_the_steering_of_a_real_car_is_held_in_fourteen_levels(tmp_path: Path) -> None:
    out = tmp_path / "car.mcap"
    columns = ["time=vicon time", "x=vicon x", "y=vicon y", "yaw=vicon yaw"]
    order = ["import", str(DATA / "09_50_18.csv"), "--columns", *columns, "--command", "steering"]
    assert run([*order, "--as", "truth", "--out", str(out)]) == 0
    log = read_log(out)
    assert len(set(log[PRIMITIVE]["id"])) == 14
    assert len(log[TRUTH]) > 10_000
    assert run(["review", str(out), "--html", "--out", str(tmp_path / "review")]) == 0
