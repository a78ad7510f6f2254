"""Flight tube: reachable positions between replans within the library's errors.

Every primitive flown errs on its own, and so does each of its numbers: the tube is an enclosure with
independent signs. A pose is a middle, a slope for each error variable, from -1 to 1, and a radius for what is
not linear: with a heading error f and a displacement a longer by b, exp(i f) (a + b) differs from
a + b + i f a by at most f^2 |a| / 2 + |f| |b|. Each planning begins a tube anew, from where the vehicle truly
is.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from flight.automaton.vehicle import Leg
from flight.se2 import SE2, wrap_angle

from .remaining_plan import PlanStep

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


def propagate_coast(where: ReachableSet, trim: Trim, duration: float, *, share: float) -> ReachableSet:
    """Returns the reachable set after a coast with time-varying velocity errors.

    Args:
        where: it begins.
        trim: trim held.
        duration: seconds.
        share: factor on the library's errors.
    """
    nominal, error = SE2.exp(trim.velocity, duration), trim.error
    turn = trim.velocity.yaw_rate * duration
    facing = np.exp(0.5j * turn)
    pushed = share * duration * np.array([abs(error.forward), 1j * abs(error.side)]) * facing
    swung = share * abs(error.yaw_rate) * duration
    way = complex(trim.velocity.forward, trim.velocity.side) * duration
    # Within the coast the nose is off its middle direction by half the turn at most, by a quarter on average.
    # Yaw errors push the end sideways by half of what they turn at most; their square bends the way.
    width = float(np.abs(pushed).sum())
    bent = 0.25 * abs(turn) * (width + 0.5 * abs(way) * swung) + 0.5 * swung * width + swung**2 * abs(way) / 6
    return where.after(
        complex(nominal.x, nominal.y),
        turn,
        moves=[*pushed.tolist(), 0.5j * facing * way * swung],
        turns=[0.0, 0.0, swung],
        bent=bent,
    )


def propagate_maneuver(where: ReachableSet, maneuver: Maneuver, *, share: float) -> ReachableSet:
    """Returns the reachable set after a maneuver; arguments as in `propagate_coast`."""
    moved, error = maneuver.displacement, maneuver.error
    return where.after(
        complex(moved.x, moved.y),
        moved.heading,
        moves=[share * abs(error.forward), 1j * share * abs(error.side), 0.0],
        turns=[0.0, 0.0, share * abs(error.heading_change)],
        due=maneuver.duration,
        late=share * error.duration,
    )


def tube_exit_time(
    library: Library,
    steps: Sequence[PlanStep],
    legs: Sequence[Leg],
    plannings: Sequence[float],
    *,
    share: float,
) -> float | None:
    """Returns the time of first leaving the tube, or None.

    The flight is checked until an alarm interrupts a maneuver.

    Args:
        library: flown with.
        steps: the intended primitive of each leg.
        legs: flown legs; their true tracks are checked.
        plannings: seconds since the start of each replan, where a tube begins.
        share: factor on the library's errors.
    """
    for window in _windows(steps, legs, plannings):
        where, elapsed = ReachableSet.at(_pose(window[0][1], 0)), 0.0
        for step, leg in window:
            if step.to_trim is None:
                flown = float(leg.track[-1, 0] - leg.track[0, 0])
                where = propagate_coast(where, library.trim(step.trim), flown, share=share)
            elif leg.alarm:
                # The interrupted maneuver is no primitive of the library; the safe stop follows.
                return None
            else:
                elapsed += leg.duration
                where = propagate_maneuver(where, library.maneuver(step.trim, step.to_trim), share=share)
            if not where.holds(_pose(leg, -1), elapsed=elapsed):
                return float(leg.track[-1, 0])
    return None


def _windows(
    steps: Sequence[PlanStep], legs: Sequence[Leg], plannings: Sequence[float]
) -> Iterator[list[tuple[PlanStep, Leg]]]:
    """Yields the legs from one replan to the next."""
    marks = sorted(plannings)
    found: dict[int, list[tuple[PlanStep, Leg]]] = {}
    for step, leg in zip(steps, legs, strict=True):
        number = int(np.searchsorted(marks, float(leg.track[0, 0]) + ROUNDING, side="right"))
        found.setdefault(number, []).append((step, leg))
    yield from found.values()


def _pose(leg: Leg, row: int) -> SE2:
    _, north, east, heading = leg.track[row].tolist()
    return SE2(north, east, heading)
