"""The control law of one period as one CasADi expression, for flying and for margins.

Architecture of the GT-Max (thesis, 3.2.2; Johnson and Kannan 2005): an outer loop for velocity and height
asks for attitude; a reference model shapes it; the inner loop adds feedback and takes off what the adaptive
element has learnt; approximate dynamic inversion of the model linearised in hover turns the angular
acceleration into servo commands. Pseudo-control hedging takes from the reference model what the servos'
limits take from the vehicle, so that the element does not learn them.
"""

from typing import NamedTuple

import casadi as ca

from sim.loop.motion import Seen
from sim.vehicle.parameters import Parameters, Servos

from . import adaptive_element as element
from .adaptive_element import Weights
from .control_signals import MEMORY_SIZES, InversionModel, Memory, Wanted, split
from .gains import Gains


class Errors(NamedTuple):
    """Attitude of the reference model less the vehicle's, the rate of that, the heading's error in rad.

    `free` is 1 where the tilt asked for is within its limit, else 0.
    """

    attitude: ca.SX
    attitude_rate: ca.SX
    heading: ca.SX
    free: ca.SX


class ControlLaw:
    """Writes down one period of the control law.

    Args:
        parameters: the vehicle as the controller takes it to be.
        model: its inversion model.
        gains: all gains.
        height: to be held, m.
        step: control period, s.
    """

    def __init__(
        self, parameters: Parameters, model: InversionModel, *, gains: Gains, height: float, step: float
    ) -> None:
        self._parameters, self._model, self._gains = parameters, model, gains
        self._height, self._step = height, step
        self._stiffness = ca.DM([value**2 for value in gains.attitude])
        self._damping = ca.DM([2.0 * gains.attitude_damping * value for value in gains.attitude])
        velocity, descent, attitude, yaw = (
            *(gains.learning_velocity, gains.learning_descent),
            *(gains.learning_attitude, gains.learning_yaw),
        )
        self._learning_rates = ca.DM([velocity, velocity, descent, attitude, attitude, yaw])

    def function(self) -> ca.Function:
        """Returns (estimate, wanted, learning, memory) -> (controls, memory)."""
        estimate, wanted = ca.SX.sym("estimate", len(Seen._fields)), ca.SX.sym("wanted", len(Wanted._fields))
        learning, memory = ca.SX.sym("learning"), ca.SX.sym("memory", sum(MEMORY_SIZES))
        controls, after = self._period(
            Seen._make(ca.vertsplit(estimate)), Wanted._make(ca.vertsplit(wanted)), learning, split(memory)
        )
        results = ca.cse([controls, ca.vertcat(*after)])
        return ca.Function("control", [estimate, wanted, learning, memory], results)

    def _period(self, seen: Seen, wanted: Wanted, learning: ca.SX, memory: Memory) -> tuple[ca.SX, Memory]:
        weights = Weights(
            ca.reshape(memory.inner_weights, element.INPUTS, element.HIDDEN),
            ca.reshape(memory.outer_weights, element.HIDDEN + 1, element.OUTPUTS),
        )
        inputs = _network_inputs(seen)
        learnt = element.output(weights, inputs)
        excess_yaw = self._excess_yaw(seen, wanted, memory)
        tilt, free = self._tilt(seen, wanted, learnt, wanted.yaw + excess_yaw)
        model, model_rates = _model(memory)
        asked = self._reference_model(wanted, tilt, memory)
        errors = Errors(
            attitude=model - ca.vertcat(seen.roll, seen.pitch),
            attitude_rate=model_rates - _euler_rates(seen),
            heading=self._heading_error(seen, wanted, memory),
            free=free,
        )
        pseudo = (
            asked + self._damping * errors.attitude_rate + self._stiffness * errors.attitude - learnt[3:5]
        )
        body_rates = _asked_body_rates(seen, wanted, memory)
        cyclic = self._invert(pseudo, body_rates, memory)
        collective = self._collective(seen, learnt[2])
        pedal = self._pedal(seen, wanted, errors, learnt[5] + self._model.yaw_from_collective * collective)
        controls = ca.vertcat(*wanted[-4:]) + ca.vertcat(cyclic, collective, pedal)
        servos, kept = reckon_servos(self._parameters.servos, memory.servos, controls, step=self._step)
        hedge = self._gains.hedging * (controls - kept)[:2] * ca.DM([self._model.roll, self._model.pitch])
        model_rates = model_rates + self._step * (asked - hedge)
        model = model + self._step * model_rates
        trained = self._train(
            weights, inputs, seen=seen, wanted=wanted, errors=errors, rates=learning * self._learning_rates
        )
        bar_back, bar_right = self._bar(cyclic, body_rates, memory)
        return controls, Memory(
            *(model[0], model_rates[0], model[1], model_rates[1]),
            *(bar_back, bar_right, errors.heading, excess_yaw, servos),
            *(ca.vec(trained.inner), ca.vec(trained.outer)),
        )

    def _tilt(self, seen: Seen, wanted: Wanted, learnt: ca.SX, turn: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Returns roll and pitch beyond the trim's, and whether they are within their limit (1 or 0).

        `turn` is the yaw rate of the turn that is believed to be flown.
        """
        gains, gravity = self._gains, self._parameters.environment.gravity
        c, s = ca.cos(seen.heading), ca.sin(seen.heading)
        learnt_forward, learnt_side = c * learnt[0] + s * learnt[1], -s * learnt[0] + c * learnt[1]
        # The trim holds the reference's own turn; what the vehicle flies differs by this.
        forward = wanted.forward_rate + gains.velocity * (wanted.forward - seen.forward)
        forward -= turn * seen.side + learnt_forward
        side = wanted.side_rate + gains.velocity * (wanted.side - seen.side)
        side += turn * seen.forward - wanted.yaw * wanted.forward - learnt_side
        tilt = ca.vertcat(side, -forward) / gravity
        limited = ca.fmax(-gains.tilt_limit, ca.fmin(gains.tilt_limit, tilt))
        return limited, ca.if_else(ca.norm_1(tilt - limited) > 0, 0, 1)

    def _excess_yaw(self, seen: Seen, wanted: Wanted, memory: Memory) -> ca.SX:
        """Returns the yaw rate past the reference's that is believed to be a turn.

        Banking at once for all of it closes a loop through roll and tail whose gain is speed over gravity:
        0.3 rad of bank for each rad/s at 10 ft/s, 2.5 rad at 80 ft/s, where it swings.
        """
        keep = ca.exp(-self._step / self._gains.turn_time)
        return keep * memory.excess_yaw + (1.0 - keep) * (seen.yaw_rate - wanted.yaw)

    def _reference_model(self, wanted: Wanted, tilt: ca.SX, memory: Memory) -> ca.SX:
        """Returns the angular accelerations in roll and pitch that the reference model asks for."""
        gains, gravity = self._gains, self._parameters.environment.gravity
        turning = wanted.yaw_rate * wanted.forward + wanted.yaw * wanted.forward_rate
        ahead = ca.vertcat(wanted.side_acceleration + turning, -wanted.forward_acceleration) / gravity
        command = ca.vertcat(wanted.trim_roll, wanted.trim_pitch) + tilt + gains.lead * ahead
        attitude, rate = _model(memory)
        frequency = gains.model_frequency
        return frequency**2 * (command - attitude) + 2.0 * gains.model_damping * frequency * (ahead - rate)

    def _invert(self, pseudo: ca.SX, body_rates: ca.SX, memory: Memory) -> ca.SX:
        """Returns cyclic beyond the trim's, lateral and longitudinal, for angular accelerations.

        What rotor and bar do against the asked rates is inverted; their damping of errors is left to help.
        """
        rotor, bar, model = self._parameters.main_rotor, self._parameters.stabiliser_bar, self._model
        right, back = pseudo[0] / model.roll, pseudo[1] / model.pitch
        damped = rotor.flapping_time * body_rates
        lateral = right + damped[0] - rotor.coupling_right_from_back * back - bar.mixing * memory.bar_right
        longitudinal = (
            back + damped[1] - rotor.coupling_back_from_right * right - bar.mixing * memory.bar_back
        )
        return ca.vertcat(lateral, longitudinal)

    def _bar(self, cyclic: ca.SX, rates: ca.SX, memory: Memory) -> tuple[ca.SX, ca.SX]:
        """Returns the bar's angles beyond the trim's after the period, as reckoned."""
        bar = self._parameters.stabiliser_bar
        keep = ca.exp(-self._step / bar.time)
        right = -bar.time * rates[0] + bar.gain_right * cyclic[0]
        back = -bar.time * rates[1] + bar.gain_back * cyclic[1]
        return back + (memory.bar_back - back) * keep, right + (memory.bar_right - right) * keep

    def _collective(self, seen: Seen, learnt: ca.SX) -> ca.SX:
        gains = self._gains
        # Both errors are positive where the vehicle must climb.
        error = seen.descent + gains.height * (self._height + seen.down)
        return (gains.descent * error + learnt) / self._model.lift

    def _heading_error(self, seen: Seen, wanted: Wanted, memory: Memory) -> ca.SX:
        """Returns the integral of the yaw rate's error, slowly forgotten."""
        keep = ca.exp(-self._step / self._gains.heading_memory)
        return keep * memory.heading_error + self._step * (wanted.yaw - seen.yaw_rate)

    def _pedal(self, seen: Seen, wanted: Wanted, errors: Errors, known: ca.SX) -> ca.SX:
        gains = self._gains
        pseudo = (
            wanted.yaw_rate + gains.yaw_rate * (wanted.yaw - seen.yaw_rate) + gains.heading * errors.heading
        )
        return (pseudo - known) / self._model.yaw

    def _train(
        self, weights: Weights, inputs: ca.SX, *, seen: Seen, wanted: Wanted, errors: Errors, rates: ca.SX
    ) -> Weights:
        gains = self._gains
        c, s = ca.cos(seen.heading), ca.sin(seen.heading)
        forward, side = wanted.forward - seen.forward, wanted.side - seen.side
        low, sinking = -(self._height + seen.down), -seen.descent
        training = ca.vertcat(
            # What the wind does stays put in the world, so the element learns it there.
            errors.free / (2.0 * gains.velocity) * (c * forward - s * side),
            errors.free / (2.0 * gains.velocity) * (s * forward + c * side),
            _training(low, sinking, gains.descent * gains.height, gains.descent),
            _training(errors.attitude, errors.attitude_rate, self._stiffness, self._damping),
            _training(errors.heading, wanted.yaw - seen.yaw_rate, gains.heading, gains.yaw_rate),
        )
        return element.learn(
            weights, inputs, training=training, rates=rates, forgetting=gains.forgetting, step=self._step
        )


def reckon_servos(servos: Servos, position: ca.SX, command: ca.SX, *, step: float) -> tuple[ca.SX, ca.SX]:
    """Returns where servos within their limits will be, and the command that unlimited ones would need."""
    share = 1.0 - ca.exp(-servos.bandwidth * step)
    cyclic = servos.cyclic_limit
    low = ca.DM([-cyclic, -cyclic, servos.collective_low, servos.pedal_low])
    high = ca.DM([cyclic, cyclic, servos.collective_high, servos.pedal_high])
    travel = step * ca.DM([servos.rate] * 3 + [servos.pedal_rate])
    moved = position + ca.fmin(travel, ca.fmax(-travel, share * (command - position)))
    moved = ca.fmin(high, ca.fmax(low, moved))
    return moved, position + (moved - position) / share


def _training(error: ca.SX, rate: ca.SX, stiffness: ca.DM | float, damping: ca.DM | float) -> ca.SX:
    """Returns e^T P B with P of the Lyapunov equation of e'' = -damping e' - stiffness e, unit weights."""
    return error / (2.0 * stiffness) + rate * (1.0 + 1.0 / stiffness) / (2.0 * damping)


def _euler_rates(seen: Seen) -> ca.SX:
    """Returns the rates of roll and pitch, shape (2, 1)."""
    return ca.vertcat(
        seen.roll_rate + seen.yaw_rate * ca.sin(seen.pitch),
        seen.pitch_rate * ca.cos(seen.roll) - seen.body_yaw_rate * ca.sin(seen.roll),
    )


def _about_body(attitude: ca.SX, rates: ca.SX, yaw_rate: ca.SX) -> ca.SX:
    """Returns the rates about the body's first two axes from roll, pitch, their rates and the heading's."""
    roll, pitch = attitude[0], attitude[1]
    return ca.vertcat(
        rates[0] - yaw_rate * ca.sin(pitch),
        rates[1] * ca.cos(roll) + yaw_rate * ca.sin(roll) * ca.cos(pitch),
    )


def _asked_body_rates(seen: Seen, wanted: Wanted, memory: Memory) -> ca.SX:
    """Returns the rates about the body's first two axes, beyond the trim's, that the model asks for.

    In a turn a bank that differs from the trim's is a pitch rate that differs, which the bar answers.
    """
    trim = ca.vertcat(wanted.trim_roll, wanted.trim_pitch)
    return _about_body(*_model(memory), seen.yaw_rate) - _about_body(trim, ca.SX(2, 1), wanted.yaw)


def _model(memory: Memory) -> tuple[ca.SX, ca.SX]:
    """Returns roll and pitch of the reference model, and their rates."""
    return ca.vertcat(memory.roll, memory.pitch), ca.vertcat(memory.roll_rate, memory.pitch_rate)


def _network_inputs(seen: Seen) -> ca.SX:
    """Returns what the network sees, each of order one."""
    return ca.vertcat(
        1.0,
        *(seen.forward / 5.0, seen.side / 5.0, seen.descent / 2.0),
        *(seen.roll / 0.3, seen.pitch / 0.3),
        *(seen.roll_rate, seen.pitch_rate, seen.yaw_rate),
    )
