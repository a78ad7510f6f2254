"""One step of servos and rotors, each part exactly for what is held through the step."""

import casadi as ca

from .parameters import Parameters, Servos
from .rotor import Air, RotorState, flapping_targets, settle_inflow


def advance(
    parameters: Parameters, state: RotorState, air: Air, *, command: ca.SX, step: float, iterations: int
) -> RotorState:
    """Steps servos, then flapping, bar and gyro, then inflow.

    Args:
        parameters: the vehicle.
        state: the rotor state before the step.
        air: motion through the air, held through the step.
        command: lateral, longitudinal, collective, pedal in rad of blade pitch, shape (4, 1).
        step: length of the step in s.
        iterations: relaxed inflow iterations, warm started.
    """
    state = follow_commands(parameters.servos, state, command, step=step)
    target = flapping_targets(parameters, state, air)
    turned = parameters.tail_rotor.gyro_gain * air.yaw_rate
    disc = ca.exp(-step / parameters.main_rotor.flapping_time)
    bar = ca.exp(-step / parameters.stabiliser_bar.time)
    state = state._replace(
        disc_back=target.disc_back + (state.disc_back - target.disc_back) * disc,
        disc_right=target.disc_right + (state.disc_right - target.disc_right) * disc,
        bar_back=target.bar_back + (state.bar_back - target.bar_back) * bar,
        bar_right=target.bar_right + (state.bar_right - target.bar_right) * bar,
        gyro=turned + (state.gyro - turned) * ca.exp(-parameters.tail_rotor.gyro_bandwidth * step),
    )
    return settle_inflow(parameters, state, air, iterations=iterations)


def follow_commands(servos: Servos, state: RotorState, command: ca.SX, *, step: float) -> RotorState:
    """Steps the first-order servos within their rates and travels; the gyro works against the pedal."""
    share = 1.0 - ca.exp(-servos.bandwidth * step)

    def follow(position: ca.SX, wanted: ca.SX, low: float, high: float, rate: float) -> ca.SX:
        travel = ca.fmin(rate * step, ca.fmax(-rate * step, share * (wanted - position)))
        return ca.fmin(high, ca.fmax(low, position + travel))

    cyclic, rate = servos.cyclic_limit, servos.rate
    return state._replace(
        lateral=follow(state.lateral, command[0], -cyclic, cyclic, rate),
        longitudinal=follow(state.longitudinal, command[1], -cyclic, cyclic, rate),
        collective=follow(state.collective, command[2], servos.collective_low, servos.collective_high, rate),
        pedal=follow(
            state.pedal, command[3] - state.gyro, servos.pedal_low, servos.pedal_high, servos.pedal_rate
        ),
    )
