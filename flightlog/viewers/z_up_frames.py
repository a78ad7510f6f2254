"""Frames of viewers: east-north-up world, forward-left-up vehicle."""

import numpy as np
from jaxtyping import Float

from flightlog.series import Series

WORLD = "world_east_north_up"
VEHICLE = "vehicle_forward_left_up"
ESTIMATED_VEHICLE = "believed_vehicle_forward_left_up"

POSE = ("north", "east", "down", "roll", "pitch", "heading")
"""Fields of a state that a pose needs."""


def positions(states: Series) -> Float[np.ndarray, "n 3"]:
    """Returns positions in the viewers' world, metres."""
    return np.column_stack([states["east"], states["north"], -states["down"]])


def attitudes(states: Series) -> Float[np.ndarray, "n 4"]:
    """Returns viewer attitudes as unit quaternions x, y, z, w.

    Vehicle to world. Yaw about up is pi/2 - heading, pitch about left is -pitch, roll about forward is roll;
    intrinsic z, y, x.
    """
    yaw, pitch, roll = 0.5 * (np.pi / 2.0 - states["heading"]), -0.5 * states["pitch"], 0.5 * states["roll"]
    cy, sy, cp, sp, cr, sr = (f(a) for a in (yaw, pitch, roll) for f in (np.cos, np.sin))
    return np.column_stack(
        [
            cy * cp * sr - sy * sp * cr,
            cy * sp * cr + sy * cp * sr,
            sy * cp * cr - cy * sp * sr,
            cy * cp * cr + sy * sp * sr,
        ]
    )
