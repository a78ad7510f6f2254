"""Planar rigid motion: poses, body velocities and the flow that joins them.

World axes are north (x) and east (y); the heading is clockwise from north seen from above, so a positive
yaw rate is a right turn. Body axes are forward and to the right.
"""

from dataclasses import dataclass
from math import cos, hypot, isfinite, pi, remainder, sin
from typing import Annotated, Self

from pydantic import Field

from .file_value import FileValue


def wrap_angle(angle: float) -> float:
    """Returns the angle in radians brought into [-pi, pi]."""
    return remainder(angle, 2 * pi)


def rotate(x: float, y: float, heading: float) -> tuple[float, float]:
    """Returns a body-frame vector in world axes, for a given heading."""
    c, s = cos(heading), sin(heading)
    return c * x - s * y, s * x + c * y


@dataclass(frozen=True, slots=True)
class Twist(FileValue):
    """Constant body velocity: m/s forward, m/s right, rad/s."""

    forward: Annotated[float, Field(description="metres per second")]
    side: Annotated[float, Field(description="metres per second, to the right")]
    yaw_rate: Annotated[float, Field(description="radians per second, right turns positive")]

    def __post_init__(self) -> None:
        """Refuses non-finite components."""
        if not (isfinite(self.forward) and isfinite(self.side) and isfinite(self.yaw_rate)):
            raise ValueError(f"components of a twist must be finite, got {self}")

    def scaled_error(self, error: "Twist", gamma: float) -> "Twist":
        """Returns this velocity plus gamma times the error (thesis, eq. 8a)."""
        return Twist(
            self.forward + gamma * error.forward,
            self.side + gamma * error.side,
            self.yaw_rate + gamma * error.yaw_rate,
        )

    @property
    def speed(self) -> float:
        """Horizontal speed in metres per second."""
        return hypot(self.forward, self.side)


@dataclass(frozen=True, slots=True)
class SE2(FileValue):
    """Planar pose or displacement: metres, metres, radians (not wrapped).

    `pose_world_b = pose_world_a @ displacement_a_b`.
    """

    x: float
    y: float
    heading: float

    def __post_init__(self) -> None:
        """Refuses non-finite components."""
        if not (isfinite(self.x) and isfinite(self.y) and isfinite(self.heading)):
            raise ValueError(f"components of a pose must be finite, got {self}")

    @classmethod
    def identity(cls) -> Self:
        """Returns the pose at the origin, heading north."""
        return cls(0.0, 0.0, 0.0)

    @classmethod
    def exp(cls, twist: Twist, duration: float) -> Self:
        """Returns the displacement after holding a velocity (thesis, eq. 17-18).

        Exact for every yaw rate: with sin(x) / x in place of (1 - cos x) / x nothing is lost near zero.

        Args:
            twist: the body velocity.
            duration: seconds; negative runs the flow backwards.
        """
        along, across = arc(twist.yaw_rate, duration)
        return cls(
            twist.forward * along - twist.side * across,
            twist.forward * across + twist.side * along,
            twist.yaw_rate * duration,
        )

    def __matmul__(self, other: "SE2") -> "SE2":
        """Composes: `self` first, then `other` in the frame that `self` leads to."""
        x, y = rotate(other.x, other.y, self.heading)
        return SE2(self.x + x, self.y + y, self.heading + other.heading)

    def inverse(self) -> "SE2":
        """Returns the pose that undoes this one."""
        x, y = rotate(-self.x, -self.y, -self.heading)
        return SE2(x, y, -self.heading)

    @property
    def position(self) -> tuple[float, float]:
        """North and east in metres."""
        return self.x, self.y

    def distance_to(self, point: tuple[float, float]) -> float:
        """Returns the distance in metres to a point (north, east)."""
        return hypot(point[0] - self.x, point[1] - self.y)


def arc(yaw_rate: float, duration: float) -> tuple[float, float]:
    """Returns the integrals of cos(r t) and sin(r t), in seconds."""
    half = 0.5 * yaw_rate * duration
    return duration * _sinc(2.0 * half), duration * sin(half) * _sinc(half)


def _sinc(angle: float) -> float:
    """Returns sin(x) / x, exact for every angle above 0."""
    return sin(angle) / angle if angle else 1.0
