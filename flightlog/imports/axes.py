"""Conversion of other programs' axes to north-east-down and forward-right-down."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

WorldAxes = Literal["ned", "enu"]
"""North, east, down; or east, north, up, the convention of ROS (REP 103)."""

BodyAxes = Literal["frd", "flu"]
"""Forward, right, down; or forward, left, up, the convention of ROS (REP 103)."""

Vectors = Float[np.ndarray, "n 3"]
Quaternions = Float[np.ndarray, "n 4"]

_HALF = np.sqrt(0.5)
# Half turns, as quaternions w, x, y, z: about north-east, and about forward.
_ENU_TO_NED = (0.0, _HALF, _HALF, 0.0)
_FRD_TO_FLU = (0.0, 1.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Axes:
    """World and body axes of another program's data."""

    world: WorldAxes
    body: BodyAxes

    def in_world(self, vectors: Vectors) -> Vectors:
        """Returns world-axis vectors in north, east, down."""
        return vectors if self.world == "ned" else vectors[:, [1, 0, 2]] * (1.0, 1.0, -1.0)

    def in_body(self, vectors: Vectors) -> Vectors:
        """Returns body-axis vectors in forward, right, down."""
        return vectors if self.body == "frd" else vectors * (1.0, -1.0, -1.0)

    def in_ned_frd(self, quaternions: Quaternions) -> Quaternions:
        """Returns body-to-world quaternions w, x, y, z in our axes."""
        if self.body == "flu":
            quaternions = _product(quaternions, np.array([_FRD_TO_FLU]))
        if self.world == "enu":
            quaternions = _product(np.array([_ENU_TO_NED]), quaternions)
        return quaternions


def quaternions_from_euler(
    roll: Float[np.ndarray, "n"], pitch: Float[np.ndarray, "n"], yaw: Float[np.ndarray, "n"]
) -> Quaternions:
    """Returns quaternions w, x, y, z of intrinsic z-y-x rotations."""
    zeros = np.zeros_like(roll)
    about_z = np.column_stack([np.cos(yaw / 2), zeros, zeros, np.sin(yaw / 2)])
    about_y = np.column_stack([np.cos(pitch / 2), zeros, np.sin(pitch / 2), zeros])
    about_x = np.column_stack([np.cos(roll / 2), np.sin(roll / 2), zeros, zeros])
    return _product(_product(about_z, about_y), about_x)


def _product(left: Float[np.ndarray, "#n 4"], right: Float[np.ndarray, "#n 4"]) -> Quaternions:
    a, b, c, d = left.T
    w, x, y, z = right.T
    return np.column_stack(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ]
    )
