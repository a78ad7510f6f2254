"""Viewer channels: `foxglove` messages in z-up axes, made from topics.

World x east, y north, z up; vehicle x forward, y left, z up (`flightlog.viewers.z_up_frames`).
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.PosesInFrame_pb2 import PosesInFrame
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from google.protobuf.message import Message
from google.protobuf.timestamp_pb2 import Timestamp
from jaxtyping import Int, UInt8

from flight.errors import FlightError
from flightlog.events import Event, Level, flight_events
from flightlog.log import FlightLog
from flightlog.series import Series
from flightlog.topics import ESTIMATE, TRUTH

from .message_template import NANOSECONDS, SECONDS, fill_template
from .scene import scene_entities
from .shape import vehicle_shape
from .z_up_frames import ESTIMATED_VEHICLE, POSE, VEHICLE, WORLD, attitudes, positions

TRANSFORM_RATE, PATH_RATE = 25.0, 5.0
"""Transforms, and poses of the path, for each second of flight."""


@dataclass(frozen=True, slots=True)
class ViewerTopic:
    """Channel for viewers: name, `foxglove` message and meaning."""

    name: str
    message: type[Message]
    meaning: str


TRANSFORMS = ViewerTopic(
    "/viewer_z_up/transforms",
    FrameTransforms,
    f"true and estimated pose of the vehicle, {TRANSFORM_RATE:.0f} Hz",
)
PATH = ViewerTopic(
    "/viewer_z_up/path", PosesInFrame, f"all poses of the flight at {PATH_RATE:.0f} Hz, once, at its start"
)
SCENE = ViewerTopic(
    "/viewer_z_up/scene",
    SceneUpdate,
    "vehicle, goal and flown track, coloured by trim, at the start; each plan with its tube at its time",
)
EVENTS = ViewerTopic(
    "/events", Log, "primitives, replans, time-outs, faults, alarms, goal and end, one line each"
)

VIEWER_TOPICS = (TRANSFORMS, PATH, SCENE, EVENTS)


@dataclass(frozen=True, slots=True, eq=False)
class ViewerChannel:
    """Messages of one viewer topic in blocks of one size.

    Times are in nanoseconds, not decreasing.
    """

    topic: ViewerTopic
    blocks: tuple[tuple[Int[np.ndarray, "_"], UInt8[np.ndarray, "_ _"]], ...]

    @classmethod
    def of(cls, topic: ViewerTopic, times: Iterable[int], messages: Iterable[Message]) -> "ViewerChannel":
        """Returns a channel of messages of any sizes."""
        contents = (message.SerializeToString(deterministic=True) for message in messages)
        return cls(
            topic,
            tuple(
                (np.array([time]), np.frombuffer(content, np.uint8)[None, :])
                for time, content in zip(times, contents, strict=True)
            ),
        )


def viewer_channels(log: FlightLog) -> Iterator[ViewerChannel]:
    """Yields the channels that a log's topics allow.

    An invalid attachment becomes an event.
    """
    events = list(flight_events(log))
    if _has_pose(log):
        yield _transforms(log)
        yield _path(log.motion)
        try:
            yield _scene(log)
        except FlightError as error:
            events.insert(0, Event(0.0, Level.ERROR, "log", str(error)))
    if events:
        yield _events(events)


def _has_pose(log: FlightLog) -> bool:
    """Returns True if the log has position and attitude."""
    return (TRUTH.name in log.series or ESTIMATE.name in log.series) and log.motion.has_fields(*POSE)


def _transforms(log: FlightLog) -> ViewerChannel:
    bodies = {VEHICLE: log.motion}
    if TRUTH.name in log.series and ESTIMATE.name in log.series and log[ESTIMATE].has_fields(*POSE):
        bodies[ESTIMATED_VEHICLE] = log[ESTIMATE]
    time = log.motion.time
    rows = _decimated_rows(time, TRANSFORM_RATE)
    template = FrameTransforms()
    columns: dict[float, np.ndarray] = {}
    for number, (name, states) in enumerate(bodies.items()):
        marks = [1e300 * (1.0 + number + place / 16.0) for place in range(7)]
        template.transforms.append(_transform(name, marks))
        numbers = np.column_stack([positions(states), attitudes(states)])
        at = np.searchsorted(states.time, time[rows]).clip(max=len(states) - 1)
        columns |= dict(zip(marks, numbers[at].T, strict=True))
    times = _nanoseconds(time[rows])
    return ViewerChannel(TRANSFORMS, ((times, fill_template(template, times=times, columns=columns)),))


def _transform(child: str, numbers: list[float]) -> FrameTransform:
    x, y, z, qx, qy, qz, qw = numbers
    return FrameTransform(
        timestamp=Timestamp(seconds=SECONDS, nanos=NANOSECONDS),
        parent_frame_id=WORLD,
        child_frame_id=child,
        translation=Vector3(x=x, y=y, z=z),
        rotation=Quaternion(x=qx, y=qy, z=qz, w=qw),
    )


def _path(states: Series) -> ViewerChannel:
    rows = _decimated_rows(states.time, PATH_RATE)
    numbers = np.column_stack([positions(states), attitudes(states)])[rows].tolist()
    poses = [
        Pose(position=Vector3(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw))
        for x, y, z, qx, qy, qz, qw in numbers
    ]
    return ViewerChannel.of(PATH, [0], [PosesInFrame(timestamp=Timestamp(), frame_id=WORLD, poses=poses)])


def _scene(log: FlightLog) -> ViewerChannel:
    """Returns one update at the start and one for each plan."""
    updates: dict[int, list[SceneEntity]] = {0: [vehicle_shape(log)]}
    for time, entity in scene_entities(log):
        updates.setdefault(int(_nanoseconds(np.array([time]))[0]), []).append(entity)
    messages = []
    for time, entities in sorted(updates.items()):
        for entity in entities:
            entity.timestamp.FromNanoseconds(time)
        messages.append(SceneUpdate(entities=entities))
    return ViewerChannel.of(SCENE, sorted(updates), messages)


def _events(events: list[Event]) -> ViewerChannel:
    times, messages = _nanoseconds(np.array([event.time for event in events])).tolist(), []
    for time, event in zip(times, events, strict=True):
        message = Log(level=Log.Level.Value(event.level.name), message=event.text, name=event.source)
        message.timestamp.FromNanoseconds(time)
        messages.append(message)
    return ViewerChannel.of(EVENTS, times, messages)


def _decimated_rows(time: np.ndarray, rate: float) -> Int[np.ndarray, "m"]:
    """Returns rows at a steady rate, both ends included."""
    ticks = np.floor((time - time[0]) * rate + 1e-6)
    first = np.flatnonzero(np.diff(ticks, prepend=-1.0) > 0)
    return np.unique([*first, len(time) - 1])


def _nanoseconds(time: np.ndarray) -> Int[np.ndarray, "n"]:
    return np.rint(np.asarray(time, np.float64) * 1e9).astype(np.int64)
