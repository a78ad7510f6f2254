"""Plant functions between MuJoCo's state and the helicopter's loads.

MuJoCo's axes are z-up: its world is north-west-up, its body forward-left-up. A half turn about the first axis
converts either to the project's axes and back, so the last two components of vectors change sign.
"""

from functools import cache, lru_cache
from math import pi

import casadi as ca

from . import rotor
from .parameters import Parameters
from .rotor import Air, RotorState
from .rotor_step import AllServoDynamics, advance, follow_commands, nominal_servo_dynamics
from .uncertainty import VARIED, with_values

ROTOR_STATES = len(RotorState._fields)
# Relaxed iterations a step, warm started; enough to follow any gust.
_INFLOW_ITERATIONS = 4
_FLIP = ca.diag(ca.DM([1.0, -1.0, -1.0]))


def delay_steps(parameters: Parameters, step: float) -> int:
    """Returns the transport delay of the servo commands in plant steps."""
    return round(parameters.servos.delay / step)


# Faults of drawn vehicles make a function each.
@lru_cache(maxsize=64)
def plant_function(
    parameters: Parameters, step: float, servo_dynamics: AllServoDynamics | None = None
) -> ca.Function:
    """Builds the plant step: loads of rotors and actuators.

    Args:
        parameters: vehicle.
        step: plant step, s.
        servo_dynamics: rates and bandwidths of the servos; nominal ones if None.

    Returns:
        (qpos, qvel, controls, wind, memory) -> (wrench, servo positions, memory). MuJoCo holds the wrench
        through the coming step. The memory is the rotor state and the delayed servo commands, oldest first.
        With `servo_dynamics` also, before the memory, the servo rates lost against nominal servos, rad/s.
    """
    inputs = _plant_inputs(parameters, step)
    results = _step_plant(parameters, step, servo_dynamics, inputs)
    return ca.Function("plant", inputs, ca.cse(results))


@cache
def drawn_plant_function(parameters: Parameters, step: float) -> ca.Function:
    """Builds the plant step of every vehicle with one transport delay.

    One function for all of them, so that no flight of a drawn vehicle waits for a compiler.

    Args:
        parameters: vehicle whose delay and unvaried parameters hold.
        step: plant step, s.

    Returns:
        (qpos, qvel, controls, wind, values of `uncertainty.VARIED`, memory) -> as `plant_function`.
    """
    *inputs, memory = _plant_inputs(parameters, step)
    values = ca.SX.sym("values", len(VARIED))
    varied = with_values(parameters, dict(zip(VARIED, ca.vertsplit(values), strict=True)))
    results = _step_plant(varied, step, None, [*inputs, memory])
    return ca.Function("drawn_plant", [*inputs, values, memory], ca.cse(results))


def _plant_inputs(parameters: Parameters, step: float) -> list[ca.SX]:
    names = (("qpos", 7), ("qvel", 6), ("controls", 4), ("wind", 6))
    memory = ca.SX.sym("memory", ROTOR_STATES + 4 * delay_steps(parameters, step))
    return [*(ca.SX.sym(name, size) for name, size in names), memory]


def _step_plant(
    parameters: Parameters,
    step: float,
    servo_dynamics: AllServoDynamics | None,
    inputs: list[ca.SX],
) -> list[ca.SX]:
    """Returns wrench, servo positions, rates lost and memory."""
    position, velocity, controls, wind, memory = inputs
    rotation = _rotation_world_body(position[3:7])
    air_velocity = rotation.T @ (_FLIP @ velocity[:3] - wind[:3])
    rates = _FLIP @ velocity[3:]
    air_rates = rates + rotation.T @ wind[3:]
    u, v, w = ca.vertsplit(air_velocity)
    p, q, r = ca.vertsplit(air_rates)
    ground_effect = rotor.ground_effect_factor(parameters, position[2])
    air = Air._make((u, v, w, p, q, r, *ca.vertsplit(rates), ground_effect))
    before = RotorState(*ca.vertsplit(memory[:ROTOR_STATES]))
    delayed = ca.vertcat(memory[ROTOR_STATES:], controls)
    command, servos = delayed[:4], parameters.servos
    state = advance(
        parameters,
        before,
        air,
        command=command,
        step=step,
        iterations=_INFLOW_ITERATIONS,
        servo_dynamics=servo_dynamics,
    )
    load = rotor.loads(parameters, state, air)
    wrench = ca.vertcat(_FLIP @ rotation @ load.force, _FLIP @ rotation @ load.moment)
    after = ca.vertcat(*state, delayed[4:])
    results = [wrench, after[:4], after]
    if servo_dynamics is not None:
        nominal = follow_commands(
            servos, before, command, step=step, servo_dynamics=nominal_servo_dynamics(servos)
        )
        results.insert(2, (ca.vertcat(*nominal[:4]) - after[:4]) / step)
    return results


@cache
def observation_function() -> ca.Function:
    """Builds `Motion` from MuJoCo's state.

    (qpos, qvel, heading) -> (motion, heading); the heading is unwrapped from the previous one.
    """
    position, velocity, before = ca.SX.sym("qpos", 7), ca.SX.sym("qvel", 6), ca.SX.sym("heading")
    rotation = _rotation_world_body(position[3:7])
    roll = ca.atan2(rotation[2, 1], rotation[2, 2])
    pitch = ca.asin(ca.fmax(-1.0, ca.fmin(1.0, -rotation[2, 0])))
    heading = ca.atan2(rotation[1, 0], rotation[0, 0])
    world, rates = _FLIP @ velocity[:3], _FLIP @ velocity[3:]
    forward = ca.cos(heading) * world[0] + ca.sin(heading) * world[1]
    side = -ca.sin(heading) * world[0] + ca.cos(heading) * world[1]
    yaw_rate = (rates[1] * ca.sin(roll) + rates[2] * ca.cos(roll)) / ca.cos(pitch)
    unwrapped = before + ca.remainder(heading - before, 2.0 * pi)
    place = _FLIP @ position[:3]
    motion = ca.vertcat(place, forward, side, world[2], roll, pitch, unwrapped, rates, yaw_rate)
    return ca.Function("observe", [position, velocity, before], [motion, unwrapped])


def _rotation_world_body(quaternion: ca.SX) -> ca.SX:
    """Returns the body-to-world matrix of a MuJoCo quaternion."""
    w, x, y, z = quaternion[0], quaternion[1], -quaternion[2], -quaternion[3]
    return ca.vertcat(
        ca.horzcat(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        ca.horzcat(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        ca.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )
