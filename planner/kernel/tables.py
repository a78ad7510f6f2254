"""Walks from a trim as kernel arrays, one table per length."""

import ctypes
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Complex, Float, Int

from flight.automaton.library import Library
from planner.walks.walk import Walk, walks

from .automaton import Automaton


class CTable(ctypes.Structure):
    """`Table` of walks/each.c."""

    _fields_ = (
        *(
            (name, ctypes.c_void_p)
            for name in (
                "rate",
                "velocity",
                "centre",
                "displacement",
                "bearing_displacement",
                "bearing_velocity",
                "size_displacement",
                "speed",
                "fixed",
                "turned",
            )
        ),
        ("trims", ctypes.c_int),
        ("walks", ctypes.c_int),
    )


@dataclass(frozen=True, slots=True, eq=False)
class KernelTable:
    """Walks of one length at every uncertainty level.

    A row is a walk at a level. Headings are those that coasting alone makes: what the maneuvers before have
    turned is folded into the vectors.

    Attributes:
        walks: trim ids.
        arrays: arrays read by the kernel, in the order of its structure; kept alive here.
    """

    walks: Int[np.ndarray, "walks trims"]
    arrays: tuple[np.ndarray, ...]

    def fill(self, structure: CTable) -> None:
        """Points a structure of the kernel to the arrays."""
        for (name, *_), array in zip(CTable._fields_, self.arrays, strict=False):
            setattr(structure, name, array.ctypes.data)
        structure.walks, structure.trims = self.walks.shape

    def parts(self, size: int) -> Iterator["KernelTable"]:
        """Yields parts of a one-level table, of bounded length."""
        for begin in range(0, len(self.walks), size):
            rows = slice(begin, begin + size)
            yield KernelTable(self.walks[rows], tuple(array[rows] for array in self.arrays))


def tables(
    library: Library, gammas: tuple[float, ...], start_trim: int, max_trims: int, goal_trim: int | None
) -> tuple[KernelTable, ...]:
    """Returns tables of all walks from a trim with coefficients by level.

    Raises:
        UnknownTrimError: the library has no such start or goal trim.
    """
    every = walks(library, start_trim, max_trims=max_trims, goal_trim=goal_trim)
    return tables_of_walks(Automaton.of(library, gammas), every)


def tables_of_walks(automaton: Automaton, chosen: Sequence[Walk]) -> tuple[KernelTable, ...]:
    """Returns tables of some walks with the coefficients of an automaton."""
    place = {trim: index for index, trim in enumerate(automaton.ids.tolist())}
    leaves = np.repeat(np.arange(len(place)), np.diff(automaton.first)).tolist()
    step = {pair: index for index, pair in enumerate(zip(leaves, automaton.to.tolist(), strict=True))}
    by_length: dict[int, list[Walk]] = {}
    for walk in chosen:
        by_length.setdefault(len(walk), []).append(walk)
    found = []
    for length, group in sorted(by_length.items()):
        trims = np.array([[place[trim] for trim in walk] for walk in group])
        steps = np.array([[step[pair] for pair in pairwise(row)] for row in trims.tolist()], dtype=int)
        steps = steps.reshape(len(group), length - 1)
        found.append(
            kernel_table(
                automaton.ids[trims],
                velocity=_rows_along_walks(automaton.velocity, trims),
                rate=_rows_along_walks(automaton.rate, trims),
                displacement=_rows_along_walks(automaton.displacement, steps),
                turn=_rows_along_walks(automaton.turn, steps),
                fixed=_rows_along_walks(automaton.duration, steps).sum(axis=1),
            )
        )
    return tuple(found)


def kernel_table(
    walks: Int[np.ndarray, "walks trims"],
    *,
    velocity: Complex[np.ndarray, "rows trims"],
    rate: Float[np.ndarray, "rows trims"],
    displacement: Complex[np.ndarray, "rows steps"],
    turn: Float[np.ndarray, "rows steps"],
    fixed: Float[np.ndarray, "rows"],
) -> KernelTable:
    """Returns a table of walks of one length.

    Args:
        walks: trim ids.
        velocity: body velocities, forward + i side, metres per second.
        rate: yaw rates in radians per second.
        displacement: of the maneuvers, in the body frame at entry, metres.
        turn: heading changes of the maneuvers, radians.
        fixed: seconds in maneuvers.
    """
    nothing = np.zeros((len(rate), 1))
    turned = np.hstack([nothing, np.cumsum(turn, axis=1)])
    velocity = velocity * np.exp(1j * turned)
    displacement = np.hstack([nothing, displacement * np.exp(1j * turned[:, :-1])])
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = np.where(rate != 0, velocity / (1j * rate), 0)
    arrays = (
        rate,
        velocity,
        centre,
        displacement,
        np.angle(displacement),
        np.angle(velocity),
        np.abs(displacement),
        np.abs(velocity),
        fixed,
        turned[:, -1],
    )
    return KernelTable(walks, tuple(np.ascontiguousarray(array) for array in arrays))


def _rows_along_walks(by_level: np.ndarray, index: Int[np.ndarray, "walks n"]) -> np.ndarray:
    """Returns coefficients along walks: row = walk x levels + level."""
    return np.moveaxis(by_level[:, index], 0, 1).reshape(len(by_level) * len(index), index.shape[1])
