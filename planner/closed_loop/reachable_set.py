"""Reachable set of a vehicle under independent errors: middle, slopes, radius."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flight.se2 import SE2, wrap_angle

ROUNDING = 1e-9
"""Metres, radians and seconds by which the tube is widened."""

CLOCK = 0.011
"""Seconds: a coast is flown to the nearest control period, and a leg's times are those of its track."""

_DIRECTIONS = np.exp(1j * np.linspace(0.0, np.pi, 64, endpoint=False))


@dataclass(frozen=True, slots=True, eq=False)
class ReachableSet:
    """Reachable set of a vehicle: a polygon of positions, headings, time.

    Attributes:
        middle: north + i east in metres.
        heading: in radians.
        moves: metres for each error variable.
        turns: radians for each error variable.
        radius: metres beside them.
        late: seconds by which the maneuvers so far may have been longer or shorter.
        due: seconds that maneuvers so far should have taken.
    """

    middle: complex
    heading: float
    moves: Complex[np.ndarray, "variables"]
    turns: Float[np.ndarray, "variables"]
    radius: float = 0.0
    late: float = 0.0
    due: float = 0.0

    @classmethod
    def at(cls, pose: SE2) -> "ReachableSet":
        """Returns the set of one known pose."""
        return cls(complex(pose.x, pose.y), pose.heading, np.zeros(0, dtype=complex), np.zeros(0))

    def after(
        self,
        displacement: complex,
        turn: float,
        *,
        moves: Sequence[complex],
        turns: Sequence[float],
        bent: float = 0.0,
        due: float = 0.0,
        late: float = 0.0,
    ) -> "ReachableSet":
        """Returns the reachable set after a primitive.

        Args:
            displacement: forward + i right, metres.
            turn: heading change, radians.
            moves: contributions of its errors to the displacement, a variable each.
            turns: contributions to the turn.
            bent: metres by which the displacement may be off that sum.
            due: seconds that a maneuver takes.
            late: its error, seconds.
        """
        facing = np.exp(1j * self.heading)
        off = float(np.abs(self.turns).sum())
        longer = float(np.abs(moves).sum()) + bent
        return ReachableSet(
            middle=self.middle + facing * displacement,
            heading=self.heading + turn,
            moves=np.concatenate(
                [self.moves + 1j * facing * displacement * self.turns, facing * np.array(moves)]
            ),
            turns=np.concatenate([self.turns, np.array(turns)]),
            radius=self.radius + 0.5 * off**2 * abs(displacement) + off * longer + bent,
            late=self.late + abs(late),
            due=self.due + due,
        )

    def holds(self, pose: SE2, *, elapsed: float) -> bool:
        """Returns True if a pose is inside after so many maneuver seconds."""
        off = complex(pose.x, pose.y) - self.middle
        turned = abs(wrap_angle(pose.heading - self.heading))
        if turned > np.abs(self.turns).sum() + ROUNDING or abs(elapsed - self.due) > self.late + CLOCK:
            return False
        # Outside where some direction sees it beyond all that the errors can reach: the normals of the moves
        # bound the polygon that they span, the others its rounded corners.
        normals = 1j * self.moves[np.abs(self.moves) > 0]
        directions = np.concatenate([_DIRECTIONS, normals / np.abs(normals)])
        seen = np.abs((off * directions.conj()).real)
        reach = np.abs((self.moves[None, :] * directions.conj()[:, None]).real).sum(axis=1) + self.radius
        return bool((seen <= reach + ROUNDING).all())
