"""Trim: controls and attitude of steady level flight in still air."""

from dataclasses import dataclass, replace
from functools import cache
from math import cos

import casadi as ca

from flight.errors import FlightError
from flight.se2 import Twist
from sim.loop.motion import Controls

from . import rotor
from .parameters import Parameters
from .rotor import Air, RotorState

# Largest residual of accelerations (m/s2, rad/s2), angles and inflow (m/s) at equilibrium.
RESIDUAL = 1e-9
# Initial guess in hover: roll, pitch, then the rotor state.
_HOVER_GUESS = (0.05, 0.0, 0.0, 0.0, 0.16, 0.1, 0.0, 0.0, 0.0, 0.0, 6.4, 5.0)
# Largest continuation step in forward and side speed (m/s) and yaw rate (rad/s).
_STRIDE = (2.5, 2.5, 0.15)


class NoEquilibriumError(FlightError):
    """Velocity without a steady flight, or none found."""

    def __init__(self, velocity: Twist, reason: str) -> None:
        super().__init__(
            f"no equilibrium at forward {velocity.forward:g} m/s, side {velocity.side:g} m/s, "
            f"yaw rate {velocity.yaw_rate:g} rad/s: {reason}"
        )


@dataclass(frozen=True, slots=True)
class Equilibrium:
    """Steady flight state.

    Attributes:
        velocity: trim velocity in the heading frame.
        roll: rad.
        pitch: rad.
        lateral: cyclic pitch in rad; positive tilts the disc to the right.
        longitudinal: cyclic pitch in rad; positive tilts the disc back.
        collective: rad.
        pedal: commanded tail rotor pitch in rad, before subtraction of the gyro's part.
        rotor_state: entries of `rotor.RotorState`.
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

    @property
    def controls(self) -> Controls:
        """Servo commands of the equilibrium."""
        return Controls(self.lateral, self.longitudinal, self.collective, self.pedal)


class EquilibriumFinder:
    """Solver for equilibria of one vehicle, by continuation from hover.

    Args:
        parameters: vehicle.
        height: height above ground in m; None for out of ground effect.
    """

    def __init__(self, parameters: Parameters, *, height: float | None = None) -> None:
        self._servos, self._gyro_gain = parameters.servos, parameters.tail_rotor.gyro_gain
        unknowns, velocity = ca.SX.sym("unknowns", 12), ca.SX.sym("velocity", 3)
        residual, power = trim_residual(parameters, unknowns, velocity, height=height)
        self._balance = ca.Function("balance", [unknowns, velocity], [residual, power])
        problem = {"x": unknowns, "p": velocity, "g": residual}
        self._solve = ca.rootfinder("equilibrium", "newton", problem, {"error_on_fail": False})

    def find(self, velocity: Twist) -> Equilibrium:
        """Returns the equilibrium at a heading-frame velocity.

        Raises:
            NoEquilibriumError: the residual is too large, or a servo exceeds its travel.
        """
        wanted = (velocity.forward, velocity.side, velocity.yaw_rate)
        strides = 1 + int(max(abs(part) / stride for part, stride in zip(wanted, _STRIDE, strict=True)))
        unknowns = ca.DM(_HOVER_GUESS)
        for stride in range(strides + 1):
            unknowns = self._solve(unknowns, ca.DM(wanted) * (stride / strides))
        roll, pitch, *state = (float(value) for value in unknowns.elements())
        gyro = self._gyro_gain * velocity.yaw_rate * cos(roll) * cos(pitch)
        lateral, longitudinal, collective, pedal = state[:4]
        found = Equilibrium(
            velocity, roll, pitch, lateral, longitudinal, collective, pedal + gyro, (*state, gyro), 0.0
        )
        worst, power = self.residual(found)
        if not worst <= RESIDUAL:
            raise NoEquilibriumError(velocity, f"residual {worst:.1e}, expected at most {RESIDUAL:.0e}")
        self._check_servo_travel(found)
        return replace(found, power=power)

    def _check_servo_travel(self, found: Equilibrium) -> None:
        servos = self._servos
        cyclic = servos.cyclic_limit
        for name, value, low, high in (
            ("lateral cyclic", found.lateral, -cyclic, cyclic),
            ("longitudinal cyclic", found.longitudinal, -cyclic, cyclic),
            ("collective", found.collective, servos.collective_low, servos.collective_high),
            ("pedal", found.rotor_state[3], servos.pedal_low, servos.pedal_high),
        ):
            if not low <= value <= high:
                reason = f"{name} pitch {value:.3f} rad is beyond its travel, {low:g} to {high:g} rad"
                raise NoEquilibriumError(found.velocity, reason)

    def residual(self, equilibrium: Equilibrium) -> tuple[float, float]:
        """Returns the largest residual of a state, and its power in W."""
        velocity = equilibrium.velocity
        unknowns = ca.DM([equilibrium.roll, equilibrium.pitch, *equilibrium.rotor_state[:10]])
        wanted = ca.DM([velocity.forward, velocity.side, velocity.yaw_rate])
        residual, power = self._balance(unknowns, wanted)
        return float(ca.norm_inf(residual)), float(power)


@cache
def find_equilibrium(parameters: Parameters, velocity: Twist) -> Equilibrium:
    """Returns the equilibrium of a vehicle, cached.

    Raises:
        NoEquilibriumError: it was not found.
    """
    return EquilibriumFinder(parameters).find(velocity)


def trim_residual(
    parameters: Parameters, unknowns: ca.SX, velocity: ca.SX, *, height: float | None = None
) -> tuple[ca.SX, ca.SX]:
    """States the balance of steady level flight in still air.

    Args:
        parameters: vehicle.
        unknowns: roll, pitch and the rotor state without the gyro, shape (12, 1).
        velocity: forward, side (m/s) and yaw rate (rad/s) in the heading frame, shape (3, 1).
        height: height above ground in m; None for out of ground effect.

    Returns:
        Residual, shape (12, 1): accelerations, angular accelerations, flapping and inflow; and the power.
    """
    roll, pitch = unknowns[0], unknowns[1]
    state = RotorState._make([*ca.vertsplit(unknowns[2:]), ca.SX(0)])
    body_level = rotation_body_level(roll, pitch)
    ground_effect = 0.0 if height is None else rotor.ground_effect_factor(parameters, ca.SX(height))
    velocity_body = body_level @ ca.vertcat(velocity[0], velocity[1], 0)
    rates = body_level @ ca.vertcat(0, 0, velocity[2])
    air = rotor.still_air(velocity_body, rates, ground_effect=ground_effect)
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
    """Returns linear and angular accelerations in body axes, in still air.

    Args:
        parameters: vehicle.
        state: rotor state.
        air: motion through the air, in still air that over the ground.
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
    """Returns the matrix from the level heading frame to body axes."""
    cr, sr, cp, sp = ca.cos(roll), ca.sin(roll), ca.cos(pitch), ca.sin(pitch)
    return ca.vertcat(
        ca.horzcat(cp, 0, -sp),
        ca.horzcat(sr * sp, cr, sr * cp),
        ca.horzcat(cr * sp, -sr, cr * cp),
    )
