"""Flight controller: servo commands from estimate and reference."""

from functools import cache
from itertools import chain
from math import cos, sin

import casadi as ca
import numpy as np

from flight.se2 import Twist
from sim.loop.backend import Backend
from sim.loop.bound_function import Recursion
from sim.loop.motion import Controls, Motion, Reference, ReferenceChannel
from sim.loop.signals import Signals
from sim.vehicle.equilibrium import find_equilibrium
from sim.vehicle.linearisation import linearise
from sim.vehicle.parameters import Parameters

from . import adaptive_element as element
from .control_law import ControlLaw
from .control_signals import STATE_SIZES, InversionModel
from .gains import Gains
from .trim_table import TrimPoint, trim_table

_SIZE = sum(STATE_SIZES)
_INNER, _OUTER = _SIZE - element.INNER_WEIGHTS - element.OUTER_WEIGHTS, _SIZE - element.OUTER_WEIGHTS
_ROWS = element.HIDDEN + 1
_CHANNEL = len(ReferenceChannel._fields)


class Controller:
    """Controller of velocity, yaw rate and height.

    Args:
        parameters: vehicle that the controller is designed for.
        height: height above ground to hold, m.
        step: control period, s.
        gains: feedback and learning gains.
        adaptive: whether the adaptive element learns; otherwise its output is 0.
        signals: inputs estimate and reference, output controls; its own if None.
        backend: numeric back-end.

    Attributes:
        function: (estimate, reference, learning, state) -> (controls, state), for margins.
    """

    def __init__(
        self,
        parameters: Parameters,
        *,
        height: float,
        step: float,
        gains: Gains | None = None,
        adaptive: bool = True,
        signals: Signals | None = None,
        backend: Backend = Backend.INTERPRETED,
    ) -> None:
        self.gains = gains or Gains()
        self._trims = trim_table(parameters)
        self.function = _control_function(parameters, self.gains, height, step)
        self.signals = signals = signals or Signals()
        self._learning, self._state = np.array([1.0 if adaptive else 0.0]), np.zeros(_SIZE)
        self._law = Recursion(
            _with_trims(self.function, self._trims.function),
            (signals.estimate, signals.reference, self._learning, self._state),
            (signals.controls,),
            backend=backend,
        )
        self._begun = False

    @property
    def state(self) -> np.ndarray:
        """Controller state, laid out as `control_signals.ControllerState`."""
        return self._state.copy()

    def restore(self, state: np.ndarray) -> None:
        """Sets the controller state."""
        self._state[:] = state
        self._begun = True

    def rotate_world(self, angle: float) -> None:
        """Applies a rotation of the world about the vertical, in rad."""
        outer = self._state[_OUTER:].reshape(element.OUTPUTS, _ROWS)
        north, east = outer[0].copy(), outer[1].copy()
        outer[0] = cos(angle) * north - sin(angle) * east
        outer[1] = sin(angle) * north + cos(angle) * east

    def run(self) -> None:
        """Computes the controls of the next control period."""
        if not self._begun:
            forward, _, yaw_rate = self.signals.reference[::_CHANNEL].tolist()
            self.restore(initial_controller_state(self._trims.at(forward, yaw_rate)))
        self._law.step()

    def step(self, estimate: Motion, reference: Reference) -> Controls:
        """Returns the servo commands for the next control period."""
        self.signals.estimate[:], self.signals.reference[:] = estimate, [*chain(*reference)]
        self.run()
        return Controls._make(self.signals.controls.tolist())


def initial_controller_state(trim: TrimPoint) -> np.ndarray:
    """Returns the state of a controller settled in a trim."""
    parts = (
        *(trim.roll, 0.0, trim.pitch, 0.0),
        *(0.0, 0.0, 0.0, 0.0),
        trim[2:],
        element.initial_inner_weights(),
        np.zeros(element.OUTER_WEIGHTS),
    )
    return np.concatenate([np.atleast_1d(part) for part in parts])


@cache
def inversion_model(parameters: Parameters) -> InversionModel:
    """Returns the inversion model: the vehicle linearised in hover."""
    hover = find_equilibrium(parameters, Twist(0.0, 0.0, 0.0))
    state = linearise(parameters, hover).state
    return InversionModel(
        roll=float(state[3, 13]),
        pitch=float(state[4, 12]),
        yaw=float(state[5, 11]),
        yaw_from_collective=float(state[5, 10]),
        lift=-float(state[2, 10]),
    )


@cache
def _with_trims(law: ca.Function, trims: ca.Function) -> ca.Function:
    """Builds (estimate, reference, learning, state) -> (controls, state) with trim table."""
    estimate, reference, learning, state = (
        ca.MX.sym(name, size)
        for name, size in zip(
            ("estimate", "reference", "learning", "memory"),
            (len(Motion._fields), len(Reference._fields) * _CHANNEL, 1, _SIZE),
            strict=True,
        )
    )
    trim = trims(reference[0], reference[2 * _CHANNEL])
    controls, after = law(estimate, ca.vertcat(reference, trim), learning, state)
    return ca.Function("control", [estimate, reference, learning, state], [controls, after])


@cache
def _control_function(parameters: Parameters, gains: Gains, height: float, step: float) -> ca.Function:
    model = inversion_model(parameters)
    return ControlLaw(parameters, model, gains=gains, height=height, step=step).function()
