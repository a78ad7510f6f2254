"""Tests of what ULogs of PX4 hold: validity, rates, resets and layouts."""

import json
from pathlib import Path

import numpy as np
import pytest
from jaxtyping import Float

from flightlog.attachment_names import IMPORT_ATTACHMENT
from flightlog.events import flight_events
from flightlog.file.reader import read_log
from flightlog.log import FlightLog
from flightlog.motion.continuity import continuous_parts
from flightlog.topics import ACTUATORS, ESTIMATE
from maneuver.app import run
from tests.support.external.flown_circle import HEIGHT, RADIUS, RATE, SPEED, check_circle
from tests.support.external.ulog_writer import Columns, ulog

pytest.importorskip("pyulog", reason="pyulog is an extra")

TIME = 0.05 * np.arange(400)
TURNED = RATE * TIME

Column = Float[np.ndarray, "n"]


def floats(**columns: Column) -> Columns:
    return {name: ("float", column) for name, column in columns.items()}


def stamped(time: Column, fields: Columns) -> Columns:
    return {"timestamp": ("uint64_t", np.rint(1e6 * (time + 1.0))), **fields}


def position(**other: tuple[str, Column]) -> Columns:
    ones = np.ones(len(TIME))
    flags = {f"{name}_valid": ("bool", ones) for name in ("xy", "z", "v_xy", "v_z")}
    numbers = floats(
        x=RADIUS * np.sin(TURNED),
        y=RADIUS * (1.0 - np.cos(TURNED)),
        z=-HEIGHT * ones,
        vx=SPEED * np.cos(TURNED),
        vy=SPEED * np.sin(TURNED),
        vz=0.0 * ones,
    )
    return stamped(TIME, {**numbers, **flags, **other})


def attitude(time: Column = TIME, roll: Column | None = None) -> Columns:
    half, bank = 0.5 * RATE * time, 0.5 * (np.zeros(len(time)) if roll is None else roll)
    parts = (
        np.cos(half) * np.cos(bank),
        np.cos(half) * np.sin(bank),
        np.sin(half) * np.sin(bank),
        np.sin(half) * np.cos(bank),
    )
    return stamped(time, {f"q[{place}]": ("float", part) for place, part in enumerate(parts)})


def imported(folder: Path, topics: dict[str, Columns]) -> FlightLog:
    path, out = folder / "FLIGHT.ULG", folder / "flight.mcap"
    path.write_bytes(ulog(topics))
    assert run(["import", str(path), "--out", str(out)]) == 0
    return read_log(out)


def test_a_position_that_is_not_valid_drops_neither_attitude_nor_height(tmp_path: Path) -> None:
    valid = (TIME < 6.0) | (TIME >= 12.0)
    topics = {
        "vehicle_attitude": attitude(),
        "vehicle_local_position": position(xy_valid=("bool", valid.astype(float))),
    }
    log = imported(tmp_path, topics)
    states = log[ESTIMATE]
    np.testing.assert_allclose(states.time, TIME, atol=1e-9)
    np.testing.assert_array_equal(np.isfinite(states["north"]), valid)
    for name in ("down", "heading", "roll", "forward"):
        assert np.isfinite(states[name]).all(), name
    check_circle(states, atol=1e-5)
    before, after = continuous_parts(log)
    assert before.duration == pytest.approx(5.95)
    assert after.duration == pytest.approx(7.95)
    check_circle(after[ESTIMATE], atol=1e-5, start=12.0)
    for words in (["--html"], ["--png"], ["--json"]):
        target = [] if words == ["--json"] else ["--out", str(tmp_path / "review"), "--force"]
        assert run(["review", str(tmp_path / "flight.mcap"), *words, *target]) == 0


def test_motors_that_are_not_a_number_until_armed_are_kept(tmp_path: Path) -> None:
    armed = np.where(TIME < 2.0, np.nan, 0.5 + 0.1 * np.sin(TIME))
    motors = {"control[0]": ("float", armed), "control[1]": ("float", np.full(len(TIME), np.nan))}
    topics = {
        "vehicle_attitude": attitude(),
        "vehicle_local_position": position(),
        "actuator_motors": stamped(TIME, motors),
    }
    found = imported(tmp_path, topics)[ACTUATORS]
    assert found.topic.field_names == ("control_1",)
    np.testing.assert_allclose(found.time, TIME[TIME >= 2.0], atol=1e-9)
    np.testing.assert_allclose(found["control_1"], armed[TIME >= 2.0], atol=1e-6)


def test_every_state_has_the_rate_of_the_fastest_sensor(tmp_path: Path) -> None:
    fast = 0.01 * np.arange(2000)
    swing = 2.0 * np.pi * 9.0
    rates = {"xyz[0]": ("float", 0.5 * np.sin(swing * fast))}
    rates |= {f"xyz[{axis}]": ("float", np.full(len(fast), rate)) for axis, rate in ((1, 0.0), (2, RATE))}
    topics = {
        "vehicle_attitude": attitude(0.02 * np.arange(1000)),
        "vehicle_local_position": position(),
        "vehicle_angular_velocity": stamped(fast, rates),
    }
    states = imported(tmp_path, topics)[ESTIMATE]
    np.testing.assert_allclose(np.diff(states.time), 0.01, atol=1e-9)
    np.testing.assert_allclose(states["roll_rate"], 0.5 * np.sin(swing * states.time), atol=1e-5)
    # Between two positions, 50 ms apart, the circle bends by a quarter of a millimetre.
    check_circle(states, fields=["north", "east", "forward", "heading"], atol=3e-4)


def test_body_rates_of_old_logs_are_read(tmp_path: Path) -> None:
    wobble = RATE + 0.3 * np.sin(20.0 * TIME)
    old = floats(rollspeed=0.0 * TIME, pitchspeed=0.0 * TIME, yawspeed=wobble)
    topics = {"vehicle_attitude": {**attitude(), **old}, "vehicle_local_position": position()}
    states = imported(tmp_path, topics)[ESTIMATE]
    np.testing.assert_allclose(states["yaw_rate"], wobble, atol=1e-5)


def test_the_time_may_be_anywhere_in_a_message(tmp_path: Path) -> None:
    def last(columns: Columns) -> Columns:
        return {
            **{name: column for name, column in columns.items() if name != "timestamp"},
            "timestamp": columns["timestamp"],
        }

    topics = {"vehicle_attitude": last(attitude()), "vehicle_local_position": last(position())}
    states = imported(tmp_path, topics)[ESTIMATE]
    np.testing.assert_allclose(states.time, TIME, atol=1e-9)
    check_circle(states, atol=1e-5)


def test_resets_are_marked_and_no_part_of_a_maneuver(tmp_path: Path) -> None:
    late = TIME >= 10.0
    shifted = ("float", RADIUS * np.sin(TURNED) + np.where(late, 7.0, 0.0))
    topics = {
        "vehicle_attitude": attitude(),
        "vehicle_local_position": position(x=shifted, xy_reset_counter=("uint8_t", late.astype(float))),
    }
    log = imported(tmp_path, topics)
    (found,) = json.loads(log.attachments[IMPORT_ATTACHMENT])["breaks"]
    assert found["time"] == pytest.approx(10.0)
    assert found["reason"] == "the estimator reset its xy; the position jumps by 7.00 m"
    assert any(event.source == "log" and "jumps by 7.00 m" in event.text for event in flight_events(log))
    before, after = continuous_parts(log)
    assert [before.duration, after.duration] == pytest.approx([9.95, 9.95])


def test_a_log_with_the_receiver_alone_has_its_positions(tmp_path: Path) -> None:
    pytest.importorskip("pymap3d", reason="pymap3d is an extra")
    ones = np.ones(len(TIME))
    fixes: Columns = {
        "latitude_deg": ("float", 0.0 * ones),
        "longitude_deg": ("float", 0.0 * ones),
        "altitude_msl_m": ("float", 100.0 + TIME),
        "fix_type": ("uint8_t", 3.0 * ones),
    }
    # A float has seven digits: at the equator near 0 they are enough for a line to the east.
    line = {**fixes, "longitude_deg": ("float", 1e-4 + 1e-5 * TIME)}
    log = imported(tmp_path, {"vehicle_attitude": attitude(), "vehicle_gps_position": stamped(TIME, line)})
    states = log[ESTIMATE]
    metres = np.radians(1e-5) * (6_378_137.0 + 100.0)
    np.testing.assert_allclose(states["east"], metres * states.time, atol=1e-3)
    np.testing.assert_allclose(states["down"], -states.time, atol=1e-4)
    assert "local plane at" in json.loads(log.attachments[IMPORT_ATTACHMENT])["place"]
