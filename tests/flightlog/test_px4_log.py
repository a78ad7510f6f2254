"""Tests of the import of PX4 logs."""

import json
from pathlib import Path

import numpy as np
import pytest

from flight.errors import FlightError
from flightlog.attachment_names import IMPORT_ATTACHMENT
from flightlog.events import Level, flight_events
from flightlog.file.reader import read_log
from flightlog.imports.px4_log import series_of
from flightlog.imports.ulog_reader import Messages
from flightlog.series import Series
from flightlog.topics import ACTUATORS, COMMAND, ESTIMATE, TRUTH, WIND
from maneuver.app import run

# Data beside the project, not part of it.
DATA = Path(__file__).parents[3] / "shared" / "data"
SPEED, RATE, BANK = 5.0, 0.4, 0.2


def circle() -> dict[str, Messages]:
    """Returns PX4's topics of a right-hand circle in closed form.

    The bank is constant; positions are invalid for the first second.
    """
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
    setpoint = {"timestamp": slow * 1e6, "vx": place["vx"], "vy": place["vy"], "z": place["z"]}
    setpoint["yawspeed"] = np.where(slow < 110.0, np.nan, RATE)
    return {
        "vehicle_local_position": place,
        "vehicle_attitude": attitude,
        "vehicle_angular_velocity": rates,
        "vehicle_local_position_setpoint": setpoint,
    }


def test_a_circle_comes_back_as_it_was_flown() -> None:
    series = series_of(circle())
    estimate = series[ESTIMATE.name]
    assert estimate.time[0] == pytest.approx(101.0)
    assert estimate.time[-1] == pytest.approx(119.9)
    expected: dict[str, float | np.ndarray] = {
        **{"forward": SPEED, "side": 0.0, "descent": 0.0, "down": -12.0, "roll": BANK, "pitch": 0.0},
        **{"yaw_rate": RATE, "roll_rate": 0.0, "heading": RATE * (estimate.time - 100.0)},
    }
    for field, value in expected.items():
        np.testing.assert_allclose(estimate[field], value, atol=2e-5, err_msg=field)


def test_what_was_not_asked_for_or_not_logged_is_absent_not_zero() -> None:
    series = series_of(circle())
    command = series[COMMAND.name]
    assert command.time[0] == pytest.approx(110.0)
    np.testing.assert_allclose(command["yaw_rate"], RATE)
    np.testing.assert_allclose(command["height"], 12.0)
    assert set(series) == {ESTIMATE.name, COMMAND.name}


def test_ground_truth_of_a_simulator_is_the_truth() -> None:
    topics = circle()
    truths = {f"{name}_groundtruth": topics[name] for name in list(topics)[:3]}
    assert TRUTH.name in series_of({**topics, **truths})


def test_what_is_not_valid_or_not_logged_is_absent_and_the_rest_is_there() -> None:
    topics = circle()
    place = topics["vehicle_local_position"]
    never = {**place, "xy_valid": np.zeros(len(place["x"]))}
    estimate = series_of({**topics, "vehicle_local_position": never})[ESTIMATE.name]
    assert not estimate.has_fields("north")
    assert not estimate.has_fields("east")
    np.testing.assert_allclose(estimate["forward"], SPEED, atol=2e-5)
    np.testing.assert_allclose(estimate["down"], -12.0)
    partial = {name: part for name, part in topics.items() if name != "vehicle_attitude"}
    without_attitude = series_of(partial)[ESTIMATE.name]
    assert set(without_attitude.topic.field_names) == {
        *("north", "east", "down", "descent", "roll_rate", "pitch_rate", "body_yaw_rate")
    }
    assert COMMAND.name not in series_of(partial)
    with pytest.raises(FlightError, match="expected at least two messages of one of"):
        series_of({"vehicle_local_position_setpoint": topics["vehicle_local_position_setpoint"]})


def test_wind_without_a_variance_is_no_wind() -> None:
    time = 100e6 + 1e6 * np.arange(20.0)
    wind = {"timestamp": time, "windspeed_north": np.full(20, 3.0), "windspeed_east": np.full(20, -1.0)}
    guessed = {**wind, "variance_north": np.where(np.arange(20) < 5, 0.0, 0.4)}
    found = series_of({**circle(), "wind": guessed})[WIND.name]
    assert found.topic.field_names == ("north", "east")
    assert len(found) == 15
    idle = {**wind, "variance_north": np.zeros(20)}
    assert WIND.name not in series_of({**circle(), "wind_estimate": idle})


def test_controls_that_never_move_are_absent() -> None:
    time = 100e6 + 1e4 * np.arange(1000.0)
    motors = {"timestamp": time, "control[0]": np.sin(1e-6 * time), "control[1]": np.zeros(1000)}
    motors["control[2]"] = np.full(1000, np.nan)
    found = series_of({**circle(), "actuator_motors": motors})[ACTUATORS.name]
    assert found.topic.field_names == ("control_1",)


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
    summary = json.loads(capsys.readouterr().out)
    assert "/estimate" in summary["held"]
    assert "/truth" in summary["absent"]
    flight = read_log(log)
    assert json.loads(flight.attachments[IMPORT_ATTACHMENT])["information"]["ver_hw"] == "PX4_SITL"
    messages = [event for event in flight_events(flight) if event.source == "autopilot"]
    assert any(event.text.endswith("Preflight: GPS fix too low") for event in messages)
    assert {event.level for event in messages} >= {Level.INFO, Level.WARNING}
    # It hopped to about two metres.
    assert 1.5 < -np.nanmin(flight[ESTIMATE]["down"]) < 4.0
    assert run(["review", str(log), "--html", "--out", str(tmp_path / "review")]) == 0


@pytest.mark.skipif(not DATA.is_dir(), reason="no logs of others beside the project")
def test_a_real_log_without_an_estimated_position_has_that_of_its_receiver(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("pyulog", reason="pyulog is an extra")
    log = tmp_path / "bench.mcap"
    assert run(["import", str(DATA / "sample_log_small.ulg"), "--out", str(log), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["absent_of_the_state"] == []
    assert summary["import"]["place"].startswith("local plane at 63.4170")
    flight = read_log(log)
    # On a bench, at one place within the error of the receiver.
    assert np.nanmax(np.hypot(flight[ESTIMATE]["north"], flight[ESTIMATE]["east"])) < 5.0
    assert flight[ESTIMATE].has_fields("down", "roll", "pitch", "heading", "roll_rate")
    assert flight[ACTUATORS].has_fields("control_1", "control_4")
    # Its wind estimator never ran; the logged zeros are no estimate.
    assert WIND.name not in flight.series
    assert run(["review", str(log), "--html", "--png", "--json", "--out", str(tmp_path / "review")]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["distance"] < 100.0
    assert {Path(path).name for path in summary["files"]} == {
        *("bench.html", "flight.png", "track.png", "velocities.png", "attitude_and_controls.png")
    }


@pytest.mark.skipif(not DATA.is_dir(), reason="no logs of others beside the project")
def test_the_intact_part_of_a_damaged_log_is_imported_with_exit_code_3(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("pyulog", reason="pyulog is an extra")
    content = (DATA / "sample_px4_events.ulg").read_bytes()
    middle, rng = len(content) // 2, np.random.default_rng(3)
    damaged = {
        "cut": content[: middle + 5],
        "torn": content[:middle] + content[middle + 10_000 :],
        "scribbled": content[:middle] + rng.bytes(5000) + content[middle + 5000 :],
    }
    whole = series_of_file(DATA / "sample_px4_events.ulg", tmp_path, capsys, code=0)
    for name, part in damaged.items():
        path = tmp_path / f"{name}.ulg"
        path.write_bytes(part)
        found = series_of_file(path, tmp_path, capsys, code=3)
        # Recovered samples are unchanged, those after the damage included.
        both = np.isin(np.rint(found.time * 1e3), np.rint(whole.time * 1e3))
        kept = np.isin(np.rint(whole.time * 1e3), np.rint(found.time * 1e3))
        assert both.mean() > 0.98
        close = np.isclose(found["down"][both], whole["down"][kept], atol=1e-6, equal_nan=True)
        assert close.mean() > 0.98
        assert (found.time[-1] > 0.9 * whole.time[-1]) == (name != "cut")


def series_of_file(path: Path, folder: Path, capsys: pytest.CaptureFixture[str], *, code: int) -> Series:
    out = folder / f"{path.stem}.mcap"
    assert run(["import", str(path), "--out", str(out), "--force"]) == code
    message = capsys.readouterr().err
    assert message.count("\n") == (1 if code else 0)
    log = read_log(out)
    assert ("recovered with loss" in log.header.outcome) == bool(code)
    return log[ESTIMATE]
