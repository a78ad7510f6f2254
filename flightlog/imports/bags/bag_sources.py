"""Measured sources of the topics of a bag."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from flight.errors import FlightError
from flightlog.imports.measured_motion import Source, attitude_source, differentiate_position
from flightlog.imports.motion.derived_fields import BODY_RATES, WORLD_RATES
from flightlog.imports.motion.frames import Frames, VelocityAxes, velocity_source
from flightlog.imports.motion.geodetic import local_plane
from flightlog.imports.motion.local_position import local_position_sources

from .topic_columns import COUNTERS, LOCAL_POSITION, TopicColumns

SLOPE = "the slope of the position"
"""Origin of the velocities of a log that holds none."""

_IN_BODY = "Odometry"
# Of px4_msgs/VehicleOdometry, in old and new versions.
_BODY_FRD = 3.0

Column = Float[np.ndarray, "n"]


@dataclass(frozen=True, slots=True, eq=False)
class AlignedTopic:
    """Messages of a topic in order of their times, in seconds."""

    table: TopicColumns
    rows: Int[np.ndarray, "k"]
    time: Float[np.ndarray, "k"]

    @property
    def has_listed_quaternion(self) -> bool:
        """True if attitudes are lists of four numbers."""
        path = self.table.paths.get("attitude")
        return path is not None and path.listed

    def vectors(self, name: str) -> Float[np.ndarray, "k m"] | None:
        """Returns a vector of the messages; None if they have none."""
        found = self.table.vectors(name)
        return None if found is None else found[self.rows]

    def scalar(self, name: str) -> Column | None:
        """Returns a number of the messages; None if they have none."""
        found = self.table.scalar(name)
        return None if found is None else found[self.rows]

    def counters(self) -> list[tuple[str, Column]]:
        """Returns the reset counters of an estimator by what they count."""
        names = {name: name.removesuffix("_reset_counter") for name in COUNTERS} | {"reset_counter": "state"}
        found = ((word, self.scalar(name)) for name, word in names.items())
        return [(word, counter) for word, counter in found if counter is not None]


def default_frames(pose: AlignedTopic, moving: AlignedTopic) -> Frames:
    """Returns the axes that messages state, or usual ones."""
    if pose.table.px4:
        stated = moving.scalar("velocity_frame")
        body = stated is not None and bool((stated == _BODY_FRD).all())
        return Frames("ned", "frd", "body" if body else "world", "wxyz")
    return Frames("enu", "flu", _velocity_axes(pose.table, moving.table), "wxyz")


def bag_sources(
    pose: AlignedTopic, moving: AlignedTopic, frames: Frames
) -> tuple[list[Source], dict[str, str]]:
    """Returns the measured sources, and remarks on where they come from.

    Raises:
        FlightError: there is neither a position nor an orientation.
    """
    if pose.scalar("vx") is not None and pose.scalar("x") is not None:
        fields = {name: column for name in LOCAL_POSITION if (column := pose.scalar(name)) is not None}
        return local_position_sources(pose.time, fields), {
            "velocity": f"{pose.table.topic}, along the axes of the world"
        }
    sources, said = _pose_sources(pose, frames)
    if not sources:
        raise FlightError(
            f"{pose.table.topic} ({pose.table.schema}): expected a position or orientation, got none"
        )
    velocities = _velocity_sources(moving, frames)
    if any({"velocity_north", "body_forward"} & set(part.columns) for part in velocities):
        said["velocity"] = f"{moving.table.topic}, along the axes of the {frames.velocity_in}"
    elif moving is pose:
        said["velocity"] = "absent"
        if "north" in sources[0].columns:
            velocities.append(differentiate_position(sources[0]))
            said["velocity"] = SLOPE
    return [*sources, *velocities], said


def _velocity_axes(pose: TopicColumns, moving: TopicColumns) -> VelocityAxes:
    """Returns the axes of a velocity, by schema and frame."""
    if moving.schema.endswith(_IN_BODY):
        return "world" if moving.frame and set(moving.children) == {moving.frame} else "body"
    return "world" if moving.frame == pose.frame else "body"


def _pose_sources(topic: AlignedTopic, frames: Frames) -> tuple[list[Source], dict[str, str]]:
    sources, said = [], {}
    place, attitude = topic.vectors("position"), topic.vectors("attitude")
    latitude, longitude = topic.scalar("latitude"), topic.scalar("longitude")
    if place is not None:
        north, east, down = frames.axes.in_world(place).T
        sources.append(Source(topic.time, {"north": north, "east": east, "down": down}))
    elif latitude is not None and longitude is not None:
        source, said["place"] = local_plane(topic.time, latitude, longitude, topic.scalar("altitude"))
        sources.append(source)
    if attitude is not None:
        sources.append(attitude_source(topic.time, frames.quaternions(attitude)))
    return sources, said


def _velocity_sources(topic: AlignedTopic, frames: Frames) -> list[Source]:
    sources = []
    linear, angular = topic.vectors("linear"), topic.vectors("angular")
    if linear is not None:
        sources.append(velocity_source(topic.time, linear, frames))
    if angular is not None:
        # Both parts of a twist share their axes; a field `angular_velocity` is in body axes.
        in_world = topic.table.paths["angular"].path[-1] == "angular" and frames.velocity_in == "world"
        about = frames.axes.in_world(angular) if in_world else frames.axes.in_body(angular)
        names = WORLD_RATES if in_world else BODY_RATES
        sources.append(Source(topic.time, dict(zip(names, about.T, strict=True))))
    return sources
