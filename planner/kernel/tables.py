"""Walks from a trim as kernel arrays, one table per length."""

import ctypes
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float, Int

from flight.automaton.library import Library


class CTable(ctypes.Structure):
    """`KernelTable` of search.c."""

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
        arrays: what the kernel reads, in the order of its structure; kept alive here.
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
    """Returns tables of walks from a trim with coefficients by level.

    Raises:
        UnknownTrimError: the library has no such start or goal trim.
    """
    place = {trim.id: index for index, trim in enumerate(library.trims)}
    library.trim(start_trim)
    if goal_trim is not None:
        library.trim(goal_trim)
    ids = np.array([trim.id for trim in library.trims])
    onward = [
        [index for index, one in enumerate(library.maneuvers) if place[one.from_trim] == trim]
        for trim in range(len(ids))
    ]
    to = np.array([place[one.to_trim] for one in library.maneuvers], dtype=int)
    numbers = _Numbers.of(library, gammas)
    trims, steps = np.array([[place[start_trim]]]), np.zeros((1, 0), dtype=int)
    found = []
    for length in range(1, max_trims + 1):
        if length > 1:
            fan = [onward[last] for last in trims[:, -1].tolist()]
            many = np.repeat(np.arange(len(trims)), [len(one) for one in fan])
            step = np.array([index for one in fan for index in one], dtype=int)
            steps = np.column_stack([steps[many], step])
            trims = np.column_stack([trims[many], to[step]])
        wanted = slice(None) if goal_trim is None else trims[:, -1] == place[goal_trim]
        if len(trims[wanted]):
            found.append(numbers.table(ids, trims[wanted], steps[wanted]))
    return tuple(found)


@dataclass(frozen=True, slots=True, eq=False)
class _Numbers:
    """Coefficients of the library at every level."""

    velocity: Complex[np.ndarray, "levels trims"]
    rate: Float[np.ndarray, "levels trims"]
    displacement: Complex[np.ndarray, "levels maneuvers"]
    turn: Float[np.ndarray, "levels maneuvers"]
    duration: Float[np.ndarray, "levels maneuvers"]

    @classmethod
    def of(cls, library: Library, gammas: tuple[float, ...]) -> "_Numbers":
        twists = [[trim.at(gamma) for trim in library.trims] for gamma in gammas]
        outcomes = [[maneuver.at(gamma) for maneuver in library.maneuvers] for gamma in gammas]
        moved = [[one.displacement for one in level] for level in outcomes]
        return cls(
            velocity=np.array([[complex(one.forward, one.side) for one in level] for level in twists]),
            rate=np.array([[one.yaw_rate for one in level] for level in twists], dtype=float),
            displacement=np.array(
                [[complex(one.x, one.y) for one in level] for level in moved], dtype=complex
            ),
            turn=np.array([[one.heading for one in level] for level in moved], dtype=float),
            duration=np.array([[one.duration for one in level] for level in outcomes], dtype=float),
        )

    def table(
        self,
        ids: Int[np.ndarray, "all"],
        trims: Int[np.ndarray, "walks trims"],
        steps: Int[np.ndarray, "walks steps"],
    ) -> KernelTable:
        return kernel_table(
            ids[trims],
            velocity=_rows_along_walks(self.velocity, trims),
            rate=_rows_along_walks(self.rate, trims),
            displacement=_rows_along_walks(self.displacement, steps),
            turn=_rows_along_walks(self.turn, steps),
            fixed=_rows_along_walks(self.duration, steps).sum(axis=1),
        )


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
