"""Linearised motion near an equilibrium."""

from dataclasses import dataclass

import casadi as ca
import numpy as np
from jaxtyping import Float

from . import rotor
from .equilibrium import Equilibrium, accelerations, rotation_body_level
from .parameters import Parameters
from .rotor import Air, RotorState

# Iterations after which the inflow has converged to rounding, for derivatives through it.
_CONVERGED = 60
# Body velocity and rates, roll, pitch; servos, disc, bar, gyro; then down and heading, which do not affect
# the motion out of ground effect.
_BODY_STATES, _ROTOR_STATES = 8, 9
_STATES = _BODY_STATES + _ROTOR_STATES + 2


@dataclass(frozen=True, slots=True, eq=False)
class LinearMotion:
    """Linear motion about an equilibrium.

    x' = A x + B u, y = C x in deviations.

    Attributes:
        state: A; states are u, v, w, p, q, r, roll, pitch, four servos, disc back and right, bar back and
            right, gyro, down, heading.
        control: B; inputs are servo commands in the order of `Controls`.
        output: C; outputs are those of `Motion`, with north and east at 0.
    """

    state: Float[np.ndarray, "19 19"]
    control: Float[np.ndarray, "19 4"]
    output: Float[np.ndarray, "13 19"]


def linearise(parameters: Parameters, equilibrium: Equilibrium) -> LinearMotion:
    """Linearises the motion out of ground effect, with quasi-steady inflow."""
    states, command = ca.SX.sym("states", _STATES), ca.SX.sym("command", 4)
    roll, pitch = states[6], states[7]
    inflow = [ca.SX(value) for value in equilibrium.rotor_state[8:10]]
    state = RotorState._make([*ca.vertsplit(states[8:16]), *inflow, states[16]])
    air = rotor.still_air(states[:3], states[3:6])
    state = rotor.settle_inflow(parameters, state, air, iterations=_CONVERGED)
    body_level = rotation_body_level(roll, pitch)
    linear, angular = accelerations(parameters, state, air, down_body=body_level[:, 2])
    level = body_level.T @ states[:3]
    yaw_rate = (air.q * ca.sin(roll) + air.r * ca.cos(roll)) / ca.cos(pitch)
    pitch_rate = air.q * ca.cos(roll) - air.r * ca.sin(roll)
    rates = ca.vertcat(
        linear,
        angular,
        air.p + yaw_rate * ca.sin(pitch),
        pitch_rate,
        _rotor_rates(parameters, state, air, command),
        level[2],
        yaw_rate,
    )
    motion = ca.vertcat(0, 0, states[17], level, roll, pitch, states[18], states[3:6], yaw_rate)
    jacobians = ca.Function(
        "linear_motion",
        [states, command],
        [ca.jacobian(rates, states), ca.jacobian(rates, command), ca.jacobian(motion, states)],
    )
    return LinearMotion(*(np.array(part) for part in jacobians(_states(equilibrium), equilibrium.controls)))


def state_matrix(parameters: Parameters, equilibrium: Equilibrium) -> Float[np.ndarray, "17 17"]:
    """Returns the state matrix without height and heading."""
    inner = _BODY_STATES + _ROTOR_STATES
    return linearise(parameters, equilibrium).state[:inner, :inner]


def _rotor_rates(parameters: Parameters, state: RotorState, air: Air, command: ca.SX) -> ca.SX:
    """Returns rates of servos, disc, bar and gyro, shape (9, 1)."""
    target = rotor.flapping_targets(parameters, state, air)
    disc, bar = parameters.main_rotor.flapping_time, parameters.stabiliser_bar.time
    tail = parameters.tail_rotor
    servos = ca.vertcat(state.lateral, state.longitudinal, state.collective, state.pedal + state.gyro)
    return ca.vertcat(
        parameters.servos.bandwidth * (command - servos),
        (target.disc_back - state.disc_back) / disc,
        (target.disc_right - state.disc_right) / disc,
        (target.bar_back - state.bar_back) / bar,
        (target.bar_right - state.bar_right) / bar,
        tail.gyro_bandwidth * (tail.gyro_gain * air.yaw_rate - state.gyro),
    )


def _states(equilibrium: Equilibrium) -> ca.DM:
    body_level = ca.evalf(rotation_body_level(ca.SX(equilibrium.roll), ca.SX(equilibrium.pitch)))
    velocity = equilibrium.velocity
    return ca.vertcat(
        body_level @ ca.DM([velocity.forward, velocity.side, 0.0]),
        body_level @ ca.DM([0.0, 0.0, velocity.yaw_rate]),
        equilibrium.roll,
        equilibrium.pitch,
        ca.DM(list(equilibrium.rotor_state[:8])),
        equilibrium.rotor_state[10],
        0.0,
        0.0,
    )
