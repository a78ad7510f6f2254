"""Exact discrete step of servos and rotors."""

from dataclasses import dataclass

import casadi as ca

from .parameters import Parameters, Servos
from .rotor import Air, RotorState, flapping_targets, settle_inflow


@dataclass(frozen=True, slots=True)
class ServoDynamics:
    """Largest rate and bandwidth of a servo, rad/s."""

    rate: float
    bandwidth: float


AllServoDynamics = tuple[ServoDynamics, ServoDynamics, ServoDynamics, ServoDynamics]
"""Lateral, longitudinal, collective and pedal servo."""


def nominal_servo_dynamics(servos: Servos) -> AllServoDynamics:
    """Returns the servos without faults."""
    cyclic = ServoDynamics(servos.rate, servos.bandwidth)
    return cyclic, cyclic, cyclic, ServoDynamics(servos.pedal_rate, servos.bandwidth)


def advance(
    parameters: Parameters,
    state: RotorState,
    air: Air,
    *,
    command: ca.SX,
    step: float,
    iterations: int,
    servo_dynamics: AllServoDynamics | None = None,
) -> RotorState:
    """Steps servos, then flapping, bar and gyro, then inflow.

    Args:
        parameters: vehicle.
        state: rotor state before the step.
        air: motion through the air, held through the step.
        command: lateral, longitudinal, collective, pedal in rad of blade pitch, shape (4, 1).
        step: length of the step, s.
        iterations: relaxed inflow iterations, warm started.
        servo_dynamics: rates and bandwidths of the servos; nominal ones if None.
    """
    servo_dynamics = servo_dynamics or nominal_servo_dynamics(parameters.servos)
    state = follow_commands(parameters.servos, state, command, step=step, servo_dynamics=servo_dynamics)
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


def follow_commands(
    servos: Servos, state: RotorState, command: ca.SX, *, step: float, servo_dynamics: AllServoDynamics
) -> RotorState:
    """Steps first-order servos within their rates and travels.

    The gyro is subtracted from the pedal command; a rigging error adds to the blade pitch of a command.
    """

    def follow(drive: ServoDynamics, position: ca.SX, wanted: ca.SX, low: float, high: float) -> ca.SX:
        share, reach = 1.0 - ca.exp(-drive.bandwidth * step), drive.rate * step
        travel = ca.fmin(reach, ca.fmax(-reach, share * (wanted - position)))
        return ca.fmin(high, ca.fmax(low, position + travel))

    lateral, longitudinal, collective, pedal = servo_dynamics
    cyclic, up = servos.cyclic_limit, (servos.collective_low, servos.collective_high)
    return state._replace(
        lateral=follow(lateral, state.lateral, command[0] + servos.rigging_lateral, -cyclic, cyclic),
        longitudinal=follow(
            longitudinal, state.longitudinal, command[1] + servos.rigging_longitudinal, -cyclic, cyclic
        ),
        collective=follow(collective, state.collective, command[2] + servos.rigging_collective, *up),
        pedal=follow(
            *(pedal, state.pedal, command[3] - state.gyro + servos.rigging_pedal),
            *(servos.pedal_low, servos.pedal_high),
        ),
    )
