"""Control law of one period as a CasADi expression.

Architecture of the GT-Max (thesis, 3.2.2; Johnson and Kannan 2005): an outer loop for velocity and height
commands attitude; a reference model shapes it; the inner loop adds feedback and subtracts the output of the
adaptive element; approximate dynamic inversion of the model linearised in hover converts angular acceleration
to servo commands. Pseudo-control hedging subtracts from the reference model the acceleration lost to the
servos' limits, so that the element does not learn them.
"""

from typing import NamedTuple

import casadi as ca

from sim.loop.motion import Estimate
from sim.vehicle.parameters import Parameters, Servos

from . import adaptive_element as element
from .adaptive_element import Weights
from .control_signals import STATE_SIZES, ControllerState, ControlReference, InversionModel, split_state
from .gains import Gains


class TrackingErrors(NamedTuple):
    """Tracking errors of attitude, attitude rate and heading.

    Attitude and rate are those of the reference model minus those of the vehicle. `free` is 1 if the
    commanded tilt is within its limit, else 0.
    """

    attitude: ca.SX
    attitude_rate: ca.SX
    heading: ca.SX
    free: ca.SX


class ControlLaw:
    """Expression of one period of the control law.

    Args:
        parameters: vehicle that the controller is designed for.
        model: its inversion model.
        gains: all gains.
        height: height to hold, m.
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
        """Returns (estimate, reference, learning, state) -> (controls, state)."""
        estimate, reference = (
            ca.SX.sym("estimate", len(Estimate._fields)),
            ca.SX.sym("wanted", len(ControlReference._fields)),
        )
        learning, state = ca.SX.sym("learning"), ca.SX.sym("memory", sum(STATE_SIZES))
        controls, after = self._period(
            Estimate._make(ca.vertsplit(estimate)),
            ControlReference._make(ca.vertsplit(reference)),
            learning,
            split_state(state),
        )
        results = ca.cse([controls, ca.vertcat(*after)])
        return ca.Function("control", [estimate, reference, learning, state], results)

    def _period(
        self, estimate: Estimate, reference: ControlReference, learning: ca.SX, state: ControllerState
    ) -> tuple[ca.SX, ControllerState]:
        weights = Weights(
            ca.reshape(state.inner_weights, element.INPUTS, element.HIDDEN),
            ca.reshape(state.outer_weights, element.HIDDEN + 1, element.OUTPUTS),
        )
        inputs = _network_inputs(estimate)
        learnt = element.network_output(weights, inputs)
        excess_yaw = self._excess_yaw(estimate, reference, state)
        tilt, free = self._tilt(estimate, reference, learnt, reference.yaw + excess_yaw)
        model, model_rates = _model(state)
        commanded = self._reference_model(reference, tilt, state)
        errors = TrackingErrors(
            attitude=model - ca.vertcat(estimate.roll, estimate.pitch),
            attitude_rate=model_rates - _euler_rates(estimate),
            heading=self._heading_error(estimate, reference, state),
            free=free,
        )
        pseudo = (
            commanded + self._damping * errors.attitude_rate + self._stiffness * errors.attitude - learnt[3:5]
        )
        body_rates = _commanded_body_rates(estimate, reference, state)
        cyclic = self._invert(pseudo, body_rates, state)
        collective = self._collective(estimate, learnt[2])
        pedal = self._pedal(
            estimate, reference, errors, learnt[5] + self._model.yaw_from_collective * collective
        )
        controls = ca.vertcat(*reference[-4:]) + ca.vertcat(cyclic, collective, pedal)
        servos, kept = predict_servos(self._parameters.servos, state.servos, controls, step=self._step)
        hedge = self._gains.hedging * (controls - kept)[:2] * ca.DM([self._model.roll, self._model.pitch])
        model_rates = model_rates + self._step * (commanded - hedge)
        model = model + self._step * model_rates
        trained = self._update_weights(
            weights,
            inputs,
            estimate=estimate,
            reference=reference,
            errors=errors,
            rates=learning * self._learning_rates,
        )
        bar_back, bar_right = self._predict_stabiliser_bar(cyclic, body_rates, state)
        return controls, ControllerState(
            *(model[0], model_rates[0], model[1], model_rates[1]),
            *(bar_back, bar_right, errors.heading, excess_yaw, servos),
            *(ca.vec(trained.inner), ca.vec(trained.outer)),
        )

    def _tilt(
        self, estimate: Estimate, reference: ControlReference, learnt: ca.SX, turn: ca.SX
    ) -> tuple[ca.SX, ca.SX]:
        """Returns roll and pitch beyond the trim's, and if within limits.

        The second value is 1 within the limit and 0 at it. `turn` is the yaw rate of the turn being flown.
        """
        gains, gravity = self._gains, self._parameters.environment.gravity
        c, s = ca.cos(estimate.heading), ca.sin(estimate.heading)
        learnt_forward, learnt_side = c * learnt[0] + s * learnt[1], -s * learnt[0] + c * learnt[1]
        # The trim holds the reference's own turn; the flown turn differs by this.
        forward = reference.forward_rate + gains.velocity * (reference.forward - estimate.forward)
        forward -= turn * estimate.side + learnt_forward
        side = reference.side_rate + gains.velocity * (reference.side - estimate.side)
        side += turn * estimate.forward - reference.yaw * reference.forward - learnt_side
        tilt = ca.vertcat(side, -forward) / gravity
        limited = ca.fmax(-gains.tilt_limit, ca.fmin(gains.tilt_limit, tilt))
        return limited, ca.if_else(ca.norm_1(tilt - limited) > 0, 0, 1)

    def _excess_yaw(self, estimate: Estimate, reference: ControlReference, state: ControllerState) -> ca.SX:
        """Returns the filtered yaw rate beyond the reference, for banking.

        Unfiltered banking closes a loop through roll and tail with the gain speed over gravity: 0.3 rad of
        bank for each rad/s at 10 ft/s, but 2.5 rad at 80 ft/s, where it oscillates.
        """
        keep = ca.exp(-self._step / self._gains.turn_time)
        return keep * state.excess_yaw + (1.0 - keep) * (estimate.yaw_rate - reference.yaw)

    def _reference_model(self, reference: ControlReference, tilt: ca.SX, state: ControllerState) -> ca.SX:
        """Returns roll and pitch accelerations of the reference model."""
        gains, gravity = self._gains, self._parameters.environment.gravity
        turning = reference.yaw_rate * reference.forward + reference.yaw * reference.forward_rate
        ahead = ca.vertcat(reference.side_acceleration + turning, -reference.forward_acceleration) / gravity
        command = ca.vertcat(reference.trim_roll, reference.trim_pitch) + tilt + gains.lead * ahead
        attitude, rate = _model(state)
        frequency = gains.model_frequency
        return frequency**2 * (command - attitude) + 2.0 * gains.model_damping * frequency * (ahead - rate)

    def _invert(self, pseudo: ca.SX, body_rates: ca.SX, state: ControllerState) -> ca.SX:
        """Returns cyclic beyond the trim's for angular accelerations.

        Lateral, then longitudinal. The response of rotor and bar to the commanded rates is inverted; their
        damping of rate errors is kept.
        """
        rotor, bar, model = self._parameters.main_rotor, self._parameters.stabiliser_bar, self._model
        right, back = pseudo[0] / model.roll, pseudo[1] / model.pitch
        damped = rotor.flapping_time * body_rates
        lateral = right + damped[0] - rotor.coupling_right_from_back * back - bar.mixing * state.bar_right
        longitudinal = back + damped[1] - rotor.coupling_back_from_right * right - bar.mixing * state.bar_back
        return ca.vertcat(lateral, longitudinal)

    def _predict_stabiliser_bar(
        self, cyclic: ca.SX, rates: ca.SX, state: ControllerState
    ) -> tuple[ca.SX, ca.SX]:
        """Returns the predicted bar angles beyond the trim's."""
        bar = self._parameters.stabiliser_bar
        keep = ca.exp(-self._step / bar.time)
        right = -bar.time * rates[0] + bar.gain_right * cyclic[0]
        back = -bar.time * rates[1] + bar.gain_back * cyclic[1]
        return back + (state.bar_back - back) * keep, right + (state.bar_right - right) * keep

    def _collective(self, estimate: Estimate, learnt: ca.SX) -> ca.SX:
        gains = self._gains
        # Both errors are positive where the vehicle must climb.
        error = estimate.descent + gains.height * (self._height + estimate.down)
        return (gains.descent * error + learnt) / self._model.lift

    def _heading_error(
        self, estimate: Estimate, reference: ControlReference, state: ControllerState
    ) -> ca.SX:
        """Returns the leaky integral of the yaw rate error."""
        keep = ca.exp(-self._step / self._gains.heading_error_time)
        return keep * state.heading_error + self._step * (reference.yaw - estimate.yaw_rate)

    def _pedal(
        self, estimate: Estimate, reference: ControlReference, errors: TrackingErrors, known: ca.SX
    ) -> ca.SX:
        gains = self._gains
        pseudo = (
            reference.yaw_rate
            + gains.yaw_rate * (reference.yaw - estimate.yaw_rate)
            + gains.heading * errors.heading
        )
        return (pseudo - known) / self._model.yaw

    def _update_weights(
        self,
        weights: Weights,
        inputs: ca.SX,
        *,
        estimate: Estimate,
        reference: ControlReference,
        errors: TrackingErrors,
        rates: ca.SX,
    ) -> Weights:
        gains = self._gains
        c, s = ca.cos(estimate.heading), ca.sin(estimate.heading)
        forward, side = reference.forward - estimate.forward, reference.side - estimate.side
        low, sinking = -(self._height + estimate.down), -estimate.descent
        training = ca.vertcat(
            # Wind disturbances are constant in world axes, so the element learns there.
            errors.free / (2.0 * gains.velocity) * (c * forward - s * side),
            errors.free / (2.0 * gains.velocity) * (s * forward + c * side),
            _training_signal(low, sinking, gains.descent * gains.height, gains.descent),
            _training_signal(errors.attitude, errors.attitude_rate, self._stiffness, self._damping),
            _training_signal(
                errors.heading, reference.yaw - estimate.yaw_rate, gains.heading, gains.yaw_rate
            ),
        )
        return element.update_weights(
            weights, inputs, training=training, rates=rates, forgetting=gains.forgetting, step=self._step
        )


def predict_servos(servos: Servos, position: ca.SX, command: ca.SX, *, step: float) -> tuple[ca.SX, ca.SX]:
    """Returns limited servo positions, and the equivalent command without limits."""
    share = 1.0 - ca.exp(-servos.bandwidth * step)
    cyclic = servos.cyclic_limit
    low = ca.DM([-cyclic, -cyclic, servos.collective_low, servos.pedal_low])
    high = ca.DM([cyclic, cyclic, servos.collective_high, servos.pedal_high])
    travel = step * ca.DM([servos.rate] * 3 + [servos.pedal_rate])
    moved = position + ca.fmin(travel, ca.fmax(-travel, share * (command - position)))
    moved = ca.fmin(high, ca.fmax(low, moved))
    return moved, position + (moved - position) / share


def _training_signal(error: ca.SX, rate: ca.SX, stiffness: ca.DM | float, damping: ca.DM | float) -> ca.SX:
    """Returns the training signal e^T P B.

    P solves the Lyapunov equation of e'' = -damping e' - stiffness e with unit weights.
    """
    return error / (2.0 * stiffness) + rate * (1.0 + 1.0 / stiffness) / (2.0 * damping)


def _euler_rates(estimate: Estimate) -> ca.SX:
    """Returns the rates of roll and pitch, shape (2, 1)."""
    return ca.vertcat(
        estimate.roll_rate + estimate.yaw_rate * ca.sin(estimate.pitch),
        estimate.pitch_rate * ca.cos(estimate.roll) - estimate.body_yaw_rate * ca.sin(estimate.roll),
    )


def _body_rates(attitude: ca.SX, rates: ca.SX, yaw_rate: ca.SX) -> ca.SX:
    """Returns roll and pitch body rates from Euler angles and rates."""
    roll, pitch = attitude[0], attitude[1]
    return ca.vertcat(
        rates[0] - yaw_rate * ca.sin(pitch),
        rates[1] * ca.cos(roll) + yaw_rate * ca.sin(roll) * ca.cos(pitch),
    )


def _commanded_body_rates(estimate: Estimate, reference: ControlReference, state: ControllerState) -> ca.SX:
    """Returns the reference model's body rates beyond the trim's.

    About the first two axes. In a turn a bank other than the trim's implies another pitch rate, to which the
    bar responds.
    """
    trim = ca.vertcat(reference.trim_roll, reference.trim_pitch)
    return _body_rates(*_model(state), estimate.yaw_rate) - _body_rates(trim, ca.SX(2, 1), reference.yaw)


def _model(state: ControllerState) -> tuple[ca.SX, ca.SX]:
    """Returns roll and pitch of the reference model, and their rates."""
    return ca.vertcat(state.roll, state.pitch), ca.vertcat(state.roll_rate, state.pitch_rate)


def _network_inputs(estimate: Estimate) -> ca.SX:
    """Returns the network's inputs, scaled to order one."""
    return ca.vertcat(
        1.0,
        *(estimate.forward / 5.0, estimate.side / 5.0, estimate.descent / 2.0),
        *(estimate.roll / 0.3, estimate.pitch / 0.3),
        *(estimate.roll_rate, estimate.pitch_rate, estimate.yaw_rate),
    )
