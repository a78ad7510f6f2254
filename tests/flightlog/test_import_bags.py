"""Tests of the containers, stamps and frames of imported bags."""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zstandard
from mcap.writer import Writer

from flightlog.attachment_names import IMPORT_ATTACHMENT
from flightlog.file.reader import read_log
from flightlog.log import FlightLog
from flightlog.motion.continuity import continuous_parts
from flightlog.topics import ESTIMATE
from maneuver.app import run
from tests.support.external.circle_bag import (
    EAST,
    NORTH,
    START,
    TURNED,
    Message,
    json_bag,
    messages_of,
    odometry,
)
from tests.support.external.flown_circle import HEIGHT, RATE, SPEED, TIME, check_circle


def imported(folder: Path, content: bytes, *options: str, name: str = "bag.mcap", code: int = 0) -> FlightLog:
    path, out = folder / name, folder / "flight.mcap"
    path.write_bytes(content)
    assert run(["import", str(path), "--pose", "/odom", *options, "--out", str(out), "--force"]) == code
    return read_log(out)


def refused(folder: Path, capsys: pytest.CaptureFixture[str], content: bytes, *options: str) -> str:
    path, out = folder / "bag.mcap", folder / "refused.mcap"
    path.write_bytes(content)
    assert run(["import", str(path), *options, "--out", str(out)]) == 2
    assert not out.exists()
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    return message


def swapped() -> list[int]:
    order = list(range(len(TIME)))
    order[100:200:2], order[101:200:2] = order[101:200:2], order[100:200:2]
    return order


def taken(log: FlightLog) -> Message:
    content: Message = json.loads(log.attachments[IMPORT_ATTACHMENT])
    return content


@pytest.mark.parametrize(
    ("content", "name"),
    [
        (json_bag(messages_of()), "bag.mcap"),
        (json_bag(messages_of(swapped())), "bag.mcap"),
        (json_bag(messages_of(), repeated=False), "bag.mcap"),
        (json_bag(messages_of(), compressed=True), "bag.mcap"),
        (zstandard.compress(json_bag(messages_of())), "bag.mcap.zstd"),
    ],
    ids=["plain", "out of order", "without a summary", "messages compressed", "file compressed"],
)
def test_a_bag_is_read_in_any_container(tmp_path: Path, content: bytes, name: str) -> None:
    log = imported(tmp_path, content, name=name)
    np.testing.assert_allclose(log[ESTIMATE].time, TIME, atol=1e-6)
    check_circle(log[ESTIMATE], atol=2e-6)
    assert taken(log)["times"] == "of the messages"


def test_a_first_message_of_nulls_is_a_hole_and_no_reason_to_refuse(tmp_path: Path) -> None:
    empty = {**odometry(0), "pose": None, "twist": None}
    states = imported(tmp_path, json_bag([(0.003, empty), *messages_of(range(1, 1000))]))[ESTIMATE]
    assert len(states) == 999
    check_circle(states, atol=2e-6, start=0.02)


@pytest.mark.parametrize(("bad", "code"), [(1, 0), (50, 3)])
def test_messages_that_cannot_be_decoded_are_left_out_and_counted(
    tmp_path: Path, bad: int, code: int
) -> None:
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    channel = writer.register_channel(
        "/odom", "json", writer.register_schema("nav_msgs/msg/Odometry", "jsonschema", b"{}")
    )
    for place, (time, message) in enumerate(messages_of()):
        data = b"{" if 300 <= place < 300 + bad else json.dumps(message).encode()
        writer.add_message(channel, START * 10**9 + round(time * 1e9), data, 0)
    writer.finish()  # type: ignore[no-untyped-call]
    log = imported(tmp_path, stream.getvalue(), code=code)
    assert taken(log)["left out"] == [f"{bad} of 1000 /odom messages left out: {bad} that cannot be decoded"]
    check_circle(log[ESTIMATE], atol=2e-6)


def test_a_dropout_stays_a_hole(tmp_path: Path) -> None:
    log = imported(tmp_path, json_bag(messages_of([*range(300), *range(600, 1000)])))
    check_circle(log[ESTIMATE], atol=2e-6)
    assert np.diff(log[ESTIMATE].time).max() == pytest.approx(6.02)
    assert [round(part.duration, 3) for part in continuous_parts(log)] == [5.98, 7.98]


def test_a_loop_closure_is_marked(tmp_path: Path) -> None:
    messages = messages_of()
    for _, message in messages[500:]:
        message["pose"]["pose"]["position"]["x"] += 5.0
    log = imported(tmp_path, json_bag(messages))
    (found,) = taken(log)["breaks"]
    assert (found["start"], found["time"]) == (pytest.approx(9.98), pytest.approx(10.0))
    assert found["reason"] == "the position jumps by 5.00 m"
    assert len(continuous_parts(log)) == 2


def in_frame(child: str, velocity: bool) -> list[tuple[float, Message]]:
    messages = []
    for place, (time, message) in enumerate(messages_of()):
        if velocity:
            along = {"x": SPEED * np.sin(TURNED[place]), "y": SPEED * np.cos(TURNED[place]), "z": 0.0}
            message["twist"]["twist"]["linear"] = along
        messages.append((time, {**message, "child_frame_id": child}))
    return messages


def test_a_twist_in_the_frame_of_the_world_is_taken_as_such(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    check_circle(imported(tmp_path, json_bag(in_frame("/odom", velocity=True)))[ESTIMATE], atol=2e-6)
    contradicting = json_bag(in_frame("base_link", velocity=True))
    assert "give --velocity-in world" in refused(tmp_path, capsys, contradicting, "--pose", "/odom")


def test_two_vehicles_on_one_topic_are_told_apart(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    both = [
        (time, message)
        for place in range(1000)
        for time, message in (
            (TIME[place], odometry(place)),
            (TIME[place] + 0.01, odometry(999 - place, child="other")),
        )
    ]
    assert "give --child-frame, one of base_link (1000), other (1000)" in refused(
        tmp_path, capsys, json_bag(both), "--pose", "/odom"
    )
    check_circle(imported(tmp_path, json_bag(both), "--child-frame", "base_link")[ESTIMATE], atol=2e-6)


def test_transforms_need_a_pair_of_frames(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    messages = []
    for place, (time, message) in enumerate(messages_of()):
        pose = message["pose"]["pose"]
        head = {"header": message["header"], "child_frame_id": "base_link"}
        moving = {**head, "transform": {"translation": pose["position"], "rotation": pose["orientation"]}}
        fixed = {
            **moving,
            "child_frame_id": "camera",
            "transform": {
                "translation": {"x": 1, "y": 0, "z": 0},
                "rotation": {"x": 0, "y": 0, "z": 0, "w": 1},
            },
        }
        messages.append((time, {"transforms": [moving, fixed] if place % 2 else [moving]}))
    content = json_bag(messages, schema="tf2_msgs/msg/TFMessage")
    refusal = refused(tmp_path, capsys, content, "--pose", "/odom")
    assert "give --frames FRAME CHILD, one of odom base_link (1000), odom camera (500)" in refusal
    states = imported(tmp_path, content, "--frames", "odom", "base_link")[ESTIMATE]
    check_circle(states, fields=["north", "east", "down", "heading", "yaw_rate"], atol=2e-6)


def px4(row: int, time: float) -> Message:
    half = 0.5 * TURNED[row]
    return {
        "timestamp": round((time + 50.0) * 1e6),
        "position": [NORTH[row], EAST[row], -HEIGHT],
        "q": [np.cos(half), 0.0, 0.0, np.sin(half)],
        "velocity": [SPEED, 0.0, 0.0],
        "velocity_frame": 3,
        "angular_velocity": [0.0, 0.0, RATE],
    }


def test_messages_of_px4_are_read_by_their_stamps_and_in_their_frame(tmp_path: Path) -> None:
    # Logged in bursts of ten.
    bursts = [
        (0.2 + TIME[place // 10 * 10] + 1e-4 * (place % 10), px4(place, TIME[place])) for place in range(1000)
    ]
    log = imported(tmp_path, json_bag(bursts, schema="px4_msgs/msg/VehicleOdometry"))
    np.testing.assert_allclose(log[ESTIMATE].time, TIME, atol=1e-6)
    check_circle(log[ESTIMATE])
    local = [
        {
            "timestamp": round(time * 1e6) + 1,
            "xy_valid": not 300 <= place < 600,
            "x": NORTH[place],
            "y": EAST[place],
            "z": -HEIGHT,
            "vx": SPEED * np.cos(TURNED[place]),
            "vy": SPEED * np.sin(TURNED[place]),
            "vz": 0.0,
            "heading": TURNED[place],
        }
        for place, time in enumerate(TIME)
    ]
    content = json_bag(zip(TIME, local, strict=True), schema="px4_msgs/msg/VehicleLocalPosition")
    states = imported(tmp_path, content)[ESTIMATE]
    check_circle(states)
    assert np.isnan(states["north"]).sum() == 300
    assert np.isfinite(states["down"]).all()


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("timestamp", lambda time: START * 10**9 + round(time * 1e9)),
        ("timestamp", lambda time: START * 10**3 + round(time * 1e3)),
        ("timestamp", lambda time: START + time),
        ("stamp", lambda time: round(time * 1e6)),
        ("timestamp", lambda time: f"2023-11-14T22:13:{20 + time:09.6f}Z"),
    ],
    ids=["nanoseconds", "milliseconds", "seconds", "microseconds since the start", "RFC 3339"],
)
def test_stamps_of_json_are_used_whatever_they_are(tmp_path: Path, key: str, value: Any) -> None:
    jitter = np.random.default_rng(1).random(1000) * 0.019
    messages = []
    for place, time in enumerate(TIME.tolist()):
        message = odometry(place)
        del message["header"]
        messages.append((time + jitter[place], {key: value(time), **message}))
    log = imported(tmp_path, json_bag(messages))
    assert taken(log)["times"] == "of the messages"
    np.testing.assert_allclose(log[ESTIMATE].time, TIME, atol=1e-6)
    check_circle(log[ESTIMATE], atol=2e-6)


def test_the_order_of_listed_quaternions_is_that_of_an_upright_vehicle(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for order in ("wxyz", "xyzw"):
        messages = []
        for time, message in messages_of():
            pose = message["pose"]["pose"]
            listed = {**pose, "orientation": [pose["orientation"][axis] for axis in order]}
            messages.append((time, {**message, "pose": {"pose": listed}}))
        log = imported(tmp_path, json_bag(messages))
        assert taken(log)["quaternions"] == f"lists of {order}"
        check_circle(log[ESTIMATE], atol=2e-6)
    unclear = [
        (time, {"position": [0, 0, 0], "orientation": [0.5, 0.5, 0.5, 0.5]}) for time, _ in messages_of()
    ]
    assert "give --quaternion-order wxyz or" in refused(
        tmp_path, capsys, json_bag(unclear), "--pose", "/odom"
    )


def test_fixes_of_a_receiver_are_laid_on_a_plane(tmp_path: Path) -> None:
    pytest.importorskip("pymap3d", reason="pymap3d is an extra")
    fixes = [
        (time, {"latitude": 0.0, "longitude": 8.0 + 1e-5 * time, "altitude": 400.0 + time})
        for time in TIME.tolist()
    ]
    log = imported(tmp_path, json_bag(fixes, schema="sensor_msgs/msg/NavSatFix"))
    # Along the equator of WGS 84.
    np.testing.assert_allclose(log[ESTIMATE]["east"], np.radians(1e-5) * 6_378_537.0 * TIME, atol=1e-6)
    np.testing.assert_allclose(log[ESTIMATE]["down"], -TIME, atol=1e-6)
    assert "local plane at 0.0000000, 8.0000000, 400.00 m (WGS 84)" in taken(log)["place"]


def test_without_a_topic_those_that_may_be_poses_are_listed_first(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    refusal = refused(tmp_path, capsys, json_bag(messages_of()))
    assert "expected --pose TOPIC" in refusal
    assert "it has /odom (nav_msgs/msg/Odometry)" in refusal


def test_a_review_of_a_file_of_another_program_names_the_import(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bag.mcap"
    for content in (json_bag(messages_of(range(10))), b"ULog of PX4"):
        path.write_bytes(content)
        assert run(["review", str(path)]) == 2
        assert "`maneuver import`" in capsys.readouterr().err
