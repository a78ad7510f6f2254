"""Walks whose coasting times are shared by several uncertainty levels, as arrays.

Positions are complex numbers (north + i east) seen from a start at the origin that heads north. Walks shorter
than the longest are filled with trims that go nowhere. An end depends on a coasting time t_k only through a
turn about a point that later times do not move, so with v_k the velocity of the end along t_k

    d v_k / d t_i = i r_min(i,k) v_max(i,k),

which is all that bounds over boxes of coasting times need.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float, Int

from flight.automaton.library import Library
from planner.walks.flow import fly_walks
from planner.walks.walk import Walk

from .whole_interval import LinearWalk


@dataclass(frozen=True, slots=True, eq=False)
class WalkBatch:
    """Walks, one a row, each at some levels.

    Attributes:
        velocity: turned by the maneuvers before, metres per second.
        rate: yaw rates in radians per second.
        displacement: of the maneuver before each trim, turned likewise, metres; 0 for the first.
        turned: heading change of all maneuvers together, radians.
    """

    velocity: Complex[np.ndarray, "n levels trims"]
    rate: Float[np.ndarray, "n levels trims"]
    displacement: Complex[np.ndarray, "n levels trims"]
    turned: Float[np.ndarray, "n levels"]

    def ends(
        self, times: Float[np.ndarray, "n trims"]
    ) -> tuple[
        Complex[np.ndarray, "n levels"],
        Float[np.ndarray, "n levels"],
        Complex[np.ndarray, "n levels trims"],
    ]:
        """Returns ends, headings and end velocities for coasting times.

        Args:
            times: seconds, of each walk.
        """
        flow = fly_walks(self.velocity, self.rate, self.displacement, times[:, None, :])
        return flow.end, flow.heading[:, :, -1] + self.turned, flow.velocity

    def fastest(
        self,
        along: Complex[np.ndarray, "n levels trims"],
        width: Float[np.ndarray, "n trims"],
        latest: Float[np.ndarray, "n trims"],
    ) -> Float[np.ndarray, "n levels trims"]:
        """Returns bounds of the end's speed along each time over a box.

        Args:
            along: velocities of the end at the middle of the box.
            width: half widths of the box in seconds.
            latest: largest times in the box in seconds.
        """
        rate, speed, moved = np.abs(self.rate), np.abs(self.velocity), np.abs(self.displacement)
        with np.errstate(divide="ignore", invalid="ignore"):
            chord = np.minimum(speed * latest[:, None, :], np.where(rate > 0, 2 * speed / rate, np.inf))
        known = np.abs(along)
        bound = np.empty_like(known)
        swing, arm = np.zeros(known.shape[:2]), np.zeros(known.shape[:2])
        for place in range(known.shape[2] - 1, -1, -1):
            near = known[:, :, place] + rate[:, :, place] * swing
            far = speed[:, :, place] + rate[:, :, place] * arm
            bound[:, :, place] = np.minimum(near, far)
            swing = swing + bound[:, :, place] * width[:, None, place]
            arm = arm + chord[:, :, place] + moved[:, :, place]
        return np.asarray(bound)

    def take(self, rows: Int[np.ndarray, "taken"]) -> "WalkBatch":
        """Returns some of the walks."""
        return WalkBatch(self.velocity[rows], self.rate[rows], self.displacement[rows], self.turned[rows])


@dataclass(frozen=True, slots=True, eq=False)
class LinearWalkBatch:
    """Walks with coefficients linear in gamma: value + level * slope.

    Attributes:
        lengths: trims in each walk.
        velocity: forward + i side in metres per second, and its slope.
        rate: yaw rate in radians per second, and its slope.
        displacement: of the maneuver before each trim, in the body frame at entry, metres, and its slope.
        turned: by the maneuvers up to each trim in radians, and its slope.
        entered: turned by those before the maneuver to each trim in radians, and its slope.
    """

    lengths: Int[np.ndarray, "walks"]
    velocity: Complex[np.ndarray, "two walks trims"]
    rate: Float[np.ndarray, "two walks trims"]
    displacement: Complex[np.ndarray, "two walks trims"]
    turned: Float[np.ndarray, "two walks trims"]
    entered: Float[np.ndarray, "two walks trims"]

    @classmethod
    def of(cls, library: Library, walks: tuple[Walk, ...]) -> "LinearWalkBatch":
        """Returns walks of at least one trim; possibly none.

        Raises:
            NoManeuverError: the library does not join two trims of a walk.
        """
        lengths = np.array([len(walk) for walk in walks], dtype=int)
        shape = 2, len(walks), int(lengths.max(initial=1))
        velocity, displacement = np.zeros(shape, dtype=complex), np.zeros(shape, dtype=complex)
        rate, turn = np.zeros(shape), np.zeros(shape)
        for row, walk in enumerate(walks):
            lines, count = LinearWalk.of(library, walk), len(walk)
            velocity[:, row, :count], displacement[:, row, :count] = lines.velocity, lines.displacement
            rate[:, row, :count], turn[:, row, :count] = lines.rate, lines.turn
        turned = np.cumsum(turn, axis=2)
        return cls(lengths, velocity, rate, displacement, turned, turned - turn)

    def at(self, rows: Int[np.ndarray, "n"], levels: Float[np.ndarray, "n levels"]) -> WalkBatch:
        """Returns some of the walks, each at levels of its own."""
        level = levels[:, :, None]
        velocity, rate, displacement, turned, entered = (
            one[0][rows][:, None, :] + level * one[1][rows][:, None, :]
            for one in (self.velocity, self.rate, self.displacement, self.turned, self.entered)
        )
        return WalkBatch(
            velocity * np.exp(1j * turned), rate, displacement * np.exp(1j * entered), turned[:, :, -1]
        )


def walk_batch(library: Library, walks: tuple[Walk, ...], gammas: tuple[float, ...]) -> WalkBatch:
    """Returns walks of at least one trim, all at the same levels.

    Raises:
        NoManeuverError: the library does not join two trims of a walk.
    """
    levels = np.tile(np.array(gammas), (len(walks), 1))
    return LinearWalkBatch.of(library, walks).at(np.arange(len(walks)), levels)
