"""Many walks of one length at once, as arrays: where they lead and how their ends move.

Positions are complex numbers (north + i east), so a heading h is the factor exp(i h). A row is one walk
at one uncertainty level; `times` has a leading axis of rows and a last axis of trims.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Bool, Complex, Float, Int

from planner.walks.kinematics import WalkMotion


@dataclass(frozen=True, slots=True, eq=False)
class Batch:
    """Walks of one length.

    Attributes:
        velocity: forward + i side in metres per second.
        rate: yaw rates in radians per second.
        displacement: of the maneuver before each trim, in the body frame at entry, metres; 0 for the first.
        turn: heading change of the maneuver before each trim, radians; 0 for the first.
        fixed_time: seconds in maneuvers.
    """

    velocity: Complex[np.ndarray, "rows trims"]
    rate: Float[np.ndarray, "rows trims"]
    displacement: Complex[np.ndarray, "rows trims"]
    turn: Float[np.ndarray, "rows trims"]
    fixed_time: Float[np.ndarray, "rows"]

    @classmethod
    def of(cls, motions: Iterable[WalkMotion]) -> Self:
        """Gathers walks of one length."""
        rows = list(motions)
        return cls(
            velocity=np.array([[complex(v.forward, v.side) for v in row.velocities] for row in rows]),
            rate=np.array([[v.yaw_rate for v in row.velocities] for row in rows]),
            displacement=np.array([[0j, *(complex(d.x, d.y) for d in row.displacements)] for row in rows]),
            turn=np.array([[0.0, *(d.heading for d in row.displacements)] for row in rows]),
            fixed_time=np.array([row.fixed_time for row in rows]),
        )

    @property
    def trims(self) -> int:
        """Length of the walks."""
        return int(self.velocity.shape[1])

    def take(self, rows: Int[np.ndarray, "taken"] | Bool[np.ndarray, "rows"]) -> "Batch":
        """Returns some of the rows, in the order asked for."""
        return Batch(
            self.velocity[rows],
            self.rate[rows],
            self.displacement[rows],
            self.turn[rows],
            self.fixed_time[rows],
        )

    def repeat(self, count: int) -> "Batch":
        """Returns every row so many times in a row."""
        return self.take(np.repeat(np.arange(len(self.rate)), count))

    def coast(self, place: int, times: Float[np.ndarray, "rows"]) -> Complex[np.ndarray, "rows"]:
        """Returns the displacement of holding the trim at a place, in its own frame (thesis, eq. 17-18)."""
        half = 0.5 * self.rate[:, place] * times
        moved: Complex[np.ndarray, "rows"] = (
            self.velocity[:, place] * times * np.sinc(half / np.pi) * np.exp(1j * half)
        )
        return moved

    def along(
        self, times: Float[np.ndarray, "rows trims"], first: int, last: int
    ) -> tuple[Complex[np.ndarray, "rows"], Float[np.ndarray, "rows"]]:
        """Returns displacement and heading change of a part of the walk.

        It begins before the maneuver that leads to the trim at `first` and ends with the coast at `last`.
        """
        position = np.zeros(len(times), dtype=complex)
        heading = np.zeros(len(times))
        for place in range(first, last + 1):
            if place:
                position = position + np.exp(1j * heading) * self.displacement[:, place]
                heading = heading + self.turn[:, place]
            # Most coasting times that are asked about are 0.
            if times[:, place].any():
                position = position + np.exp(1j * heading) * self.coast(place, times[:, place])
                heading = heading + self.rate[:, place] * times[:, place]
        return position, heading

    def end(
        self, times: Float[np.ndarray, "rows trims"]
    ) -> tuple[Complex[np.ndarray, "rows"], Float[np.ndarray, "rows"]]:
        """Returns position and heading after the whole walk, from the origin with heading 0."""
        return self.along(times, 0, self.trims - 1)

    def end_velocities(self, times: Float[np.ndarray, "rows trims"]) -> Complex[np.ndarray, "rows trims"]:
        """Returns how fast the end moves with each coasting time, in metres per second.

        Coasting longer in a trim carries the rest of the walk along and turns it about the end of the coast.
        """
        position = np.zeros(len(times), dtype=complex)
        heading = np.zeros(len(times))
        own, after = [], []
        for place in range(self.trims):
            position = position + np.exp(1j * heading) * self.displacement[:, place]
            heading = heading + self.turn[:, place]
            position = position + np.exp(1j * heading) * self.coast(place, times[:, place])
            heading = heading + self.rate[:, place] * times[:, place]
            own.append(np.exp(1j * heading) * self.velocity[:, place])
            after.append(position)
        arm = position[:, None] - np.stack(after, axis=1)
        velocity: Complex[np.ndarray, "rows trims"] = np.stack(own, axis=1) + 1j * self.rate * arm
        return velocity
