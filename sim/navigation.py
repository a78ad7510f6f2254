"""What the vehicle believes: truth through a declared error model, in the place of a navigation filter.

The errors are those of a GPS-aided inertial system with magnetometer: position and velocity with white and
slowly wandering parts, a position bias that walks at random, attitude and heading that wander, noisy body
rates, and a delay of the whole estimate. Wandering errors are Gauss-Markov: a standard deviation and a
correlation time.
"""

from collections import deque
from dataclasses import dataclass
from math import cos, exp, radians, sin, sqrt

import numpy as np

from flight.se2 import SE2

from .motion import Motion

_BLOCK = 512


@dataclass(frozen=True, slots=True)
class Wander:
    """A Gauss-Markov error: standard deviation in the unit of what it spoils, correlation time in s."""

    sigma: float
    time: float


@dataclass(frozen=True, slots=True)
class NavigationErrors:
    """One-sigma errors of the estimate; SI.

    Attributes:
        position_noise: white, each axis, m.
        position_wander: each axis, m.
        position_walk: random walk of the position bias, each axis, m per root second.
        velocity_noise: white, each axis, m/s.
        velocity_wander: each axis, m/s.
        attitude_wander: roll and pitch, rad.
        heading_wander: rad.
        rate_noise: white, each body rate, rad/s.
        rate_wander: bias of each body rate, rad/s.
        delay_periods: age of the estimate in control periods.
    """

    position_noise: float
    position_wander: Wander
    position_walk: float
    velocity_noise: float
    velocity_wander: Wander
    attitude_wander: Wander
    heading_wander: Wander
    rate_noise: float
    rate_wander: Wander
    delay_periods: int


# A differential receiver, a tactical inertial unit and a magnetometer, after a filter; chosen, no data sheet
# of the GT-Max's could be read. What computing and passing on takes is the servos' transport delay.
GPS_AIDED = NavigationErrors(
    position_noise=0.01,
    position_wander=Wander(0.05, 60.0),
    position_walk=0.005,
    velocity_noise=0.01,
    velocity_wander=Wander(0.025, 5.0),
    attitude_wander=Wander(radians(0.2), 30.0),
    heading_wander=Wander(radians(1.0), 120.0),
    rate_noise=radians(0.2),
    rate_wander=Wander(radians(0.05), 300.0),
    delay_periods=0,
)
# What is believed is what is so, at once.
IDEAL = NavigationErrors(
    position_noise=0.0,
    position_wander=Wander(0.0, 1.0),
    position_walk=0.0,
    velocity_noise=0.0,
    velocity_wander=Wander(0.0, 1.0),
    attitude_wander=Wander(0.0, 1.0),
    heading_wander=Wander(0.0, 1.0),
    rate_noise=0.0,
    rate_wander=Wander(0.0, 1.0),
    delay_periods=0,
)


class Navigation:
    """Turns true motion into an estimate, period by period.

    Args:
        errors: their sizes.
        step: control period in s.
        rng: source of all its chance.
    """

    def __init__(self, errors: NavigationErrors, *, step: float, rng: np.random.Generator) -> None:
        self._rng = rng
        self._delayed: deque[Motion] = deque(maxlen=errors.delay_periods + 1)
        # One row a channel: north, east, down; their velocities; roll, pitch, heading; p, q, r.
        wanders = (
            *(errors.position_wander,) * 3,
            *(errors.velocity_wander,) * 3,
            *(errors.attitude_wander,) * 2,
            errors.heading_wander,
            *(errors.rate_wander,) * 3,
        )
        keep = np.array([exp(-step / wander.time) for wander in wanders])
        sigma = np.array([wander.sigma for wander in wanders])
        self._keep, self._drive = keep, sigma * np.sqrt(1.0 - keep**2)
        self._walk = errors.position_walk * sqrt(step)
        self._white = np.array(
            [errors.position_noise] * 3 + [errors.velocity_noise] * 3 + [0.0] * 3 + [errors.rate_noise] * 3
        )
        self._wandering = sigma * rng.standard_normal(12)
        self._bias = np.zeros(3)
        self._rows: list[list[float]] = []
        self._row = 0

    def move(self, displacement: SE2) -> None:
        """Follows a motion of the whole world: `pose_after = displacement @ pose_before`."""
        for place, seen in enumerate(self._delayed):
            pose = displacement @ seen.pose
            self._delayed[place] = seen._replace(north=pose.x, east=pose.y, heading=pose.heading)

    def step(self, truth: Motion) -> Motion:
        """Returns what is believed now."""
        self._delayed.append(truth)
        seen = self._delayed[0]
        n, e, d, vn, ve, vd, roll, pitch, heading, p, q, r = self._next_errors()
        believed_roll, believed_pitch = seen.roll + roll, seen.pitch + pitch
        body_p, body_q, body_r = seen.roll_rate + p, seen.pitch_rate + q, seen.body_yaw_rate + r
        # A wrong heading also turns the velocity out of its frame.
        c, s = cos(heading), sin(heading)
        forward, side = c * seen.forward + s * seen.side, c * seen.side - s * seen.forward
        believed_heading = seen.heading + heading
        ch, sh = cos(believed_heading), sin(believed_heading)
        return Motion(
            north=seen.north + n,
            east=seen.east + e,
            down=seen.down + d,
            forward=forward + ch * vn + sh * ve,
            side=side + ch * ve - sh * vn,
            descent=seen.descent + vd,
            roll=believed_roll,
            pitch=believed_pitch,
            heading=believed_heading,
            roll_rate=body_p,
            pitch_rate=body_q,
            body_yaw_rate=body_r,
            yaw_rate=(body_q * sin(believed_roll) + body_r * cos(believed_roll)) / cos(believed_pitch),
        )

    def _next_errors(self) -> list[float]:
        if self._row == len(self._rows):
            self._rows = self._draw_block().tolist()
            self._row = 0
        row: list[float] = self._rows[self._row]
        self._row += 1
        return row

    def _draw_block(self) -> np.ndarray:
        """Draws the errors of many periods at once; the same bytes as period by period."""
        driven = self._drive * self._rng.standard_normal((_BLOCK, 12))
        walked = self._walk * self._rng.standard_normal((_BLOCK, 3))
        errors = self._white * self._rng.standard_normal((_BLOCK, 12))
        for row in range(_BLOCK):
            self._wandering = self._keep * self._wandering + driven[row]
            self._bias += walked[row]
            errors[row] += self._wandering
            errors[row, :3] += self._bias
        return errors
