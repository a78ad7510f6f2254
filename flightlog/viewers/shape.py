"""Vehicle shape for viewers: solids of the attached model or an arrow."""

from collections.abc import Iterable
from xml.etree import ElementTree

import numpy as np
from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from jaxtyping import Float

from flight.errors import BadFileError
from flightlog.attachment_names import MODEL_ATTACHMENT
from flightlog.log import FlightLog

from .mjcf_check import parse_model
from .z_up_frames import VEHICLE

Vector = Float[np.ndarray, "3"]

_GREY = "0.5 0.5 0.5 1"


def vehicle_shape(log: FlightLog) -> SceneEntity:
    """Returns the vehicle's shape in its own frame.

    Raises:
        BadFileError: the attached model is invalid.
    """
    entity = SceneEntity(frame_id=VEHICLE, id="vehicle", frame_locked=True)
    if MODEL_ATTACHMENT not in log.attachments:
        entity.arrows.add(
            pose=Pose(orientation=Quaternion(w=1.0)),
            shaft_length=1.2,
            shaft_diameter=0.25,
            head_length=0.6,
            head_diameter=0.6,
            color=Color(r=0.75, g=0.12, b=0.1, a=1.0),
        )
        return entity
    try:
        model = parse_model(log.attachments[MODEL_ATTACHMENT], MODEL_ATTACHMENT)
        colors = {part.get("name"): part.get("rgba", _GREY) for part in model.iter("material")}
        for body in model.iter("body"):
            for geom in body.iter("geom"):
                _add_solid(entity, geom, colors.get(geom.get("material"), _GREY))
    except ValueError as error:
        raise BadFileError(MODEL_ATTACHMENT, f"expected a drawable model: {error}") from None
    return entity


def _add_solid(entity: SceneEntity, geom: ElementTree.Element, rgba: str) -> None:
    """Adds one solid of the model; MuJoCo's sizes are halves."""
    size, color = _numbers(geom.get("size", "")), Color(**dict(zip("rgba", _numbers(rgba), strict=True)))
    place, turn = _numbers(geom.get("pos", "0 0 0")), _euler_quaternion(_numbers(geom.get("euler", "0 0 0")))
    if "fromto" in geom.attrib:
        ends = np.array(_numbers(geom.attrib["fromto"])).reshape(2, 3)
        place, turn = ends.mean(axis=0), _rotation_from_up(ends[1] - ends[0])
        size = [size[0], 0.5 * float(np.linalg.norm(ends[1] - ends[0]))]
    pose = Pose(position=_vector(place), orientation=turn)
    match geom.get("type"):
        case "ellipsoid":
            entity.spheres.add(pose=pose, size=_vector(2.0 * np.array(size)), color=color)
        case "box":
            entity.cubes.add(pose=pose, size=_vector(2.0 * np.array(size)), color=color)
        case "capsule" | "cylinder":
            radius, half = size
            span = _vector((2.0 * radius, 2.0 * radius, 2.0 * half))
            entity.cylinders.add(pose=pose, size=span, bottom_scale=1.0, top_scale=1.0, color=color)
        case kind:
            raise ValueError(f"expected ellipsoid, box, capsule or cylinder, got {kind}")


def _numbers(text: str) -> list[float]:
    return [float(word) for word in text.split()]


def _vector(values: Iterable[float]) -> Vector3:
    x, y, z = values
    return Vector3(x=x, y=y, z=z)


def _euler_quaternion(angles: list[float]) -> Quaternion:
    """Returns the rotation of MJCF `euler` angles, intrinsic x-y-z."""
    (sx, sy, sz), (cx, cy, cz) = np.sin(0.5 * np.array(angles)), np.cos(0.5 * np.array(angles))
    return Quaternion(
        x=sx * cy * cz + cx * sy * sz,
        y=cx * sy * cz - sx * cy * sz,
        z=cx * cy * sz + sx * sy * cz,
        w=cx * cy * cz - sx * sy * sz,
    )


def _rotation_from_up(direction: Vector) -> Quaternion:
    """Returns the shortest rotation from up to a direction."""
    x, y, z = direction / np.linalg.norm(direction)
    if z < -0.999999:
        return Quaternion(x=1.0)
    w = np.sqrt(0.5 * (1.0 + z))
    return Quaternion(x=-y / (2.0 * w), y=x / (2.0 * w), z=0.0, w=w)
