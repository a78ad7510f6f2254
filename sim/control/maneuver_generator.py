"""Maneuver generator: smooth velocity and yaw-rate commands between trims.

A second-order reference model for each channel, stepped exactly. The thesis finds that the vehicle "behaves
like a second order linear dynamic system, whose settling time is ideally constant" (2.6.2). By its Table 10
changes of speed take 4 s, turns 3 s, both together 4 s. The yaw rate therefore settles with the velocity if
both change; only this reproduces the heading changes of those rows. Position and heading are not tracked.
"""

from dataclasses import dataclass
from functools import cache
from math import cos, exp, sin, sqrt

import casadi as ca
import numpy as np

from flight.se2 import Twist
from sim.loop.backend import Backend
from sim.loop.bound_function import Recursion
from sim.loop.motion import Reference, ReferenceChannel
from sim.loop.signals import Signals


@dataclass(frozen=True, slots=True)
class SecondOrderResponse:
    """Second-order response: frequency in rad/s and damping ratio."""

    frequency: float
    damping: float

    def __post_init__(self) -> None:
        """Refuses overdamped responses."""
        if not (self.frequency > 0.0 and 0.0 < self.damping < 1.0):
            raise ValueError(f"frequency must be > 0 rad/s and damping in (0, 1), got {self}")


# Chosen so that displacements and heading changes match Table 10 at the printed durations: a channel covers
# 2 damping / frequency times its change less than target times duration.
VELOCITY_RESPONSE = SecondOrderResponse(frequency=0.78, damping=0.76)
YAW_RATE_RESPONSE = SecondOrderResponse(frequency=1.06, damping=0.76)
_CHANNEL = len(ReferenceChannel._fields)


class ManeuverGenerator:
    """Generator of the reference from the commanded trim.

    Args:
        velocity: trim velocity at the start.
        step: control period, s.
        signals: output of the reference; its own if None.
        backend: numeric back-end.
    """

    def __init__(
        self,
        velocity: Twist,
        *,
        step: float,
        signals: Signals | None = None,
        backend: Backend = Backend.INTERPRETED,
    ) -> None:
        self.signals = signals = signals or Signals()
        self._target = velocity
        # Forward, side, yaw rate, and whether the yaw rate settles with the velocity.
        self._command = np.array([velocity.forward, velocity.side, velocity.yaw_rate, 0.0])
        signals.reference[:] = 0.0
        signals.reference[::_CHANNEL] = self._command[:3]
        models = _reference_models(VELOCITY_RESPONSE, YAW_RATE_RESPONSE, step)
        self._models = Recursion(models, (self._command, signals.reference), (), backend=backend)
        self.run = self._models.step
        """Advances the reference by one control period."""

    def set_target(self, target: Twist) -> None:
        """Sets the target velocity."""
        if target == self._target:
            return
        speed_changes = (target.forward, target.side) != (self._target.forward, self._target.side)
        self._command[:] = (target.forward, target.side, target.yaw_rate, speed_changes)
        self._target = target

    def step(self, target: Twist) -> Reference:
        """Advances one control period towards a target velocity."""
        self.set_target(target)
        self.run()
        rows = self.signals.reference.reshape(-1, _CHANNEL).tolist()
        return Reference(*(ReferenceChannel._make(row) for row in rows))


@cache
def _reference_models(
    speeding: SecondOrderResponse, turning: SecondOrderResponse, step: float
) -> ca.Function:
    """Builds the reference models of all channels, (command, reference) -> reference."""
    command, reference = ca.SX.sym("command", 4), ca.SX.sym("reference", 3 * _CHANNEL)
    forward, side, yaw_rate, together = ca.vertsplit(command)
    before = [ca.vertsplit(part)[:2] for part in ca.vertsplit(reference, _CHANNEL)]
    with_speed, alone = (
        _advance_second_order(response, before[2], yaw_rate, step=step) for response in (speeding, turning)
    )
    after = ca.vertcat(
        _advance_second_order(speeding, before[0], forward, step=step),
        _advance_second_order(speeding, before[1], side, step=step),
        ca.if_else(together, with_speed, alone),
    )
    return ca.Function("generate", [command, reference], [after])


def _advance_second_order(
    response: SecondOrderResponse, before: list[ca.SX], target: ca.SX, *, step: float
) -> ca.SX:
    """Returns one channel after a step with constant target.

    The step is exact.

    Returns:
        Value, rate and acceleration.
    """
    frequency, damping = response.frequency, response.damping
    decay = damping * frequency
    swing = frequency * sqrt(1.0 - damping**2)
    c, s, e = cos(swing * step), sin(swing * step), exp(-decay * step)
    offset, rate_before = before[0] - target, before[1]
    value = target + e * (c + decay / swing * s) * offset + e * s / swing * rate_before
    rate = -e * frequency**2 / swing * s * offset + e * (c - decay / swing * s) * rate_before
    return ca.vertcat(value, rate, frequency**2 * (target - value) - 2.0 * decay * rate)
