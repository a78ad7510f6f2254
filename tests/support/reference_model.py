"""Closed form of the maneuver generator's reference model, and its track."""

import numpy as np
from jaxtyping import Float

from flight.se2 import SE2, Twist

STEP = 0.02
"""Seconds between samples."""

# The maneuver generator's reference model: natural frequencies in rad/s for speeds and yaw rate, damping.
NATURAL_FREQUENCIES = (0.8, 0.8, 1.07)
DAMPING = 0.8


def at_rest(velocity: Twist) -> Float[np.ndarray, "2 3"]:
    """Returns velocity and acceleration in a settled trim."""
    return np.array([[velocity.forward, velocity.side, velocity.yaw_rate], [0.0, 0.0, 0.0]])


def reference_response(
    state: Float[np.ndarray, "2 3"], target: Twist, ticks: int
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "2 3"]]:
    """Returns velocities over some ticks and the state after them.

    Exact for a constant target.
    """
    time = np.arange(ticks + 1)[:, None] * STEP
    frequency = np.array(NATURAL_FREQUENCIES)
    damped = frequency * np.sqrt(1 - DAMPING**2)
    decay = np.exp(-DAMPING * frequency * time)
    cosine, sine = np.cos(damped * time), np.sin(damped * time) / damped
    aim = at_rest(target)
    offset, rate = state - aim
    velocity = aim[0] + decay * (offset * cosine + (rate + DAMPING * frequency * offset) * sine)
    acceleration = decay * (rate * cosine - (DAMPING * frequency * rate + frequency**2 * offset) * sine)
    return velocity[:-1], np.stack([velocity[-1], acceleration[-1]])


def integrate(velocity: Float[np.ndarray, "n 3"], start: SE2) -> Float[np.ndarray, "n 3"]:
    """Returns poses by the exact flow of each velocity (eq. 17-18)."""
    poses = [start]
    for forward, side, yaw_rate in velocity[:-1].tolist():
        poses.append(poses[-1] @ SE2.exp(Twist(forward, side, yaw_rate), STEP))
    return np.array([(pose.x, pose.y, pose.heading) for pose in poses])
