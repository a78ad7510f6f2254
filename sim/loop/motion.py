"""Motion, reference, controls and wind of the vehicle."""

from typing import NamedTuple

import casadi as ca

from flight.se2 import SE2, Twist


class Estimate(NamedTuple):
    """Estimated motion as symbols, fields as in `Motion`."""

    north: ca.SX
    east: ca.SX
    down: ca.SX
    forward: ca.SX
    side: ca.SX
    descent: ca.SX
    roll: ca.SX
    pitch: ca.SX
    heading: ca.SX
    roll_rate: ca.SX
    pitch_rate: ca.SX
    body_yaw_rate: ca.SX
    yaw_rate: ca.SX


class Motion(NamedTuple):
    """Motion of the vehicle at one instant.

    World north-east-down, angles clockwise seen along the axis. A tuple for speed: one is made at every
    control step.

    Attributes:
        north: m.
        east: m.
        down: m; the ground is at 0.
        forward: horizontal velocity along the heading, m/s.
        side: horizontal velocity to the right of the heading, m/s.
        descent: downward velocity, m/s.
        roll: rad.
        pitch: rad.
        heading: rad clockwise from north, not wrapped.
        roll_rate: body rate p, rad/s.
        pitch_rate: body rate q, rad/s.
        body_yaw_rate: body rate r, rad/s.
        yaw_rate: rate of the heading, rad/s.
    """

    north: float
    east: float
    down: float
    forward: float
    side: float
    descent: float
    roll: float
    pitch: float
    heading: float
    roll_rate: float
    pitch_rate: float
    body_yaw_rate: float
    yaw_rate: float

    @property
    def pose(self) -> SE2:
        """Planar pose in the world."""
        return SE2(self.north, self.east, self.heading)

    @property
    def velocity(self) -> Twist:
        """Velocity in the heading frame and yaw rate."""
        return Twist(self.forward, self.side, self.yaw_rate)


class ReferenceChannel(NamedTuple):
    """Reference value with its first and second derivative."""

    value: float
    rate: float
    acceleration: float


class Reference(NamedTuple):
    """Reference of the controller in the heading frame, SI units."""

    forward: ReferenceChannel
    side: ReferenceChannel
    yaw_rate: ReferenceChannel


class Controls(NamedTuple):
    """Servo commands in rad of blade pitch.

    Positive rolls right, pitches up, climbs, turns right.
    """

    lateral: float
    longitudinal: float
    collective: float
    pedal: float


class Wind(NamedTuple):
    """Motion of the air at the vehicle in world axes.

    Velocities in m/s, gust rates in rad/s.
    """

    north: float
    east: float
    down: float
    rate_north: float
    rate_east: float
    rate_down: float


STILL_AIR = Wind(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
