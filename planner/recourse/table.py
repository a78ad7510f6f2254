"""Table of the least expected times to a goal, and costs of the actions."""

import ctypes
from dataclasses import dataclass, field
from hashlib import sha256

import numpy as np
from jaxtyping import Float, Int

from .build import load_recourse
from .problem import ShortestPathProblem
from .structures import Structures, structures


@dataclass(frozen=True, slots=True, eq=False)
class CostTable:
    """Least expected times of a problem, looked up anywhere.

    Attributes:
        problem: the statement.
        values: seconds at every node, below 0 inside the tolerance.
        gap: seconds between the bounds of the largest value.
    """

    problem: ShortestPathProblem
    values: Float[np.ndarray, "trims levels side side"]
    gap: float
    _data: Structures = field(init=False, repr=False)
    _most: int = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Points the C structures to the values."""
        object.__setattr__(self, "_data", structures(self.problem, self.values))
        object.__setattr__(self, "_most", int(np.diff(self.problem.first).max()))

    @property
    def digest(self) -> str:
        """SHA-256 of the values."""
        return sha256(np.ascontiguousarray(self.values).tobytes()).hexdigest()

    def times(self, trims: Int[np.ndarray, "n"], goals: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n"]:
        """Returns the least expected seconds.

        Args:
            trims: places of the trims.
            goals: forward and side of the goal as seen from the vehicle, in metres.
        """
        trims, goals = np.ascontiguousarray(trims, dtype=np.intc), np.ascontiguousarray(goals, dtype=float)
        cost = np.empty(len(trims))
        load_recourse().values(
            ctypes.byref(self._data.table),
            len(trims),
            ctypes.c_void_p(trims.ctypes.data),
            ctypes.c_void_p(goals.ctypes.data),
            ctypes.c_void_p(cost.ctypes.data),
        )
        return cost

    def action_costs(
        self, trims: Int[np.ndarray, "n"], goals: Float[np.ndarray, "n 2"]
    ) -> Float[np.ndarray, "n actions"]:
        """Returns the expected seconds of each action of a trim and what follows.

        Rows of trims with fewer actions end in infinity.

        Args:
            trims: places of the trims.
            goals: forward and side of the goal as seen from the vehicle, in metres.
        """
        trims, goals = np.ascontiguousarray(trims, dtype=np.intc), np.ascontiguousarray(goals, dtype=float)
        cost = np.empty((len(trims), self._most))
        load_recourse().action_costs(
            ctypes.byref(self._data.table),
            ctypes.byref(self._data.actions),
            len(trims),
            ctypes.c_void_p(trims.ctypes.data),
            ctypes.c_void_p(goals.ctypes.data),
            self._most,
            ctypes.c_void_p(cost.ctypes.data),
        )
        return cost
