"""Flies RotorPy's quadrotor with RotorPy's own controller.

Run by `python benchmarks/flight/rotorpy_flight.py flight.csv 1 180`.

Arguments: file, seed, seconds. RotorPy is no dependency of this program: run it where `rotorpy` is installed.
The flight is a random walk among eight velocities; the file holds poses every 25 ms, as from a motion capture
system: time, north, east, heading, without commands or velocities.
"""

import sys
from pathlib import Path

import numpy as np
from jaxtyping import Float
from rotorpy.controllers.quadrotor_control import SE3Control
from rotorpy.vehicles.hummingbird_params import quad_params
from rotorpy.vehicles.multirotor import Multirotor
from rotorpy.wind.default_winds import SinusoidWind
from scipy.spatial.transform import Rotation

# Forward and side velocity in m/s, yaw rate in rad/s; then the successors of each.
TRIMS = (
    *((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    *((0.0, -1.0, 0.0), (1.0, 0.0, 0.5), (1.0, 0.0, -0.5), (0.0, 0.0, 0.8)),
)
NEXT = {0: (1, 3, 4, 7), 1: (0, 2, 5, 6), 2: (1,), 3: (0,), 4: (0,), 5: (1, 6), 6: (1, 5), 7: (0,)}
BLEND = 1.2
STEP = 0.005
STEPS_A_SAMPLE = 5


def reference(seed: int, seconds: float) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    """Returns held references joined by quintics, and their rates."""
    rng = np.random.default_rng(seed)
    count = round(seconds / STEP)
    velocity, rate = np.zeros((count, 3)), np.zeros((count, 3))
    trim, begin = 0, 0
    while begin < count:
        end = begin + round(rng.uniform(4, 8) / STEP)
        velocity[begin:end] = TRIMS[trim]
        if begin:
            share = np.arange(min(end, count) - begin) * STEP / BLEND
            share, before = share[share < 1, None], velocity[begin - 1]
            piece = slice(begin, begin + len(share))
            size = np.array(TRIMS[trim]) - before
            velocity[piece] = before + size * share**3 * (10 - 15 * share + 6 * share**2)
            rate[piece] = size * 30 * share**2 * (1 - share) ** 2 / BLEND
        trim, begin = int(rng.choice(NEXT[trim])), end
    return velocity, rate


def fly(seed: int, seconds: float) -> Float[np.ndarray, "n 4"]:
    """Returns time, north, east and heading of a flight in gusts."""
    velocity, rate = reference(seed, seconds)
    vehicle, controller = Multirotor(quad_params), SE3Control(quad_params)
    wind = SinusoidWind(np.array([0.8, 0.6, 0.1]), np.array([0.23, 0.17, 0.4]), np.array([0.0, 1.0, 2.0]))
    state = vehicle.initial_state | {"x": np.zeros(3), "v": np.zeros(3), "q": np.array([0.0, 0, 0, 1])}
    position, yaw, rows = np.zeros(3), 0.0, []
    for place, ((forward, side, yaw_rate), (faster, aside, _)) in enumerate(zip(velocity, rate, strict=True)):
        # RotorPy's world is x forward, y left, z up; its yaw is counter-clockwise.
        turn = Rotation.from_euler("z", yaw)
        speed = turn.apply([forward, -side, 0.0])
        push = turn.apply([faster, -aside, 0.0]) + np.cross([0, 0, -yaw_rate], speed)
        flat = {"x": position, "x_dot": speed, "x_ddot": push, "yaw": yaw, "yaw_dot": -yaw_rate}
        flat |= {name: np.zeros(3) for name in ("x_dddot", "x_ddddot")} | {"yaw_ddot": 0.0}
        if place % STEPS_A_SAMPLE == 0:
            north, west, _ = state["x"]
            heading = -Rotation.from_quat(state["q"]).as_euler("ZYX")[0]
            rows.append((place * STEP, north, -west, heading))
        state["wind"] = wind.update(place * STEP, state["x"])
        state = vehicle.step(state, controller.update(place * STEP, state, flat), STEP)
        position, yaw = position + speed * STEP, yaw - yaw_rate * STEP
    flown = np.array(rows)
    flown[:, 3] = np.unwrap(flown[:, 3])
    return flown


if __name__ == "__main__":
    path, seed, seconds = Path(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])
    flown = fly(seed, seconds)
    np.savetxt(path, flown, fmt="%.5f", delimiter=",", header="time,north,east,heading", comments="")
