"""Tests of the import of ArduPilot's DataFlash logs."""

from pathlib import Path

import numpy as np
import pytest

from flightlog.file.reader import read_log
from flightlog.topics import ACTUATORS, ESTIMATE
from maneuver.app import run
from tests.support.external.dataflash_writer import TIME, dataflash
from tests.support.external.flown_circle import check_circle

mavutil = pytest.importorskip("pymavlink.mavutil", reason="pymavlink is an extra")

# Data beside the project, not part of it.
DATA = Path(__file__).parents[3] / "shared" / "data"


def test_a_circle_comes_back_as_it_was_flown(tmp_path: Path) -> None:
    path, out = tmp_path / "FLIGHT.BIN", tmp_path / "flight.mcap"
    path.write_bytes(dataflash())
    assert run(["import", str(path), "--out", str(out)]) == 0
    log = read_log(out)
    np.testing.assert_allclose(log[ESTIMATE].time, TIME, atol=1e-6)
    check_circle(log[ESTIMATE], atol=1e-5)
    assert log[ACTUATORS].topic.field_names == ("control_2",)


@pytest.mark.skipif(not DATA.is_dir(), reason="no logs of others beside the project")
def test_a_real_log_has_the_values_of_another_reader(tmp_path: Path) -> None:
    path, out = DATA / "ardupilot_plane.bin", tmp_path / "flight.mcap"
    assert run(["import", str(path), "--out", str(out)]) == 0
    estimate = read_log(out)[ESTIMATE]
    log, rows = mavutil.mavlink_connection(str(path)), []
    while (message := log.recv_match(type="XKF1")) is not None:
        rows.append([message.TimeUS * 1e-6, message.PN, message.PE, message.PD, message.Roll, message.Pitch])
    log.close()
    theirs = np.array(rows)[20:-20]
    # Its clock starts with the first state, at a sample of the gyroscopes: found by the height.
    starts = theirs[0, 0] - 0.8 + np.arange(-0.5, 0.5, 0.001)
    down = [
        np.abs(np.interp(theirs[:, 0] - start, estimate.time, estimate["down"]) - theirs[:, 3]).max()
        for start in starts
    ]
    start = starts[int(np.argmin(down))]
    # Away from its jump of 60 m, which takes one sample of the filter.
    calm = np.abs(np.gradient(theirs[:, 1])) < 2.0
    for name, column, largest in (("north", 1, 0.1), ("east", 2, 0.1), ("down", 3, 0.1)):
        ours = np.interp(theirs[:, 0] - start, estimate.time, estimate[name])
        assert np.abs(ours - theirs[:, column])[calm].max() < largest, name
    assert estimate.time[-1] == pytest.approx(41.43, abs=0.01)


def test_of_a_torn_log_the_intact_messages_are_read_with_exit_code_3(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    content, path, out = dataflash(), tmp_path / "torn.bin", tmp_path / "flight.mcap"
    middle = content.index(b"\xa3\x95", len(content) // 2)
    path.write_bytes(content[:middle] + np.random.default_rng(1).bytes(2000) + content[middle:])
    assert run(["import", str(path), "--out", str(out)]) == 3
    message = capfd.readouterr().err
    assert message.count("\n") == 1
    assert "recovered with loss: 20" in message
    check_circle(read_log(out)[ESTIMATE], atol=1e-5)
