"""The maneuver generator: it turns a change of trim into a smooth command of velocity and yaw rate.

A second-order reference model for each channel, stepped exactly. The thesis finds that the vehicle "behaves
like a second order linear dynamic system, whose settling time is ideally constant" (2.6.2); the figures agree
with the durations and displacements of its Table 10. There is no memory of position or heading.
"""

from dataclasses import dataclass
from math import cos, exp, sin, sqrt
from typing import NamedTuple

from flight.se2 import Twist


@dataclass(frozen=True, slots=True)
class SecondOrder:
    """A second-order response: natural frequency in rad/s and damping ratio below 1."""

    frequency: float
    damping: float

    def __post_init__(self) -> None:
        """Refuses what does not swing."""
        if not (self.frequency > 0.0 and 0.0 < self.damping < 1.0):
            raise ValueError(f"frequency must be > 0 rad/s and damping in (0, 1), got {self}")


# 5 % settling after 4.2 s and 3.2 s, as Table 10 of the thesis implies (4 s for speeds, 3 s for turns).
VELOCITY_RESPONSE = SecondOrder(frequency=0.8, damping=0.8)
YAW_RATE_RESPONSE = SecondOrder(frequency=1.07, damping=0.8)


class Channel(NamedTuple):
    """A command with its first and second derivative."""

    value: float
    rate: float
    acceleration: float


class Reference(NamedTuple):
    """What the controller follows, in the heading frame: m/s (and derivatives), rad/s (and derivatives)."""

    forward: Channel
    side: Channel
    yaw_rate: Channel


class _Model:
    """One channel's reference model; exact for a target held through the step."""

    def __init__(self, response: SecondOrder, *, value: float, step: float) -> None:
        frequency, damping = response.frequency, response.damping
        decay = damping * frequency
        swing = frequency * sqrt(1.0 - damping**2)
        c, s, e = cos(swing * step), sin(swing * step), exp(-decay * step)
        self._offset_from = (e * (c + decay / swing * s), e * s / swing)
        self._rate_from = (-e * frequency**2 / swing * s, e * (c - decay / swing * s))
        self._stiffness, self._friction = frequency**2, 2.0 * decay
        self._value, self._rate = value, 0.0

    def step(self, target: float) -> Channel:
        offset = self._value - target
        a, b = self._offset_from
        c, d = self._rate_from
        self._value = target + a * offset + b * self._rate
        self._rate = c * offset + d * self._rate
        acceleration = self._stiffness * (target - self._value) - self._friction * self._rate
        return Channel(self._value, self._rate, acceleration)


class ManeuverGenerator:
    """Generates the reference from the trim asked for.

    Args:
        velocity: trim velocity held at the start.
        step: control period in s.
    """

    def __init__(self, velocity: Twist, *, step: float) -> None:
        self._forward = _Model(VELOCITY_RESPONSE, value=velocity.forward, step=step)
        self._side = _Model(VELOCITY_RESPONSE, value=velocity.side, step=step)
        self._yaw_rate = _Model(YAW_RATE_RESPONSE, value=velocity.yaw_rate, step=step)

    def step(self, target: Twist) -> Reference:
        """Moves on by one control period towards a target velocity."""
        return Reference(
            self._forward.step(target.forward),
            self._side.step(target.side),
            self._yaw_rate.step(target.yaw_rate),
        )
