"""Helicopter as a free body in MuJoCo under rotor loads."""

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from itertools import chain
from math import cos, isfinite, sin

import casadi as ca
import mujoco
import numpy as np

from flight.errors import FlightLostError
from flight.se2 import SE2
from sim.loop.backend import Backend
from sim.loop.bound_function import Recursion
from sim.loop.motion import Controls, Motion, Wind
from sim.loop.signals import Signals

from .equilibrium import Equilibrium
from .mujoco_model import shared_model
from .parameters import Parameters
from .plant import (
    ROTOR_STATES,
    delay_steps,
    drawn_plant_function,
    observation_function,
    plant_function,
)
from .rotor_step import AllServoDynamics, nominal_servo_dynamics
from .uncertainty import DELAY, VARIED, value_of, with_values

DEFAULT_STEP = 0.005
# Height of the centre of mass above the skids, m.
_GROUND_HEIGHT = 0.65
_BODY = 1
# MuJoCo's warnings about values not finite or too large.
_DIVERGED = slice(mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQACC + 1)


@dataclass(frozen=True, slots=True)
class HelicopterState:
    """Complete state of the helicopter except wind and commands.

    Attributes:
        position: north, east, down in m.
        quaternion: body to world, scalar first.
        velocity: north, east, down in m/s.
        rates: body rates in rad/s.
        rotor_state: as in `rotor.RotorState`.
        heading: rad, not wrapped.
        pending: delayed servo commands, one for each plant step of the transport delay.
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
        parameters: vehicle; its mass and inertia override the shape file's.
        step: plant step, s.
        signals: inputs controls and wind, outputs truth and servos; its own if None.
        backend: numeric back-end.
        nominal: vehicle around which this one was drawn; None for a vehicle of its own kind.
    """

    def __init__(
        self,
        parameters: Parameters,
        *,
        step: float = DEFAULT_STEP,
        signals: Signals | None = None,
        backend: Backend = Backend.INTERPRETED,
        nominal: Parameters | None = None,
    ) -> None:
        self.step_length = step
        self.signals = signals = signals or Signals()
        self._model = shared_model(parameters, step)
        self._data = data = mujoco.MjData(self._model)
        self._height, self._velocity = memoryview(data.qpos)[2:3], memoryview(data.qvel)
        self._warnings = memoryview(data.warning.number)[_DIVERGED]
        self._steps = 0
        self._delay = delay_steps(parameters, step)
        # The rotor state, then the delayed servo commands.
        self._memory = np.zeros(ROTOR_STATES + 4 * self._delay)
        self._heading = np.zeros(1)
        self.lacking = np.zeros(4)
        """Servo rate lost to faults in the last plant step, rad/s."""
        self._sound, self._backend = parameters, backend
        self._plant = self._sound_plant = self._bind_sound(nominal or parameters)
        self._observe = Recursion(
            observation_function(),
            (data.qpos, data.qvel, self._heading),
            (signals.truth,),
            backend=backend,
        )

    def _bind_sound(self, nominal: Parameters) -> Recursion:
        """Binds the plant without faults; drawn vehicles share a function."""
        sound, data, signals = self._sound, self._data, self.signals
        if sound == nominal:
            return self._bind(plant_function(sound, self.step_length), self._backend)
        delay = self._delay * self.step_length
        shared = drawn_plant_function(with_values(nominal, {DELAY: delay}), self.step_length)
        # Bound by its memory, so kept alive here.
        self._values = values = np.array([value_of(sound, name) for name in VARIED])
        return Recursion(
            shared,
            (data.qpos, data.qvel, signals.controls, signals.wind, values, self._memory),
            (data.xfrc_applied[_BODY], signals.servos),
            backend=self._backend,
        )

    def _bind(self, plant: ca.Function, backend: Backend, *results: np.ndarray) -> Recursion:
        data, signals = self._data, self.signals
        return Recursion(
            plant,
            (data.qpos, data.qvel, signals.controls, signals.wind, self._memory),
            (data.xfrc_applied[_BODY], signals.servos, *results),
            backend=backend,
        )

    def refit(self, parameters: Parameters, servo_dynamics: AllServoDynamics) -> None:
        """Continues from the same state with other parameters and servos.

        The transport delay is unchanged.
        """
        sound = parameters == self._sound and servo_dynamics == nominal_servo_dynamics(parameters.servos)
        self.lacking[:] = 0.0
        self._plant = (
            self._sound_plant
            if sound
            # Same bits as machine code, without seconds of compilation.
            else self._bind(
                plant_function(parameters, self.step_length, servo_dynamics),
                Backend.INTERPRETED,
                self.lacking,
            )
        )
        # Other flights share the model.
        self._model = copy(self._model)
        self._model.body_mass[_BODY] = parameters.body.mass
        # Derived constants, computed on separate data, because the call changes the state.
        mujoco.mj_setConst(self._model, mujoco.MjData(self._model))

    @property
    def time(self) -> float:
        """Time flown since placement, seconds."""
        return self._steps * self.step_length

    def place(self, equilibrium: Equilibrium, *, altitude: float, heading: float) -> None:
        """Places the helicopter in steady flight above the origin."""
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
        """Sets the state and resets the clock."""
        mujoco.mj_resetData(self._model, self._data)
        self._data.qpos[:3] = _flip(state.position)
        self._data.qpos[3:] = (state.quaternion[0], *_flip(state.quaternion[1:]))
        self._data.qvel[:3] = _flip(state.velocity)
        self._data.qvel[3:] = _flip(state.rates)
        self._memory[:] = (*state.rotor_state, *chain(*state.pending))
        self._heading[0] = state.heading
        self._steps = 0
        self.signals.servos[:] = state.rotor_state[:4]
        self._observe.step()

    def state(self) -> HelicopterState:
        """Returns the state for a later `restore`."""
        position, velocity = self._data.qpos.tolist(), self._data.qvel.tolist()
        pending = self._memory[ROTOR_STATES:].reshape(-1, 4).tolist()
        return HelicopterState(
            position=_flip(position[:3]),
            quaternion=(position[3], *_flip(position[4:])),
            velocity=_flip(velocity[:3]),
            rates=_flip(velocity[3:]),
            rotor_state=tuple(self._memory[:ROTOR_STATES].tolist()),
            heading=float(self._heading[0]),
            pending=tuple(tuple(command) for command in pending),
        )

    def run(self, steps: int) -> None:
        """Flies plant steps with the signals' controls and wind held.

        Raises:
            FlightLostError: the motion diverged or the vehicle hit the ground.
        """
        model, data, height, velocity = self._model, self._data, self._height, self._velocity
        plant, mj_step, why = self._plant.step, mujoco.mj_step, ""
        for _ in range(steps):
            plant()
            mj_step(model, data)
            self._steps += 1
            # MuJoCo would only warn and reset if these are not finite.
            if not isfinite(height[0] + velocity[0] + velocity[3]):
                why = "the motion diverged"
                break
            if height[0] < _GROUND_HEIGHT:
                why = "the helicopter met the ground"
                break
        self._observe.step()
        if why or any(self._warnings):
            raise FlightLostError(self.time, why or "the motion diverged")

    def advance(self, controls: Controls, wind: Wind, *, steps: int) -> None:
        """Flies plant steps with servo commands and wind held.

        Raises:
            FlightLostError: the motion diverged or the vehicle hit the ground.
        """
        self.signals.controls[:], self.signals.wind[:] = controls, wind
        self.run(steps)

    def servo_positions(self) -> Controls:
        """Returns the servo positions."""
        return Controls._make(self.signals.servos.tolist())

    def motion(self) -> Motion:
        """Returns the true motion."""
        return Motion._make(self.signals.truth.tolist())


def move_in_plane(state: HelicopterState, displacement: SE2) -> HelicopterState:
    """Returns the state after a displacement of the world.

    `pose_after = displacement @ pose_before`.
    """
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


def _flip(vector: Sequence[float]) -> tuple[float, float, float]:
    """Converts a vector between MuJoCo's and the project's axes."""
    return (float(vector[0]), -float(vector[1]), -float(vector[2]))


def _multiply(a: Sequence[float], b: Sequence[float]) -> tuple[float, float, float, float]:
    """Returns the quaternion of rotation b followed by a."""
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )
