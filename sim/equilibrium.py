"""Steady level flight, straight or turning: the controls and attitude that hold a trim velocity in still air."""

from dataclasses import dataclass

import casadi as ca
from flight.errors import FlightError
from flight.se2 import Twist

from . import rotor
from .parameters import Parameters
from .rotor import Air, RotorState

# Residual of accelerations (m/s2, rad/s2), angles and inflow (m/s) that counts as balanced.
RESIDUAL = 1e-9
# Unknowns at a plain hover, from which every other equilibrium is reached: roll, pitch, then the rotor state.
_HOVER_GUESS = (0.05, 0.0, 0.0, 0.0, 0.16, 0.1, 0.0, 0.0, 0.0, 0.0, 6.4, 5.0)
# Longest stride in forward and side speed (m/s) and yaw rate (rad/s) from a known equilibrium to the next.
_STRIDE = (2.5, 2.5, 0.15)


class NoEquilibriumError(FlightError):
    """No steady flight was found at a velocity."""

    def __init__(self, velocity: Twist, residual: float) -> None:
        super().__init__(
            f"no equilibrium found at forward {velocity.forward:g} m/s, side {velocity.side:g} m/s, "
            f"yaw rate {velocity.yaw_rate:g} rad/s: residual {residual:.1e}, expected at most {RESIDUAL:.0e}"
        )


@dataclass(frozen=True, slots=True)
class Equilibrium:
    """A balanced flight state.

    Attributes:
        velocity: trim velocity in the heading frame.
        roll: rad.
        pitch: rad.
        lateral: cyclic pitch in rad; positive tilts the disc to the right.
        longitudinal: cyclic pitch in rad; positive tilts the disc back.
        collective: rad.
        pedal: tail rotor pitch in rad.
        rotor_state: the ten entries of `rotor.RotorState`.
        power: shaft power of both rotors in W.
    """

    velocity: Twist
    roll: float
    pitch: float
    lateral: float
    longitudinal: float
    collective: float
    pedal: float
    rotor_state: tuple[float, ...]
    power: float


class EquilibriumFinder:
    """Finds equilibria of one vehicle; every one found serves as a start for the next."""

    def __init__(self, parameters: Parameters) -> None:
        """Builds the balance of forces and its root finder."""
        unknowns, velocity = ca.SX.sym("unknowns", 12), ca.SX.sym("velocity", 3)
        residual, power = balance(parameters, unknowns, velocity)
        self._balance = ca.Function("balance", [unknowns, velocity], [residual, power])
        problem = {"x": unknowns, "p": velocity, "g": residual}
        self._solve = ca.rootfinder("equilibrium", "newton", problem, {"error_on_fail": False})

    def find(self, velocity: Twist) -> Equilibrium:
        """Returns the equilibrium at a heading-frame velocity, reached in strides from hover.

        Raises:
            NoEquilibriumError: the balance was not met.
        """
        wanted = (velocity.forward, velocity.side, velocity.yaw_rate)
        strides = 1 + int(max(abs(part) / stride for part, stride in zip(wanted, _STRIDE, strict=True)))
        unknowns = ca.DM(_HOVER_GUESS)
        for stride in range(strides + 1):
            unknowns = self._solve(unknowns, ca.DM(wanted) * (stride / strides))
        residual, power = self._balance(unknowns, ca.DM(wanted))
        worst = float(ca.norm_inf(residual))
        if not worst <= RESIDUAL:
            raise NoEquilibriumError(velocity, worst)
        roll, pitch, *state = (float(value) for value in unknowns.elements())
        return Equilibrium(velocity, roll, pitch, state[0], state[1], state[2], state[3], tuple(state), float(power))


def balance(parameters: Parameters, unknowns: ca.SX, velocity: ca.SX) -> tuple[ca.SX, ca.SX]:
    """States the balance of steady level flight in still air.

    Args:
        parameters: the vehicle.
        unknowns: roll, pitch and the ten entries of the rotor state, shape (12, 1).
        velocity: forward, side (m/s) and yaw rate (rad/s) in the heading frame, shape (3, 1).

    Returns:
        What must vanish, shape (12, 1): accelerations, angular accelerations, flapping and inflow; and the power.
    """
    roll, pitch = unknowns[0], unknowns[1]
    state = RotorState(*(unknowns[2 + i] for i in range(10)))
    body_level = rotation_body_level(roll, pitch)
    velocity_body = body_level @ ca.vertcat(velocity[0], velocity[1], 0)
    rates = body_level @ ca.vertcat(0, 0, velocity[2])
    air = rotor.still_air(velocity_body, rates)
    acceleration, angular = accelerations(parameters, state, air, down_body=body_level[:, 2])
    flapping = rotor.flapping_targets(parameters, state, air)
    main, tail = rotor.inflow_targets(parameters, state, air)
    residual = ca.vertcat(
        acceleration,
        angular,
        *(getattr(flapping, name) - getattr(state, name) for name in flapping._fields),
        main - state.inflow,
        tail - state.tail_inflow,
    )
    return residual, rotor.loads(parameters, state, air).power


def accelerations(
    parameters: Parameters, state: RotorState, air: Air, *, down_body: ca.SX
) -> tuple[ca.SX, ca.SX]:
    """Returns the rates of body velocity (m/s2) and body rates (rad/s2) in still air, by Newton and Euler.

    Args:
        parameters: the vehicle.
        state: the rotors.
        air: motion, which in still air is that over the ground.
        down_body: unit vector down in body axes, shape (3, 1).
    """
    load = rotor.loads(parameters, state, air)
    velocity, rates = ca.vertcat(air.u, air.v, air.w), ca.vertcat(air.p, air.q, air.r)
    matrix = rotor.inertia(parameters)
    gravity = parameters.environment.gravity * down_body
    linear = load.force / parameters.body.mass + gravity - ca.cross(rates, velocity)
    angular = ca.inv(matrix) @ (load.moment - ca.cross(rates, matrix @ rates))
    return linear, angular


def rotation_body_level(roll: ca.SX, pitch: ca.SX) -> ca.SX:
    """Returns the matrix that brings a vector of the level heading frame into body axes."""
    cr, sr, cp, sp = ca.cos(roll), ca.sin(roll), ca.cos(pitch), ca.sin(pitch)
    return ca.vertcat(
        ca.horzcat(cp, 0, -sp),
        ca.horzcat(sr * sp, cr, sr * cp),
        ca.horzcat(cr * sp, -sr, cr * cp),
    )


# Iterations after which the inflow has converged to rounding, for derivatives through it.
_CONVERGED = 60


def state_matrix(parameters: Parameters, equilibrium: Equilibrium) -> ca.DM:
    """Linearises the motion about an equilibrium with the controls held; the inflow follows at once.

    Returns:
        The matrix of the states u, v, w, p, q, r, roll, pitch, disc back, disc right, bar back, bar right.
    """
    states = ca.SX.sym("states", 12)
    roll, pitch = states[6], states[7]
    held = equilibrium.rotor_state
    flapping = (states[8], states[9], states[10], states[11])
    state = RotorState(*(ca.SX(value) for value in held[:4]), *flapping, ca.SX(held[8]), ca.SX(held[9]))
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
    return jacobian(_flight_states(equilibrium))


def _flight_states(equilibrium: Equilibrium) -> ca.DM:
    body_level = rotation_body_level(ca.DM(equilibrium.roll), ca.DM(equilibrium.pitch))
    velocity = equilibrium.velocity
    return ca.vertcat(
        body_level @ ca.DM([velocity.forward, velocity.side, 0.0]),
        body_level @ ca.DM([0.0, 0.0, velocity.yaw_rate]),
        equilibrium.roll,
        equilibrium.pitch,
        ca.DM(equilibrium.rotor_state[4:8]),
    )
