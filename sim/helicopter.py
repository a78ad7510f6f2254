"""The helicopter as a free body in MuJoCo, moved by the loads of `rotor`; the only file that talks to MuJoCo.

MuJoCo's axes are z-up: its world is north-west-up, its body forward-left-up. Turning half a turn about the
first axis leads from either to the project's axes and back, so vectors change the sign of their last two
components.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, isfinite, pi, remainder, sin

import casadi as ca
import mujoco
import numpy as np

import models
from flight.errors import FlightLostError
from flight.se2 import SE2

from . import rotor
from .bound_function import BoundFunction
from .equilibrium import Equilibrium
from .motion import Controls, Motion, Wind
from .parameters import Parameters
from .rotor import Air, RotorState
from .rotor_step import advance

DEFAULT_STEP = 0.005
# Warm started at every step, this many relaxed iterations follow any gust.
_INFLOW_ITERATIONS = 4
# The skids reach this far below the centre of mass, in m.
_GROUND_HEIGHT = 0.65
_BODY = 1
_REMEMBERED = len(RotorState._fields)


@dataclass(frozen=True, slots=True)
class HelicopterState:
    """All that the helicopter's future depends on, bar wind and commands.

    Attributes:
        position: north, east, down in m.
        quaternion: body to world, scalar first.
        velocity: north, east, down in m/s.
        rates: body rates in rad/s.
        rotor_state: as in `rotor.RotorState`.
        heading: rad, not wrapped.
        pending: servo commands on their way, one for each plant step of the transport delay.
    """

    position: tuple[float, ...]
    quaternion: tuple[float, ...]
    velocity: tuple[float, ...]
    rates: tuple[float, ...]
    rotor_state: tuple[float, ...]
    heading: float
    pending: tuple[tuple[float, ...], ...]


class Helicopter:
    """One helicopter in flight.

    Args:
        parameters: the vehicle; its mass and inertia overrule the shape file's.
        step: plant step in s.
    """

    def __init__(self, parameters: Parameters, *, step: float = DEFAULT_STEP) -> None:
        self.step_length = step
        self._model = load_model(parameters, step)
        self._data = mujoco.MjData(self._model)
        self._warnings = memoryview(self._data.warning.number)
        self._position, self._velocity = memoryview(self._data.qpos), memoryview(self._data.qvel)
        self._steps = 0
        self._heading = 0.0
        self._inputs = np.zeros(10)
        self._rotor_states = (np.zeros(_REMEMBERED), np.zeros(_REMEMBERED))
        self._delay = round(parameters.servos.delay / step)
        self._pending: deque[Controls] = deque()
        self._current = 0
        self._observation = np.zeros(13)
        plant = _plant_function(parameters, step)
        data, states = self._data, self._rotor_states
        # Two states in turn, because input and output must not be the same array.
        self._plants = tuple(
            BoundFunction(
                plant,
                (data.qpos, data.qvel, states[source], self._inputs),
                (data.xfrc_applied[_BODY], states[1 - source]),
            )
            for source in (0, 1)
        )
        self._observe = BoundFunction(_observation_function(), (data.qpos, data.qvel), (self._observation,))

    @property
    def time(self) -> float:
        """Seconds flown since the helicopter was placed."""
        return self._steps * self.step_length

    def place(self, equilibrium: Equilibrium, *, altitude: float, heading: float) -> None:
        """Puts the helicopter in steady flight above the origin."""
        half_roll, half_pitch, half_yaw = equilibrium.roll / 2, equilibrium.pitch / 2, heading / 2
        turn = equilibrium.velocity.yaw_rate
        forward, side = equilibrium.velocity.forward, equilibrium.velocity.side
        self.restore(
            HelicopterState(
                position=(0.0, 0.0, -altitude),
                quaternion=_multiply(
                    _multiply(
                        (cos(half_yaw), 0.0, 0.0, sin(half_yaw)), (cos(half_pitch), 0.0, sin(half_pitch), 0.0)
                    ),
                    (cos(half_roll), sin(half_roll), 0.0, 0.0),
                ),
                velocity=(
                    cos(heading) * forward - sin(heading) * side,
                    sin(heading) * forward + cos(heading) * side,
                    0.0,
                ),
                rates=(
                    -turn * sin(equilibrium.pitch),
                    turn * sin(equilibrium.roll) * cos(equilibrium.pitch),
                    turn * cos(equilibrium.roll) * cos(equilibrium.pitch),
                ),
                rotor_state=equilibrium.rotor_state,
                heading=heading,
                pending=(equilibrium.controls,) * self._delay,
            )
        )

    def restore(self, state: HelicopterState) -> None:
        """Puts the helicopter into a state and starts its clock again."""
        mujoco.mj_resetData(self._model, self._data)
        self._data.qpos[:3] = _flip(state.position)
        self._data.qpos[3:] = (state.quaternion[0], *_flip(state.quaternion[1:]))
        self._data.qvel[:3] = _flip(state.velocity)
        self._data.qvel[3:] = _flip(state.rates)
        self._rotor_states[self._current][:] = state.rotor_state
        self._heading = state.heading
        self._pending = deque(Controls._make(command) for command in state.pending)
        self._steps = 0

    def state(self) -> HelicopterState:
        """Returns the state, to be restored later."""
        position, velocity = self._data.qpos.tolist(), self._data.qvel.tolist()
        return HelicopterState(
            position=_flip(position[:3]),
            quaternion=(position[3], *_flip(position[4:])),
            velocity=_flip(velocity[:3]),
            rates=_flip(velocity[3:]),
            rotor_state=tuple(self._rotor_states[self._current].tolist()),
            heading=self.motion().heading,
            pending=tuple(self._pending),
        )

    def advance(self, controls: Controls, wind: Wind, *, steps: int) -> None:
        """Flies a number of plant steps with servo commands and wind held.

        Raises:
            FlightLostError: the motion diverged or met the ground.
        """
        self._inputs[4:] = wind
        inputs, pending = self._inputs, self._pending
        model, data, step = self._model, self._data, mujoco.mj_step
        position, velocity, held = self._position, self._velocity, None
        for _ in range(steps):
            pending.append(controls)
            command = pending.popleft()
            if command is not held:
                inputs[:4] = held = command
            self._plants[self._current].evaluate()
            self._current = 1 - self._current
            step(model, data)
            self._steps += 1
            height = position[2]
            # MuJoCo warns, and would start again, where these are not finite.
            if not isfinite(height + velocity[0] + velocity[3]):
                raise FlightLostError(self.time, "the motion diverged")
            if height < _GROUND_HEIGHT:
                raise FlightLostError(self.time, "the helicopter met the ground")
        if any(self._warnings):
            raise FlightLostError(self.time, "the motion diverged")

    def servo_positions(self) -> Controls:
        """Returns where the servos are."""
        return Controls._make(self._rotor_states[self._current][:4].tolist())

    def motion(self) -> Motion:
        """Returns the true motion."""
        self._observe.evaluate()
        values = self._observation.tolist()
        self._heading += remainder(values[8] - self._heading, 2.0 * pi)
        values[8] = self._heading
        return Motion._make(values)


def move_in_plane(state: HelicopterState, displacement: SE2) -> HelicopterState:
    """Returns the state after the whole world is moved: `pose_after = displacement @ pose_before`."""
    turn, half = displacement.heading, displacement.heading / 2
    moved = displacement @ SE2(state.position[0], state.position[1], 0.0)
    velocity = SE2(0.0, 0.0, turn) @ SE2(state.velocity[0], state.velocity[1], 0.0)
    return HelicopterState(
        position=(moved.x, moved.y, state.position[2]),
        quaternion=_multiply((cos(half), 0.0, 0.0, sin(half)), state.quaternion),
        velocity=(velocity.x, velocity.y, state.velocity[2]),
        rates=state.rates,
        rotor_state=state.rotor_state,
        heading=state.heading + turn,
        pending=state.pending,
    )


def load_model(parameters: Parameters, step: float) -> mujoco.MjModel:
    """Returns the shape with the parameters' mass, inertia and gravity; step in s."""
    spec = mujoco.MjSpec.from_file(str(models.FOLDER / "gtmax.xml"))
    body, numbers = spec.body("helicopter"), parameters.body
    body.mass = numbers.mass
    # Half a turn about the first axis changes the sign of the product of inertia.
    body.fullinertia = [
        numbers.inertia_xx,
        numbers.inertia_yy,
        numbers.inertia_zz,
        0.0,
        numbers.inertia_xz,
        0.0,
    ]
    spec.option.timestep = step
    spec.option.gravity = [0.0, 0.0, -parameters.environment.gravity]
    return spec.compile()


def _flip(vector: Sequence[float]) -> tuple[float, float, float]:
    """Leads from MuJoCo's axes to the project's, or back."""
    return (float(vector[0]), -float(vector[1]), -float(vector[2]))


def _multiply(a: Sequence[float], b: Sequence[float]) -> tuple[float, float, float, float]:
    """Returns the quaternion that rotates by b first, then by a."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


def _rotation_world_body(quaternion: ca.SX) -> ca.SX:
    """Returns the matrix, body to world in the project's axes, of a quaternion in MuJoCo's."""
    w, x, y, z = quaternion[0], quaternion[1], -quaternion[2], -quaternion[3]
    return ca.vertcat(
        ca.horzcat(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        ca.horzcat(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        ca.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


_FLIP = ca.diag(ca.DM([1.0, -1.0, -1.0]))


def _plant_function(parameters: Parameters, step: float) -> ca.Function:
    """Builds the step of rotors and actuators: the wrench that MuJoCo holds through the coming step."""
    position, velocity = ca.SX.sym("qpos", 7), ca.SX.sym("qvel", 6)
    remembered, inputs = ca.SX.sym("rotor_state", _REMEMBERED), ca.SX.sym("inputs", 10)
    rotation = _rotation_world_body(position[3:7])
    air_velocity = rotation.T @ (_FLIP @ velocity[:3] - inputs[4:7])
    rates = _FLIP @ velocity[3:]
    air_rates = rates + rotation.T @ inputs[7:]
    u, v, w = ca.vertsplit(air_velocity)
    p, q, r = ca.vertsplit(air_rates)
    nearness = rotor.ground_nearness(parameters, position[2])
    air = Air._make((u, v, w, p, q, r, *ca.vertsplit(rates), nearness))
    state = RotorState(*ca.vertsplit(remembered))
    state = advance(parameters, state, air, command=inputs[:4], step=step, iterations=_INFLOW_ITERATIONS)
    load = rotor.loads(parameters, state, air)
    wrench = ca.vertcat(_FLIP @ rotation @ load.force, _FLIP @ rotation @ load.moment)
    return ca.Function("plant", [position, velocity, remembered, inputs], [wrench, ca.vertcat(*state)])


def _observation_function() -> ca.Function:
    """Builds the translation of MuJoCo's state into `Motion`."""
    position, velocity = ca.SX.sym("qpos", 7), ca.SX.sym("qvel", 6)
    rotation = _rotation_world_body(position[3:7])
    roll = ca.atan2(rotation[2, 1], rotation[2, 2])
    pitch = ca.asin(ca.fmax(-1.0, ca.fmin(1.0, -rotation[2, 0])))
    heading = ca.atan2(rotation[1, 0], rotation[0, 0])
    world, rates = _FLIP @ velocity[:3], _FLIP @ velocity[3:]
    forward = ca.cos(heading) * world[0] + ca.sin(heading) * world[1]
    side = -ca.sin(heading) * world[0] + ca.cos(heading) * world[1]
    yaw_rate = (rates[1] * ca.sin(roll) + rates[2] * ca.cos(roll)) / ca.cos(pitch)
    motion = ca.vertcat(_FLIP @ position[:3], forward, side, world[2], roll, pitch, heading, rates, yaw_rate)
    return ca.Function("observe", [position, velocity], [motion])
