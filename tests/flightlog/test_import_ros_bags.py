"""Tests of bags as ROS records them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flightlog.file.reader import read_log
from flightlog.topics import ESTIMATE
from maneuver.app import run
from tests.support.external.circle_bag import START, odometry
from tests.support.external.flown_circle import TIME, check_circle


@pytest.mark.parametrize("kind", ["ros1", "sqlite3", "mcap"])
def test_bags_as_ros_records_them_are_read(tmp_path: Path, kind: str) -> None:
    highlevel = pytest.importorskip("rosbags.typesys", reason="rosbags is an extra")
    from rosbags import rosbag1, rosbag2

    stores = highlevel.Stores
    store = highlevel.get_typestore(stores.ROS1_NOETIC if kind == "ros1" else stores.ROS2_HUMBLE)
    path = tmp_path / ("flight.bag" if kind == "ros1" else "flight")
    name = "nav_msgs/msg/Odometry"
    if kind == "ros1":
        writer: Any = rosbag1.Writer(path)
    else:
        writer = rosbag2.Writer(path, version=8, storage_plugin=rosbag2.StoragePlugin[kind.upper()])
    with writer:
        connection = writer.add_connection("/odom", name, typestore=store)
        for place, time in enumerate(TIME.tolist()):
            message = ros_odometry(store.types, place, seq=kind == "ros1")
            data = (
                store.serialize_ros1(message, name) if kind == "ros1" else store.serialize_cdr(message, name)
            )
            writer.write(connection, START * 10**9 + round(time * 1e9) + 3_000_000, data)
    out = tmp_path / "out.mcap"
    assert run(["import", str(path), "--pose", "/odom", "--out", str(out)]) == 0
    check_circle(read_log(out)[ESTIMATE], atol=2e-6)


def ros_odometry(types: Any, row: int, *, seq: bool) -> Any:
    """Returns odometry as an object of rosbags."""
    plain, zeros = odometry(row), np.zeros(36)
    pose, twist = plain["pose"]["pose"], plain["twist"]["twist"]

    def made(name: str, *values: Any) -> Any:
        return types[name](*values)

    time = made(
        "builtin_interfaces/msg/Time", plain["header"]["stamp"]["sec"], plain["header"]["stamp"]["nanosec"]
    )
    header = made("std_msgs/msg/Header", *([row] if seq else []), time, "odom")
    vectors = [
        made("geometry_msgs/msg/Vector3", *(twist[part][axis] for axis in "xyz"))
        for part in ("linear", "angular")
    ]
    place = made("geometry_msgs/msg/Point", *(pose["position"][axis] for axis in "xyz"))
    attitude = made("geometry_msgs/msg/Quaternion", *(float(pose["orientation"][axis]) for axis in "xyzw"))
    return made(
        "nav_msgs/msg/Odometry",
        header,
        "base_link",
        made("geometry_msgs/msg/PoseWithCovariance", made("geometry_msgs/msg/Pose", place, attitude), zeros),
        made("geometry_msgs/msg/TwistWithCovariance", made("geometry_msgs/msg/Twist", *vectors), zeros),
    )
