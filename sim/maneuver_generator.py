"""The maneuver generator: it turns a change of trim into a smooth command of velocity and yaw rate.

A second-order reference model for each channel, stepped exactly. The thesis finds that the vehicle "behaves
like a second order linear dynamic system, whose settling time is ideally constant" (2.6.2), and its Table 10
says which constant: changes of speed last 4 s, turns 3 s, both together 4 s. So the yaw rate takes the
velocity's time where speed and yaw rate change together; only so do the heading changes of those rows come
out. There is no memory of position or heading.
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


# With these, displacement and heading change of every maneuver of Table 10 come out where it ends at the
# printed duration: a channel covers 2 damping / frequency times its change less than target times duration.
VELOCITY_RESPONSE = SecondOrder(frequency=0.78, damping=0.76)
YAW_RATE_RESPONSE = SecondOrder(frequency=1.06, damping=0.76)


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


class _Steps:
    """How a response moves on by one step, exactly, while its target is held."""

    def __init__(self, response: SecondOrder, *, step: float) -> None:
        frequency, damping = response.frequency, response.damping
        decay = damping * frequency
        swing = frequency * sqrt(1.0 - damping**2)
        c, s, e = cos(swing * step), sin(swing * step), exp(-decay * step)
        self._offset_from = (e * (c + decay / swing * s), e * s / swing)
        self._rate_from = (-e * frequency**2 / swing * s, e * (c - decay / swing * s))
        self._stiffness, self._friction = frequency**2, 2.0 * decay

    def after(self, before: Channel, target: float) -> Channel:
        """Returns the channel one step later."""
        offset = before.value - target
        a, b = self._offset_from
        c, d = self._rate_from
        value, rate = target + a * offset + b * before.rate, c * offset + d * before.rate
        return Channel(value, rate, self._stiffness * (target - value) - self._friction * rate)


class ManeuverGenerator:
    """Generates the reference from the trim asked for.

    Args:
        velocity: trim velocity held at the start.
        step: control period in s.
    """

    def __init__(self, velocity: Twist, *, step: float) -> None:
        self._speeding, self._turning = (
            _Steps(response, step=step) for response in (VELOCITY_RESPONSE, YAW_RATE_RESPONSE)
        )
        self._target, self._yawing = velocity, self._turning
        self._reference = Reference(
            *(Channel(value, 0.0, 0.0) for value in (velocity.forward, velocity.side, velocity.yaw_rate))
        )

    def step(self, target: Twist) -> Reference:
        """Moves on by one control period towards a target velocity."""
        if target != self._target:
            speed_changes = (target.forward, target.side) != (self._target.forward, self._target.side)
            self._yawing = self._speeding if speed_changes else self._turning
            self._target = target
        forward, side, yaw_rate = self._reference
        self._reference = Reference(
            self._speeding.after(forward, target.forward),
            self._speeding.after(side, target.side),
            self._yawing.after(yaw_rate, target.yaw_rate),
        )
        return self._reference
