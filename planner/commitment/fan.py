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

from flight.library import Library
from planner.sequences import Walk


@dataclass(frozen=True, slots=True, eq=False)
class Fan:
    """Walks at some levels.

    Attributes:
        walks: trim ids.
        lengths: trims in each walk.
        gammas: the levels.
        velocity: turned by the maneuvers before, metres per second.
        rate: yaw rates in radians per second.
        displacement: of the maneuver before each trim, turned likewise, metres; 0 for the first.
        turned: heading change of all maneuvers together, radians.
    """

    walks: tuple[Walk, ...]
    lengths: Int[np.ndarray, "walks"]
    gammas: tuple[float, ...]
    velocity: Complex[np.ndarray, "walks levels trims"]
    rate: Float[np.ndarray, "walks levels trims"]
    displacement: Complex[np.ndarray, "walks levels trims"]
    turned: Float[np.ndarray, "walks levels"]

    def ends(
        self, rows: Int[np.ndarray, "n"], times: Float[np.ndarray, "n trims"]
    ) -> tuple[
        Complex[np.ndarray, "n levels"],
        Float[np.ndarray, "n levels"],
        Complex[np.ndarray, "n levels trims"],
    ]:
        """Returns where coasting times lead, with which heading, and the velocity of the end along each.

        Args:
            rows: which walk each set of times belongs to.
            times: seconds.
        """
        rate, velocity, chord, turn = self._coasts(rows, times)
        heading = np.cumsum(rate * times[:, None, :], axis=2)
        facing = np.exp(1j * (heading - rate * times[:, None, :]))
        after = np.cumsum(facing * (self.displacement[rows] + chord), axis=2)
        end = after[:, :, -1]
        along = facing * turn * velocity + 1j * rate * (end[:, :, None] - after)
        return end, heading[:, :, -1] + self.turned[rows], along

    def _coasts(
        self, rows: Int[np.ndarray, "n"], times: Float[np.ndarray, "n trims"]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        rate, velocity = self.rate[rows], self.velocity[rows]
        half = 0.5 * rate * times[:, None, :]
        turn = np.exp(1j * half)
        return rate, velocity, velocity * times[:, None, :] * np.sinc(half / np.pi) * turn, turn * turn

    def fastest(
        self,
        rows: Int[np.ndarray, "n"],
        along: Complex[np.ndarray, "n levels trims"],
        width: Float[np.ndarray, "n trims"],
        latest: Float[np.ndarray, "n trims"],
    ) -> Float[np.ndarray, "n levels trims"]:
        """Returns bounds, over boxes of coasting times, of the speed of the end along each of them.

        Args:
            rows: which walk each box belongs to.
            along: velocities of the end at the middle of the box.
            width: half widths of the box in seconds.
            latest: largest times in the box in seconds.
        """
        rate, speed = np.abs(self.rate[rows]), np.abs(self.velocity[rows])
        moved = np.abs(self.displacement[rows])
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


def fan(library: Library, walks: tuple[Walk, ...], gammas: tuple[float, ...]) -> Fan:
    """Returns walks of at least one trim at some levels.

    Raises:
        NoManeuverError: the library does not join two trims of a walk.
    """
    lengths = np.array([len(walk) for walk in walks])
    shape = len(walks), len(gammas), int(lengths.max())
    velocity, displacement = np.zeros(shape, dtype=complex), np.zeros(shape, dtype=complex)
    rate, turned = np.zeros(shape), np.zeros(shape[:2])
    outcome = {one.id: [one.at(gamma) for gamma in gammas] for one in library.maneuvers}
    twist = {one.id: [one.at(gamma) for gamma in gammas] for one in library.trims}
    for row, walk in enumerate(walks):
        steps = library.maneuvers_along(walk)
        for level in range(len(gammas)):
            turn = 0.0
            for place, trim in enumerate(walk):
                if place:
                    moved = outcome[steps[place - 1].id][level].displacement
                    displacement[row, level, place] = complex(moved.x, moved.y) * np.exp(1j * turn)
                    turn += moved.heading
                held = twist[trim][level]
                velocity[row, level, place] = complex(held.forward, held.side) * np.exp(1j * turn)
                rate[row, level, place] = held.yaw_rate
            turned[row, level] = turn
    return Fan(walks, lengths, gammas, velocity, rate, displacement, turned)
