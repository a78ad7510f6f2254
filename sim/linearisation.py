"""The motion near an equilibrium as a linear system, from the same expressions that are flown."""

import casadi as ca
import numpy as np
from jaxtyping import Float

from . import rotor
from .equilibrium import Equilibrium, accelerations, rotation_body_level
from .parameters import Parameters
from .rotor import RotorState

# Iterations after which the inflow has converged to rounding, for derivatives through it.
_CONVERGED = 60


def state_matrix(parameters: Parameters, equilibrium: Equilibrium) -> Float[np.ndarray, "12 12"]:
    """Linearises the motion in still air with the controls held; the inflow follows at once.

    Returns:
        The matrix of the states u, v, w, p, q, r, roll, pitch, disc back, disc right, bar back, bar right.
    """
    states = ca.SX.sym("states", 12)
    roll, pitch = states[6], states[7]
    held = RotorState._make([ca.SX(value) for value in equilibrium.rotor_state])
    state = held._replace(
        disc_back=states[8], disc_right=states[9], bar_back=states[10], bar_right=states[11]
    )
    air = rotor.still_air(states[:3], states[3:6])
    state = rotor.settle_inflow(parameters, state, air, iterations=_CONVERGED)
    down = rotation_body_level(roll, pitch)[:, 2]
    linear, angular = accelerations(parameters, state, air, down_body=down)
    roll_rate = air.p + (air.q * ca.sin(roll) + air.r * ca.cos(roll)) * ca.tan(pitch)
    pitch_rate = air.q * ca.cos(roll) - air.r * ca.sin(roll)
    target = rotor.flapping_targets(parameters, state, air)
    disc, bar = parameters.main_rotor.flapping_time, parameters.stabiliser_bar.time
    rates = ca.vertcat(
        linear,
        angular,
        roll_rate,
        pitch_rate,
        (target.disc_back - state.disc_back) / disc,
        (target.disc_right - state.disc_right) / disc,
        (target.bar_back - state.bar_back) / bar,
        (target.bar_right - state.bar_right) / bar,
    )
    jacobian = ca.Function("state_matrix", [states], [ca.jacobian(rates, states)])
    return np.array(jacobian(_states(equilibrium)))


def _states(equilibrium: Equilibrium) -> ca.DM:
    body_level = ca.evalf(rotation_body_level(ca.SX(equilibrium.roll), ca.SX(equilibrium.pitch)))
    velocity = equilibrium.velocity
    return ca.vertcat(
        body_level @ ca.DM([velocity.forward, velocity.side, 0.0]),
        body_level @ ca.DM([0.0, 0.0, velocity.yaw_rate]),
        equilibrium.roll,
        equilibrium.pitch,
        ca.DM(list(equilibrium.rotor_state[4:8])),
    )
