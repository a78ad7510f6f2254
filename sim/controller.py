"""The flight controller: it turns an estimate and a reference into servo commands, period by period."""

from functools import cache
from math import cos, sin

import casadi as ca
import numpy as np

from flight.se2 import Twist

from . import adaptive_element as element
from .bound_function import BoundFunction
from .control_law import ControlLaw
from .control_words import MEMORY_SIZES, InversionModel, Wanted
from .equilibrium import EquilibriumFinder
from .gains import Gains
from .linearisation import linearise
from .maneuver_generator import Reference
from .motion import Controls, Motion
from .parameters import Parameters
from .trim_table import TrimPoint, trim_table

_SIZE = sum(MEMORY_SIZES)
_INNER, _OUTER = _SIZE - element.INNER_WEIGHTS - element.OUTER_WEIGHTS, _SIZE - element.OUTER_WEIGHTS
_ROWS = element.HIDDEN + 1


class Controller:
    """Follows a reference at a height, from an estimate alone.

    Args:
        parameters: the vehicle as the controller takes it to be.
        height: above ground, m.
        step: control period in s.
        gains: all feedback and learning gains.
        adaptive: whether the adaptive element learns; its output stays 0 where not.
    """

    def __init__(
        self,
        parameters: Parameters,
        *,
        height: float,
        step: float,
        gains: Gains | None = None,
        adaptive: bool = True,
    ) -> None:
        self.gains = gains or Gains()
        self._trims = trim_table(parameters)
        self.function = _control_function(parameters, self.gains, height, step)
        self._estimate, self._wanted = np.zeros(len(Motion._fields)), np.zeros(len(Wanted._fields))
        self._learning, self._controls = np.array([1.0 if adaptive else 0.0]), np.zeros(4)
        self._memories = (np.zeros(_SIZE), np.zeros(_SIZE))
        self._current, self._begun = 0, False
        inputs = (self._estimate, self._wanted, self._learning)
        memories = self._memories
        # Two memories in turn, because input and output must not be the same array.
        self._laws = tuple(
            BoundFunction(self.function, (*inputs, memories[source]), (self._controls, memories[1 - source]))
            for source in (0, 1)
        )

    @property
    def memory(self) -> np.ndarray:
        """What is remembered now, laid out as in `control_law.Memory`."""
        return self._memories[self._current].copy()

    def restore(self, memory: np.ndarray) -> None:
        """Goes on from a memory."""
        self._memories[self._current][:] = memory
        self._begun = True

    def turn(self, angle: float) -> None:
        """Follows a turn of the whole world about the vertical, in rad."""
        outer = self._memories[self._current][_OUTER:].reshape(element.OUTPUTS, _ROWS)
        north, east = outer[0].copy(), outer[1].copy()
        outer[0] = cos(angle) * north - sin(angle) * east
        outer[1] = sin(angle) * north + cos(angle) * east

    def step(self, estimate: Motion, reference: Reference) -> Controls:
        """Returns the servo commands for the next control period."""
        forward, side, yaw = reference
        trim = self._trims.at(forward.value, yaw.value)
        if not self._begun:
            self.restore(first_memory(trim))
        self._estimate[:] = estimate
        self._wanted[:] = (*forward, *side, *yaw, *trim)
        self._laws[self._current].evaluate()
        self._current = 1 - self._current
        return Controls._make(self._controls.tolist())


def first_memory(trim: TrimPoint) -> np.ndarray:
    """Returns the memory of a controller that has always held a trim."""
    parts = (
        *(trim.roll, 0.0, trim.pitch, 0.0),
        *(0.0, 0.0, 0.0),
        trim[2:],
        element.first_inner_weights(),
        np.zeros(element.OUTER_WEIGHTS),
    )
    return np.concatenate([np.atleast_1d(part) for part in parts])


@cache
def inversion_model(parameters: Parameters) -> InversionModel:
    """Returns the model that the controller inverts: the vehicle linearised in hover."""
    hover = EquilibriumFinder(parameters).find(Twist(0.0, 0.0, 0.0))
    state = linearise(parameters, hover).state
    return InversionModel(
        roll=float(state[3, 13]),
        pitch=float(state[4, 12]),
        yaw=float(state[5, 11]),
        yaw_from_collective=float(state[5, 10]),
        lift=-float(state[2, 10]),
    )


@cache
def _control_function(parameters: Parameters, gains: Gains, height: float, step: float) -> ca.Function:
    model = inversion_model(parameters)
    return ControlLaw(parameters, model, gains=gains, height=height, step=step).function()
