"""MCAP files of a known motion in ROS 2, protobuf and JSON.

Axes (east, north, up and forward, left, up) are converted by matrices, which the importer does not use.
"""

import io
import json
from collections.abc import Iterator, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.Odometry_pb2 import Odometry
from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import Message
from jaxtyping import Float
from mcap.writer import Writer
from mcap_ros2.writer import Writer as RosWriter
from scipy.spatial.transform import Rotation

from flightlog.series import Series

START = 1_700_000_000.0
"""Start of the bags, seconds since the epoch."""

_LATE = 0.004
"""Seconds from a measurement to its logging."""

_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
_FLU = np.diag([1.0, -1.0, -1.0])

_VECTOR = "float64 x\nfloat64 y\nfloat64 z\n"
_PARTS = {
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "geometry_msgs/Point": _VECTOR,
    "geometry_msgs/Vector3": _VECTOR,
    "geometry_msgs/Quaternion": f"{_VECTOR}float64 w\n",
    "geometry_msgs/Pose": "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    "geometry_msgs/Twist": "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
    "geometry_msgs/PoseWithCovariance": "geometry_msgs/Pose pose\nfloat64[36] covariance\n",
    "geometry_msgs/TwistWithCovariance": "geometry_msgs/Twist twist\nfloat64[36] covariance\n",
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
}
_HEADS = {
    "geometry_msgs/msg/PoseStamped": "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
    "geometry_msgs/msg/TwistStamped": "std_msgs/Header header\ngeometry_msgs/Twist twist\n",
    "nav_msgs/msg/Odometry": "std_msgs/Header header\nstring child_frame_id\n"
    "geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n",
    "px4_msgs/msg/VehicleOdometry": "uint64 timestamp\nfloat32[3] position\nfloat32[4] q\n"
    "float32[3] velocity\nfloat32[3] angular_velocity\n",
}


class MatrixMotion:
    """Motion in matrices, north-east-down and forward-right-down.

    Args:
        states: states with all fields.
    """

    def __init__(self, states: Series) -> None:
        self.time = states.time
        self.place = np.column_stack([states[name] for name in ("north", "east", "down")])
        angles = np.column_stack([states[name] for name in ("heading", "pitch", "roll")])
        self.attitude = Rotation.from_euler("ZYX", angles).as_matrix()
        level = Rotation.from_euler("z", states["heading"][:, None]).as_matrix()
        along = np.column_stack([states[name] for name in ("forward", "side", "descent")])
        self.velocity = np.einsum("nij,nj->ni", level, along)
        self.turning = np.column_stack([states[f"{name}_rate"] for name in ("roll", "pitch", "body_yaw")])

    @property
    def quaternions(self) -> Float[np.ndarray, "n 4"]:
        """Quaternions x, y, z, w, forward-left-up to east-north-up."""
        return np.asarray(Rotation.from_matrix(_ENU @ self.attitude @ _FLU).as_quat())

    @property
    def in_body(self) -> Float[np.ndarray, "n 3"]:
        """Velocities along forward, left, up."""
        return np.asarray(np.einsum("nji,nj->ni", self.attitude, self.velocity) @ _FLU)

    @property
    def turning_in_world(self) -> Float[np.ndarray, "n 3"]:
        """Body rates about east, north, up."""
        return np.asarray(np.einsum("nij,nj->ni", self.attitude, self.turning) @ _ENU.T)


def ros2_bag(states: Series, *, topics: Sequence[str] = ()) -> bytes:
    """Returns a ROS 2 bag of poses, velocities and odometry.

    Topics are `/pose`, `/velocity` (world axes), `/odom` (body axes) and PX4's odometry.

    Args:
        states: states with all fields.
        topics: topics to write; all if empty.
    """
    motion, stream = MatrixMotion(states), io.BytesIO()
    writer = RosWriter(stream)
    schemas = {name: writer.register_msgdef(name, _definition(name)) for name in _HEADS}
    for topic, name, message, time in _in_time(motion):
        if topics and topic not in topics:
            continue
        stamp = round((START + time) * 1e9)
        writer.write_message(topic, schemas[name], message, round(stamp + _LATE * 1e9), stamp)
    writer.finish()  # type: ignore[no-untyped-call]
    return stream.getvalue()


def _definition(name: str) -> str:
    parts = [_HEADS[name]]
    parts += [f"{'=' * 80}\nMSG: {part}\n{text}" for part, text in _PARTS.items()]
    return "".join(parts)


def _in_time(motion: MatrixMotion) -> Iterator[tuple[str, str, Any, float]]:
    quaternions = motion.quaternions
    wxyz = Rotation.from_matrix(motion.attitude).as_quat()[:, [3, 0, 1, 2]]
    east_north_up, moving = motion.place @ _ENU.T, motion.velocity @ _ENU.T
    turning, spinning = motion.turning @ _FLU, motion.turning_in_world
    zeros = [0.0] * 36
    for row, time in enumerate(motion.time.tolist()):
        nanoseconds = round((START + time) * 1e9)
        stamp = SimpleNamespace(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9)
        header = SimpleNamespace(stamp=stamp, frame_id="map")
        pose = SimpleNamespace(position=_xyz(east_north_up[row]), orientation=_xyz(quaternions[row]))
        world = SimpleNamespace(linear=_xyz(moving[row]), angular=_xyz(spinning[row]))
        body = SimpleNamespace(linear=_xyz(motion.in_body[row]), angular=_xyz(turning[row]))
        yield "/pose", "geometry_msgs/msg/PoseStamped", SimpleNamespace(header=header, pose=pose), time
        yield "/velocity", "geometry_msgs/msg/TwistStamped", SimpleNamespace(header=header, twist=world), time
        odometry = SimpleNamespace(
            header=header,
            child_frame_id="base_link",
            pose=SimpleNamespace(pose=pose, covariance=zeros),
            twist=SimpleNamespace(twist=body, covariance=zeros),
        )
        yield "/odom", "nav_msgs/msg/Odometry", odometry, time
        px4 = SimpleNamespace(
            timestamp=nanoseconds // 1000,
            position=motion.place[row].tolist(),
            q=wxyz[row].tolist(),
            velocity=motion.velocity[row].tolist(),
            angular_velocity=motion.turning[row].tolist(),
        )
        yield "/fmu/out/vehicle_odometry", "px4_msgs/msg/VehicleOdometry", px4, time


def plain_bag(states: Series) -> bytes:
    """Returns a file of poses and odometry in protobuf and JSON.

    Topics are `/pose` and `/odometry` in protobuf, `/json_pose` and `/json_velocity` in JSON.
    """
    motion, stream = MatrixMotion(states), io.BytesIO()
    writer = Writer(stream)
    writer.start()
    channels = {
        topic: writer.register_channel(
            topic, "protobuf", writer.register_schema(kind.DESCRIPTOR.full_name, "protobuf", _described(kind))
        )
        for topic, kind in (("/pose", PoseInFrame), ("/odometry", Odometry))
    }
    for topic in ("/json_pose", "/json_velocity"):
        channels[topic] = writer.register_channel(topic, "json", 0)
    for row, time in enumerate(motion.time.tolist()):
        nanoseconds = round((START + time) * 1e9)
        for topic, content in _messages(motion, row, nanoseconds):
            writer.add_message(channels[topic], nanoseconds, content, nanoseconds)
    writer.finish()  # type: ignore[no-untyped-call]
    return stream.getvalue()


def _messages(motion: MatrixMotion, row: int, nanoseconds: int) -> Iterator[tuple[str, bytes]]:
    place, quaternion = (motion.place @ _ENU.T)[row], motion.quaternions[row]
    pose = PoseInFrame(frame_id="map")
    odometry = Odometry(frame_id="map", body_frame_id="base_link")
    for message in (pose, odometry):
        message.timestamp.FromNanoseconds(nanoseconds)
        for axis, value in zip("xyz", place.tolist(), strict=True):
            setattr(message.pose.position, axis, value)
        for axis, value in zip("xyzw", quaternion.tolist(), strict=True):
            setattr(message.pose.orientation, axis, value)
    turning = motion.turning @ _FLU
    for axis, along, about in zip("xyz", motion.in_body[row].tolist(), turning[row].tolist(), strict=True):
        setattr(odometry.linear_velocity, axis, along)
        setattr(odometry.angular_velocity, axis, about)
    yield "/pose", pose.SerializeToString()
    yield "/odometry", odometry.SerializeToString()
    content = {"position": dict(zip("xyz", place.tolist(), strict=True))}
    content["orientation"] = dict(zip("xyzw", quaternion.tolist(), strict=True))
    yield "/json_pose", json.dumps(content).encode()
    moving = dict(zip("xyz", (motion.velocity @ _ENU.T)[row].tolist(), strict=True))
    yield "/json_velocity", json.dumps({"velocity": moving}).encode()


def _described(kind: type[Message]) -> bytes:
    files: dict[str, Any] = {}

    def gather(file: Any) -> None:
        for needed in file.dependencies:
            gather(needed)
        files.setdefault(file.name, file)

    gather(kind.DESCRIPTOR.file)
    described = FileDescriptorSet()
    for file in files.values():
        file.CopyToProto(described.file.add())
    return described.SerializeToString()


def _xyz(numbers: Sequence[float] | Float[np.ndarray, "n"]) -> SimpleNamespace:
    return SimpleNamespace(**dict(zip("xyzw", [float(number) for number in numbers], strict=False)))
