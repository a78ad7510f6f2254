"""Table of the least expected times to a goal."""

import ctypes
from dataclasses import dataclass, field
from hashlib import sha256

import numpy as np
from jaxtyping import Float, Int

from .build import load_recourse
from .problem import ShortestPathProblem
from .structures import Structures, structures

NO_SHIFT = (0.0, 0.0, 0.0, 1.0, 0.0)
"""Shift of an action's outcomes that leaves them where they are."""


@dataclass(frozen=True, slots=True, eq=False)
class CostTable:
    """Least expected times of a problem, looked up anywhere.

    Attributes:
        problem: the statement.
        values: seconds at every node, below 0 inside the tolerance.
        gap: seconds between the bounds of the largest value.
        most_actions: of any trim.
        digest: SHA-256 of the values.
    """

    problem: ShortestPathProblem
    values: Float[np.ndarray, "trims levels side side"]
    gap: float
    _data: Structures = field(init=False, repr=False)
    most_actions: int = field(init=False)
    digest: str = field(init=False)

    def __post_init__(self) -> None:
        """Points the C structures to the values; works out their digest."""
        digest = sha256(np.ascontiguousarray(self.values).tobytes()).hexdigest()
        object.__setattr__(self, "digest", digest)
        object.__setattr__(self, "_data", structures(self.problem, self.values))
        object.__setattr__(self, "most_actions", int(np.diff(self.problem.first).max()))

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
        self,
        trims: Int[np.ndarray, "n"],
        goals: Float[np.ndarray, "n 2"],
        shifts: Float[np.ndarray, "n actions 5"] | None = None,
    ) -> Float[np.ndarray, "n actions"]:
        """Returns the expected seconds to the goal by each action.

        Rows of trims with fewer actions end in infinity.

        Args:
            trims: places of the trims.
            goals: forward and side of the goal as seen from the vehicle, in metres.
            shifts: of the outcomes of each action: seconds, metres forward, metres to the right, cosine and
                sine of the turn; none by default.
        """
        trims, goals = np.ascontiguousarray(trims, dtype=np.intc), np.ascontiguousarray(goals, dtype=float)
        cost = np.empty((len(trims), self.most_actions))
        moved = np.broadcast_to(NO_SHIFT, (*cost.shape, 5)) if shifts is None else shifts
        moved = np.ascontiguousarray(moved, dtype=float)
        load_recourse().action_costs(
            ctypes.byref(self._data.table),
            ctypes.byref(self._data.actions),
            len(trims),
            ctypes.c_void_p(trims.ctypes.data),
            ctypes.c_void_p(goals.ctypes.data),
            ctypes.c_void_p(moved.ctypes.data),
            self.most_actions,
            ctypes.c_void_p(cost.ctypes.data),
        )
        return cost
