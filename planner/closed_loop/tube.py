"""Flight tube: reachable positions between replans within the library's errors.

Every primitive flown errs on its own, and so does each of its numbers: the tube is an enclosure with
independent signs. A pose is a middle, a slope for each error variable, from -1 to 1, and a radius for what is
not linear: with a heading error f and a displacement a longer by b, exp(i f) (a + b) differs from
a + b + i f a by at most f^2 |a| / 2 + |f| |b|. Each planning begins a tube anew, from where the vehicle truly
is.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from flight.automaton.vehicle import Leg
from flight.se2 import SE2

from .law_tube import Entry, LawTube, entries_of
from .reachable_set import ROUNDING, ReachableSet
from .remaining_plan import PlanStep


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

    The flight is checked until an alarm interrupts a maneuver. Where the library has joint laws, the flight
    leaves the tube as well where it leaves that of the laws' bounds (`law_tube`).

    Args:
        library: flown with.
        steps: the intended primitive of each leg.
        legs: flown legs; their true tracks are checked.
        plannings: seconds since the start of each replan, where a tube begins.
        share: factor on the library's errors.
    """
    entries = entries_of(library, steps, legs)
    laws = [*(trim.law for trim in library.trims), *(row.law for row in library.maneuvers)]
    lawful = any(law is not None for law in laws)
    for window in _windows(list(zip(steps, legs, entries, strict=True)), plannings):
        pose = _pose(window[0][1], 0)
        where, narrow, elapsed = ReachableSet.at(pose), LawTube.at(pose), 0.0
        for step, leg, entry in window:
            if step.to_trim is None:
                trim, flown = library.trim(step.trim), float(leg.track[-1, 0] - leg.track[0, 0])
                where = propagate_coast(where, trim, flown, share=share)
                narrow = narrow.after_coast(trim, flown, entry, share=share)
            elif leg.alarm:
                # The interrupted maneuver is no primitive of the library; the safe stop follows.
                return None
            else:
                elapsed += leg.duration
                maneuver = library.maneuver(step.trim, step.to_trim)
                where = propagate_maneuver(where, maneuver, share=share)
                narrow = narrow.after_maneuver(library, maneuver, entry, share=share)
            tubes = (where, narrow.where) if lawful else (where,)
            if not all(known.holds(_pose(leg, -1), elapsed=elapsed) for known in tubes):
                return float(leg.track[-1, 0])
    return None


_Part = tuple[PlanStep, Leg, Entry]


def _windows(parts: Sequence[_Part], plannings: Sequence[float]) -> Iterator[list[_Part]]:
    """Yields the legs from one replan to the next."""
    marks = sorted(plannings)
    found: dict[int, list[_Part]] = {}
    for part in parts:
        number = int(np.searchsorted(marks, float(part[1].track[0, 0]) + ROUNDING, side="right"))
        found.setdefault(number, []).append(part)
    yield from found.values()


def _pose(leg: Leg, row: int) -> SE2:
    _, north, east, heading = leg.track[row].tolist()
    return SE2(north, east, heading)
