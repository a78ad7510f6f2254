"""Scene for viewers: goal, flown track, planned track and tube."""

from collections.abc import Iterable, Iterator
from itertools import pairwise

import numpy as np
from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.CylinderPrimitive_pb2 import CylinderPrimitive
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from foxglove_schemas_protobuf.Point3_pb2 import Point3
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.TriangleListPrimitive_pb2 import TriangleListPrimitive
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from jaxtyping import Float

from flight.automaton.library import Library
from flight.plan.plan import Plan
from flight.plan.planned_track import POINTS, planned_track, planned_tube
from flight.se2 import SE2
from flightlog.attachment_names import LIBRARY_ATTACHMENT
from flightlog.log import FlightLog
from flightlog.mission_attachments import LoggedPlan, logged_goal, logged_plans
from flightlog.primitives import PrimitiveKind, merged_primitives
from flightlog.topics import ESTIMATE, PRIMITIVE
from flightlog.trim_labels import trim_palette

from .z_up_frames import WORLD, positions

Points = Float[np.ndarray, "n 3"]

SCENE_RATE = 10.0
"""Points of the flown track for each second."""

_GREEN, _GREY, _INK = "#009E73", "#8a8a8a", "#222222"
_GOAL_POST = 0.1
_NO_TURN = Pose(orientation=Quaternion(w=1.0))
# A nominal plan is drawn with the tube of all the library's errors.
_TUBE_OF_NOMINAL = 1.0


def scene_entities(log: FlightLog) -> Iterator[tuple[float, SceneEntity]]:
    """Yields entities and their start times; equal ids replace earlier ones.

    Raises:
        FlightError: an attachment is invalid.
    """
    yield 0.0, _flown_track(log)
    goal = logged_goal(log)
    height = float(-log.motion["down"][0])
    if goal is not None:
        yield 0.0, _goal_disc(goal.position, goal.tolerance, height)
    if LIBRARY_ATTACHMENT in log.attachments and ESTIMATE.name in log.series:
        library = log.library()
        for planning in logged_plans(log):
            yield planning.time, _planned_track(log, library, planning)


def estimated_pose(log: FlightLog, time: float) -> SE2:
    """Returns the estimated pose, interpolated linearly.

    Raises:
        MissingTopicError: the log has no estimate.
    """
    estimate = log[ESTIMATE]
    x, y, heading = (
        float(np.interp(time, estimate.time, estimate[name])) for name in ("north", "east", "heading")
    )
    return SE2(x, y, heading)


def tube_gamma(plan: Plan) -> float:
    """Returns the gamma of a plan's tube; 1 for a nominal plan."""
    return plan.gamma or _TUBE_OF_NOMINAL


def color(hexadecimal: str, opacity: float = 1.0) -> Color:
    """Returns the colour of a #rrggbb string."""
    r, g, b = (int(hexadecimal[place : place + 2], 16) / 255.0 for place in (1, 3, 5))
    return Color(r=r, g=g, b=b, a=opacity)


def _flown_track(log: FlightLog) -> SceneEntity:
    """Draws the flown track, one line for each primitive."""
    entity = SceneEntity(frame_id=WORLD, id="flown")
    motion = log.motion
    places = positions(motion)
    if PRIMITIVE.name not in log.series:
        entity.lines.append(_line(_decimate_points(motion.time, places), color(_INK), 0.12))
        return entity
    flown = merged_primitives(log)
    colors = trim_palette(log)
    for part in flown:
        inside = (motion.time >= part.start) & (motion.time <= part.end)
        if inside.sum() < 2:
            continue
        shade = colors[part.id] if part.kind is PrimitiveKind.COAST else _INK
        entity.lines.append(_line(_decimate_points(motion.time[inside], places[inside]), color(shade), 0.12))
    return entity


def _goal_disc(position: tuple[float, float], tolerance: float, height: float) -> SceneEntity:
    """Draws the goal's tolerance disc at flight height, on a post."""
    north, east = position
    entity = SceneEntity(frame_id=WORLD, id="goal")
    for diameter, length, middle, opacity in (
        (2.0 * tolerance, 0.02, height, 0.35),
        (_GOAL_POST, height, 0.5 * height, 1.0),
    ):
        pose = Pose(position=Vector3(x=east, y=north, z=middle), orientation=Quaternion(w=1.0))
        entity.cylinders.append(
            CylinderPrimitive(
                pose=pose,
                size=Vector3(x=diameter, y=diameter, z=length),
                bottom_scale=1.0,
                top_scale=1.0,
                color=color(_GREEN, opacity),
            )
        )
    return entity


def _planned_track(log: FlightLog, library: Library, planning: LoggedPlan) -> SceneEntity:
    """Draws a plan from the estimated pose at its time."""
    entity = SceneEntity(frame_id=WORLD, id="plan")
    plan, start = planning.plan, estimated_pose(log, planning.time)
    height = float(-np.interp(planning.time, log[ESTIMATE].time, log[ESTIMATE]["down"]))
    walk = (library, plan.sequence, plan.coasting_times)
    coasts, maneuvers = planned_track(*walk, start=start, gamma=plan.deciding.gamma)
    for line in (*coasts, *maneuvers):
        entity.lines.append(_line(_points_at_height(line, height), color(_GREY), 0.06))
    tube = planned_tube(*walk, start=start, level=tube_gamma(plan))[:, :: POINTS // 10]
    entity.triangles.append(
        TriangleListPrimitive(
            pose=_NO_TURN,
            points=_points(_points_at_height(_tube_triangles(tube), height - 0.05)),
            color=color(_GREY, 0.18),
        )
    )
    return entity


def _tube_triangles(tube: Float[np.ndarray, "gammas n 2"]) -> Float[np.ndarray, "m 2"]:
    """Returns the corners of triangles between neighbouring lines."""
    triangles = []
    for one, other in pairwise(tube):
        a, b, c, d = one[:-1], one[1:], other[:-1], other[1:]
        triangles.append(np.stack([a, b, c, b, d, c], axis=1).reshape(-1, 2))
    return np.concatenate(triangles)


def _points_at_height(line: Float[np.ndarray, "n 2"], height: float) -> Points:
    """Returns north-east points in viewer axes at a height."""
    return np.column_stack([line[:, 1], line[:, 0], np.full(len(line), height)])


def _decimate_points(time: Float[np.ndarray, "n"], points: Points) -> Float[np.ndarray, "kept 3"]:
    """Returns about `SCENE_RATE` points a second, both ends included."""
    step = max(1, round((len(time) - 1) / max((time[-1] - time[0]) * SCENE_RATE, 1.0)))
    rows = np.unique([*range(0, len(time), step), len(time) - 1])
    return np.asarray(points[rows])


def _line(points: Points, shade: Color, thickness: float) -> LinePrimitive:
    return LinePrimitive(
        type=LinePrimitive.LINE_STRIP,
        pose=_NO_TURN,
        thickness=thickness,
        points=_points(points),
        color=shade,
    )


def _points(points: Points) -> Iterable[Point3]:
    return [Point3(x=x, y=y, z=z) for x, y, z in points.tolist()]
