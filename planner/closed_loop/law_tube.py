"""Tube of the joint laws' bounds: maneuvers by entry, coasts by growth.

A primitive without such bounds keeps the library's errors. The tube of a coast is that of its whole duration
since the replan, not of its parts: errors that change sign grow more slowly than time.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from flight.automaton.joint_law import Row3
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from flight.automaton.vehicle import Leg
from flight.se2 import SE2, Twist

from .reachable_set import ReachableSet
from .remaining_plan import PlanStep


@dataclass(frozen=True, slots=True)
class Entry:
    """Situation at the start of a leg.

    Attributes:
        previous: id of the maneuver before; None where there was none.
        coast: seconds since its end.
        believed: body velocity as the vehicle believed it; None where it did not say.
    """

    previous: int | None
    coast: float
    believed: Twist | None


def entries_of(library: Library, steps: Sequence[PlanStep], legs: Sequence[Leg]) -> list[Entry]:
    """Returns the situation at the start of each leg."""
    found: list[Entry] = []
    previous, coast = None, 0.0
    for step, leg in zip(steps, legs, strict=True):
        found.append(Entry(previous, coast, leg.believed))
        if step.to_trim is None:
            coast += float(leg.track[-1, 0] - leg.track[0, 0])
        else:
            settled = leg.settled and not leg.alarm
            previous = library.maneuver(step.trim, step.to_trim).id if settled else None
            coast = 0.0
    return found


@dataclass(frozen=True, slots=True, eq=False)
class LawTube:
    """Reachable set by the laws, and the coast that it is in.

    Attributes:
        where: reachable set now.
        coast_began: reachable set at the coast's begin since the replan.
        skipped: seconds of the coast before the replan.
        coasted: seconds of it since then.
    """

    where: ReachableSet
    coast_began: ReachableSet
    skipped: float = 0.0
    coasted: float = 0.0

    @classmethod
    def at(cls, pose: SE2) -> "LawTube":
        """Returns the tube of one known pose."""
        where = ReachableSet.at(pose)
        return cls(where, where)

    def after_coast(self, trim: Trim, duration: float, entry: Entry, *, share: float) -> "LawTube":
        """Returns the tube after a coast, or one more part of it."""
        known = self if self.coasted else replace(self, coast_began=self.where, skipped=entry.coast)
        total = known.coasted + duration
        where = _coasted(known.coast_began, trim, total, skipped=known.skipped, share=share)
        return replace(known, where=where, coasted=total)

    def after_maneuver(
        self, library: Library, maneuver: Maneuver, entry: Entry, *, share: float
    ) -> "LawTube":
        """Returns the tube after a maneuver."""
        bounds, command = maneuver.bounds, library.trim(maneuver.from_trim).velocity
        if entry.believed is not None:
            believed = entry.believed
            offset = (
                believed.forward - command.forward,
                believed.side - command.side,
                believed.yaw_rate - command.yaw_rate,
            )
            bounds = maneuver.bounds_after(entry.previous, entry.coast, offset)
        duration, forward, side, heading = bounds.centre
        late, along, across, turned = (share * size for size in bounds.size)
        where = self.where.after(
            complex(forward, side),
            heading,
            moves=[along, 1j * across, 0.0],
            turns=[0.0, 0.0, turned],
            due=duration,
            late=late,
        )
        return LawTube(where, where)


def _coasted(
    where: ReachableSet, trim: Trim, duration: float, *, skipped: float, share: float
) -> ReachableSet:
    """Returns the reachable set after a coast, errors bounded by their growth.

    Of a coast begun `skipped` seconds before, the errors since are differences of two that are bounded.
    """
    sizes = _growth(trim, duration, skipped=skipped)
    velocity = trim.velocity if trim.law is None else trim.law.mean
    along, across, turned = (share * size for size in sizes)
    nominal, turn = SE2.exp(velocity, duration), velocity.yaw_rate * duration
    facing = np.exp(0.5j * turn)
    way, width = abs(complex(velocity.forward, velocity.side)) * duration, along + across
    # Integrated by parts: errors that add up to at most `width` at every time are turned by half the turn
    # from the middle heading, and by the whole turn, and the yaw errors, on the way.
    bent = width * (1.5 * abs(turn) + share * abs(trim.error.yaw_rate) * duration + turned)
    sideways = complex(velocity.forward, velocity.side) * duration * turned * 1j * facing
    return where.after(
        complex(nominal.x, nominal.y),
        turn,
        moves=[along * facing, across * 1j * facing, sideways, 0.0],
        turns=[0.0, 0.0, 0.0, turned],
        bent=bent + way * turned * (0.5 * abs(turn) + 0.5 * turned),
    )


def _growth(trim: Trim, duration: float, *, skipped: float) -> Row3:
    """Returns the bounds of the errors: forward, side, heading."""
    error = trim.error
    constant = (abs(error.forward) * duration, abs(error.side) * duration, abs(error.yaw_rate) * duration)
    law = trim.law
    if law is None:
        return constant
    end, begin = law.bounds_after(skipped + duration), law.bounds_after(skipped)
    if end is None or begin is None:
        # Without growth the errors are those about the command, which the mean is not.
        off = Twist(*(abs(a - b) for a, b in zip(_row(law.mean), _row(trim.velocity), strict=True)))
        forward, side, heading = (
            size + part * duration for size, part in zip(constant, _row(off), strict=True)
        )
        return forward, side, heading
    forward, side, heading = (last + first for last, first in zip(end, begin, strict=True))
    return forward, side, heading


def _row(velocity: Twist) -> Row3:
    return velocity.forward, velocity.side, velocity.yaw_rate
