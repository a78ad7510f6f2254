"""Logs of PX4: a circle in closed form comes back as it was flown, and real ones are reviewed."""

import json
from pathlib import Path

import numpy as np
import pytest

from flight.errors import FlightError
from flight.log import COMMAND, ESTIMATE, IMPORT_ATTACHMENT, TRUTH
from flight.log_file import read_log
from flight.px4_log import Messages, series_of
from maneuver.app import run

# Beside the project, not part of it.
DATA = Path(__file__).parents[2] / "shared" / "data"
SPEED, RATE, BANK = 5.0, 0.4, 0.2


def circle() -> dict[str, Messages]:
    """Returns PX4's topics of a right-hand circle at a constant bank, positions not valid for a second."""
    slow, fast = 100.0 + np.arange(0.0, 20.0, 0.1), 100.0 + np.arange(0.0, 20.0, 0.004)

    def turned(time: np.ndarray) -> np.ndarray:
        return RATE * (time - 100.0)

    heading = turned(slow)
    place = {
        "timestamp": slow * 1e6,
        "x": SPEED / RATE * np.sin(heading),
        "y": SPEED / RATE * (1.0 - np.cos(heading)),
        "z": np.full(len(slow), -12.0),
        "vx": SPEED * np.cos(heading),
        "vy": SPEED * np.sin(heading),
        "vz": np.zeros(len(slow)),
        "xy_valid": slow >= 101.0,
    }
    half, bank = 0.5 * turned(fast), 0.5 * BANK
    attitude = {
        "timestamp": fast * 1e6,
        "q[0]": np.cos(half) * np.cos(bank),
        "q[1]": np.cos(half) * np.sin(bank),
        "q[2]": np.sin(half) * np.sin(bank),
        "q[3]": np.sin(half) * np.cos(bank),
    }
    ones = np.ones(len(fast))
    rates = {
        "timestamp": fast * 1e6,
        "xyz[0]": 0.0 * ones,
        "xyz[1]": RATE * np.sin(BANK) * ones,
        "xyz[2]": RATE * np.cos(BANK) * ones,
    }
    asked = {"timestamp": slow * 1e6, "vx": place["vx"], "vy": place["vy"], "z": place["z"]}
    asked["yawspeed"] = np.where(slow < 110.0, np.nan, RATE)
    return {
        "vehicle_local_position": place,
        "vehicle_attitude": attitude,
        "vehicle_angular_velocity": rates,
        "vehicle_local_position_setpoint": asked,
    }


def test_a_circle_comes_back_as_it_was_flown() -> None:
    series = series_of(circle())
    estimate = series[ESTIMATE.name]
    assert estimate.time[0] == 0.0
    assert estimate.time[-1] == pytest.approx(18.9)
    expected: dict[str, float | np.ndarray] = {
        **{"forward": SPEED, "side": 0.0, "descent": 0.0, "down": -12.0, "roll": BANK, "pitch": 0.0},
        **{"yaw_rate": RATE, "roll_rate": 0.0, "heading": RATE * (1.0 + estimate.time)},
    }
    for field, value in expected.items():
        np.testing.assert_allclose(estimate[field], value, atol=2e-5, err_msg=field)


def test_what_was_not_asked_for_or_not_logged_is_absent_not_zero() -> None:
    series = series_of(circle())
    command = series[COMMAND.name]
    assert command.time[0] == pytest.approx(9.0)
    np.testing.assert_allclose(command["yaw_rate"], RATE)
    np.testing.assert_allclose(command["height"], 12.0)
    assert set(series) == {ESTIMATE.name, COMMAND.name}


def test_ground_truth_of_a_simulator_is_the_truth() -> None:
    topics = circle()
    truths = {f"{name}_groundtruth": topics[name] for name in list(topics)[:3]}
    assert TRUTH.name in series_of({**topics, **truths})


def test_a_log_without_attitude_or_valid_positions_is_refused() -> None:
    topics = circle()
    with pytest.raises(FlightError, match=r"lacks \['vehicle_attitude'\]"):
        series_of({name: part for name, part in topics.items() if name != "vehicle_attitude"})
    place = topics["vehicle_local_position"]
    never = {**place, "xy_valid": np.zeros(len(place["x"]))}
    with pytest.raises(FlightError, match="got none in 200"):
        series_of({**topics, "vehicle_local_position": never})


def test_a_file_that_is_no_ulog_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("pyulog", reason="pyulog is an extra")
    rng = np.random.default_rng(1)
    for content in (b"", b"notes", b"ULog\x01\x12\x35\x01" + rng.bytes(500), rng.bytes(2000)):
        path = tmp_path / "flight.ulg"
        path.write_bytes(content)
        assert run(["import", str(path), "--out", str(tmp_path / "flight.mcap")]) == 2
        assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "flight.mcap").exists()


@pytest.mark.skipif(not DATA.is_dir(), reason="no logs of others beside the project")
def test_a_real_log_is_imported_and_reviewed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("pyulog", reason="pyulog is an extra")
    log = tmp_path / "px4.mcap"
    assert run(["import", str(DATA / "sample_px4_events.ulg"), "--out", str(log), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert "/estimate" in said["held"]
    assert "/truth" in said["absent"]
    flight = read_log(log)
    assert json.loads(flight.attachments[IMPORT_ATTACHMENT])["information"]["ver_hw"] == "PX4_SITL"
    # It hopped to about two metres.
    assert 1.5 < -flight[ESTIMATE]["down"].min() < 4.0
    assert run(["review", str(log), "--html", "--out", str(tmp_path / "review")]) == 0
