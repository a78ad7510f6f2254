"""A library at some uncertainty levels, as arrays for the kernel."""

import ctypes
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float, Int

from flight.automaton.library import Library


class CAutomaton(ctypes.Structure):
    """`Automaton` of automaton.c."""

    _fields_ = (
        *(
            (name, ctypes.c_void_p)
            for name in (
                "first",
                "to",
                "rate",
                "speed",
                "turn",
                "duration",
                "size",
                "velocity",
                "displacement",
            )
        ),
        ("trims", ctypes.c_int),
        ("levels", ctypes.c_int),
    )


@dataclass(frozen=True, slots=True, eq=False)
class Automaton:
    """Trims and maneuvers by index; maneuvers grouped by entry trim.

    Attributes:
        ids: of the trims.
        first: the first maneuver that leaves each trim, and one past the last of all.
        to: place of the trim that each maneuver leads to.
        velocity: forward + i side in metres per second.
        rate: yaw rates in radians per second.
        displacement: in the body frame at entry, metres.
        turn: heading changes in radians.
        duration: seconds.
    """

    ids: Int[np.ndarray, "trims"]
    first: Int[np.ndarray, "one_more"]
    to: Int[np.ndarray, "maneuvers"]
    velocity: Complex[np.ndarray, "levels trims"]
    rate: Float[np.ndarray, "levels trims"]
    displacement: Complex[np.ndarray, "levels maneuvers"]
    turn: Float[np.ndarray, "levels maneuvers"]
    duration: Float[np.ndarray, "levels maneuvers"]

    @classmethod
    def of(cls, library: Library, gammas: tuple[float, ...]) -> "Automaton":
        """Returns the coefficients of a library at some levels."""
        place = {trim.id: index for index, trim in enumerate(library.trims)}
        leaves = np.array([place[one.from_trim] for one in library.maneuvers], dtype=np.intc)
        order = np.argsort(leaves, kind="stable")
        steps = [library.maneuvers[index] for index in order]
        twists = [[trim.at(gamma) for trim in library.trims] for gamma in gammas]
        outcomes = [[step.at(gamma) for step in steps] for gamma in gammas]
        moved = [[one.displacement for one in level] for level in outcomes]
        return cls(
            ids=np.array([trim.id for trim in library.trims]),
            first=np.searchsorted(leaves[order], np.arange(len(place) + 1)).astype(np.intc),
            to=np.array([place[step.to_trim] for step in steps], dtype=np.intc),
            velocity=np.array([[complex(one.forward, one.side) for one in level] for level in twists]),
            rate=np.array([[one.yaw_rate for one in level] for level in twists], dtype=float),
            displacement=np.array(
                [[complex(one.x, one.y) for one in level] for level in moved], dtype=complex
            ),
            turn=np.array([[one.heading for one in level] for level in moved], dtype=float),
            duration=np.array([[one.duration for one in level] for level in outcomes], dtype=float),
        )

    def place(self, trim: int) -> int:
        """Returns the place of the trim with an id."""
        return int(np.flatnonzero(self.ids == trim)[0])

    def structure(self) -> "tuple[CAutomaton, tuple[np.ndarray, ...]]":
        """Returns the C structure and the arrays that it references."""
        arrays = (
            self.first,
            self.to,
            self.rate,
            np.abs(self.velocity),
            self.turn,
            self.duration,
            np.abs(self.displacement),
            self.velocity,
            self.displacement,
        )
        pointers = [array.ctypes.data for array in arrays]
        return CAutomaton(*pointers, len(self.ids), len(self.rate)), arrays
