"""The flight controller: fixed gains in cascade, attitude inside, velocity, yaw rate and height outside.

It sees an estimate only. Feed-forward does the maneuvers (trim controls over speed and yaw rate, acceleration
and its rate from the reference model), feedback the gusts.
"""

from dataclasses import dataclass
from math import cos, exp, sin

from flight.se2 import SE2

from .maneuver_generator import Reference
from .motion import Controls, Motion
from .parameters import Parameters
from .trim_table import trim_table


@dataclass(frozen=True, slots=True)
class Gains:
    """Gains of the controller; every one in SI.

    Attributes:
        velocity: acceleration per velocity error, 1/s.
        velocity_integral: per integral of velocity error, 1/s2.
        lead: time that the attitude command runs ahead of the reference, s.
        attitude: cyclic per attitude error, rad/rad.
        rate_ahead: cyclic per commanded body rate, near the inverse of rotor and bar at low frequency, s.
        yaw_rate: pedal per yaw rate error, s.
        yaw_rate_integral: pedal per heading error, rad/rad.
        yaw_ahead: pedal per commanded yaw acceleration, s2.
        torque_ahead: pedal per collective of the height feedback, against the main rotor's torque, rad/rad.
        height: descent per height error, 1/s.
        descent: collective per descent error, rad s/m.
        descent_integral: collective per integral of descent error, rad/m.
        tilt_limit: largest attitude command away from the trim's, rad.
        forgetting: time after which an integral of an error that has gone is forgotten, s.
    """

    velocity: float = 1.4
    velocity_integral: float = 0.6
    lead: float = 0.04
    attitude: float = 0.35
    rate_ahead: float = 0.11
    yaw_rate: float = 0.12
    yaw_rate_integral: float = 0.3
    yaw_ahead: float = 0.0112
    torque_ahead: float = 1.05
    height: float = 0.7
    descent: float = 0.035
    descent_integral: float = 0.02
    tilt_limit: float = 0.45
    forgetting: float = 60.0


# Roll and pitch modes of hub, flapping and bar in hover, in rad/s; the damping is theirs too.
_ROLL_MODE, _PITCH_MODE, _MODE_DAMPING, _NOTCH_DAMPING = 11.5, 8.4, 0.22, 0.8


class _Notch:
    """Takes the lightly damped rotor mode out of the attitude feedback (exact for a held input)."""

    def __init__(self, frequency: float, step: float) -> None:
        # Poles w exp(+-i acos(z)); stepped exactly as in the maneuver generator's reference model.
        decay = _NOTCH_DAMPING * frequency
        swing = frequency * (1.0 - _NOTCH_DAMPING**2) ** 0.5
        c, s, e = cos(swing * step), sin(swing * step), exp(-decay * step)
        self._offset_from = (e * (c + decay / swing * s), e * s / swing)
        self._rate_from = (-e * frequency**2 / swing * s, e * (c - decay / swing * s))
        self._through = 2.0 * (_MODE_DAMPING - _NOTCH_DAMPING) * frequency
        self._stiffness = frequency**2
        self._value, self._rate = 0.0, 0.0

    def step(self, value: float) -> float:
        rest = value / self._stiffness
        offset, rate = self._value - rest, self._rate
        self._value = rest + self._offset_from[0] * offset + self._offset_from[1] * rate
        self._rate = self._rate_from[0] * offset + self._rate_from[1] * rate
        return value + self._through * self._rate


class Controller:
    """Follows a reference at a height.

    Args:
        parameters: the vehicle, for the feed-forward of its trims.
        height: above ground, m.
        step: control period in s.
        gains: all feedback and feed-forward gains.
    """

    def __init__(
        self, parameters: Parameters, *, height: float, step: float, gains: Gains | None = None
    ) -> None:
        self._gains = gains or Gains()
        self._trims = trim_table(parameters)
        self._gravity = parameters.environment.gravity
        self._height, self._step = height, step
        self._notches = (_Notch(_ROLL_MODE, step), _Notch(_PITCH_MODE, step))
        self._keep = exp(-step / self._gains.forgetting)
        # Integrals: acceleration north and east (what wind asks for stays put in the world), pedal,
        # collective.
        self._north = self._east = self._pedal = self._collective = 0.0

    def turn(self, angle: float) -> None:
        """Follows a turn of the whole world about the vertical, in rad."""
        turned = SE2(0.0, 0.0, angle) @ SE2(self._north, self._east, 0.0)
        self._north, self._east = turned.x, turned.y

    def step(self, estimate: Motion, reference: Reference) -> Controls:
        """Returns the servo commands for the next control period."""
        gains = self._gains
        forward, side, yaw = reference
        trim = self._trims.at(forward.value, yaw.value)
        acceleration = self._velocity_feedback(estimate, reference)
        gravity = self._gravity
        pitch_rate = -forward.acceleration / gravity
        roll_rate = (side.acceleration + yaw.rate * forward.value + yaw.value * forward.rate) / gravity
        # The trim holds the reference's own turn; what the vehicle flies differs by this.
        coupling_forward = estimate.yaw_rate * estimate.side
        coupling_side = estimate.yaw_rate * estimate.forward - yaw.value * forward.value
        limit = gains.tilt_limit
        tilt_pitch = _clip(-(forward.rate + acceleration[0] - coupling_forward) / gravity, limit)
        tilt_roll = _clip((side.rate + acceleration[1] + coupling_side) / gravity, limit)
        roll_error = trim.roll + tilt_roll + gains.lead * roll_rate - estimate.roll
        pitch_error = trim.pitch + tilt_pitch + gains.lead * pitch_rate - estimate.pitch
        collective = self._height_feedback(estimate)
        pedal = self._yaw_feedback(estimate, reference)
        return Controls(
            lateral=trim.lateral
            + self._notches[0].step(gains.attitude * roll_error)
            + gains.rate_ahead * roll_rate,
            longitudinal=trim.longitudinal
            + self._notches[1].step(gains.attitude * pitch_error)
            + gains.rate_ahead * pitch_rate,
            collective=trim.collective + collective,
            pedal=trim.pedal + pedal + gains.yaw_ahead * yaw.rate + gains.torque_ahead * collective,
        )

    def _velocity_feedback(self, estimate: Motion, reference: Reference) -> tuple[float, float]:
        """Returns the acceleration in the heading frame that answers the velocity error and the wind."""
        gains = self._gains
        error_forward = reference.forward.value - estimate.forward
        error_side = reference.side.value - estimate.side
        c, s = cos(estimate.heading), sin(estimate.heading)
        gain = gains.velocity_integral * self._step
        # No more than the tilt can give, or a storm would wind the integrals up.
        most = gains.tilt_limit * self._gravity
        self._north = _clip(self._keep * self._north + gain * (c * error_forward - s * error_side), most)
        self._east = _clip(self._keep * self._east + gain * (s * error_forward + c * error_side), most)
        return (
            gains.velocity * error_forward + c * self._north + s * self._east,
            gains.velocity * error_side - s * self._north + c * self._east,
        )

    def _yaw_feedback(self, estimate: Motion, reference: Reference) -> float:
        gains = self._gains
        error = reference.yaw_rate.value - estimate.yaw_rate
        self._pedal = self._keep * self._pedal + gains.yaw_rate_integral * self._step * error
        return gains.yaw_rate * error + self._pedal

    def _height_feedback(self, estimate: Motion) -> float:
        gains = self._gains
        # Both errors are positive where the vehicle must climb.
        error = estimate.descent + gains.height * (self._height + estimate.down)
        self._collective = self._keep * self._collective + gains.descent_integral * self._step * error
        return gains.descent * error + self._collective


def _clip(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))
