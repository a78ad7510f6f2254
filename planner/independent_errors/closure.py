"""Coasting times that close a walk on its goal over error boxes.

Most walks are closed by two times (`two_link_closure.py`), the others given; a wanted heading takes one more
turn.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Complex, Float

from .affine import AffineForm
from .closed_chain import AffineWalk, Chain, backward_sum, displacements_of, remove_coasts, total_turn
from .error_path import ErrorPath
from .two_link_closure import LinkTimes, close_by_straights, close_by_turn, close_into_disc, unwrap_near

CLOSE = 1e-4
"""Seconds by which the middle of a box may differ from the given times."""

UNBOUNDED = 1e9
"""Blame, where a number has no bound."""


@dataclass(frozen=True, slots=True)
class Closure:
    """Choice of the adjustable coasting times.

    Attributes:
        turn: place of a turn adjusted by bearing; None without one.
        others: places of one coast beside a turn, of two straight ones, of one that enters the disc; or none.
        cut: place of a turn that restores a wanted heading; None where the heading is free.
    """

    turn: int | None
    others: tuple[int, ...]
    cut: int | None = None

    @property
    def answering(self) -> tuple[int, ...]:
        """Places of all adjustable coasts."""
        return tuple(one for one in (self.turn, *self.others, self.cut) if one is not None)


@dataclass(frozen=True, eq=False)
class ClosureTimes:
    """Coasting times as functions of the errors of boxes.

    Attributes:
        holds: True if they close the walk for all errors of a box; times may be negative.
        times: seconds, by place.
        seconds: coasting and maneuvers.
        heading: at the end, radians from that at the start.
        sensitivity: shift of the chain by each error variable, over the allowed shift.
    """

    holds: Bool[np.ndarray, "n"]
    times: dict[int, AffineForm]
    seconds: AffineForm
    heading: AffineForm
    sensitivity: Float[np.ndarray, "n variables"]


def closures_of(path: ErrorPath, *, heading: bool, tolerance: float) -> tuple[Closure, ...]:
    """Returns the choices of adjustable times, heading corrections included."""
    trims = range(len(path.walk))
    turns = [place for place in trims if path.turns(place)]
    straights = [place for place in trims if place not in turns]
    found = [Closure(turn, (other,)) for turn in turns for other in trims if other != turn]
    found += [Closure(None, pair) for pair in combinations(straights, 2)]
    found.append(Closure(None, ()))
    if tolerance > 0:
        found += [Closure(None, (place,)) for place in trims]
    cut = [
        Closure(closure.turn, closure.others, turn)
        for closure in found
        for turn in turns
        if turn not in closure.answering
    ]
    return tuple(found + (cut if heading else []))


def close_chain(
    path: ErrorPath,
    errors: Float[np.ndarray, "n variables"],
    width: Float[np.ndarray, "n variables"],
    times: Float[np.ndarray, "n trims"],
    *,
    goal: Complex[np.ndarray, "n"],
    tolerance: float,
    closure: Closure,
) -> ClosureTimes:
    """Returns the adjusted times over boxes of errors for one closure.

    Args:
        path: the walk.
        errors: middles of the boxes.
        width: their half widths.
        times: coasting times in seconds, which lead the middles where they are to be led.
        goal: wanted end, north + i east in metres; for one coast alone, the middle of the disc.
        tolerance: radius of that disc in metres.
        closure: the adjusted places; the others keep their times.
    """
    straights = sum(not path.turns(place) for place in closure.others)
    boxes = AffineWalk(path, errors, width, times, straights)
    with np.errstate(all="ignore"):
        chain = boxes.chain(goal)
        whole = total_turn(boxes, remove_coasts(chain, closure.answering))
        if closure.cut is not None:
            middle = path.at(errors)
            heading = (middle.rate * times).sum(axis=1) + middle.turn.sum(axis=1)
            chain = boxes.chain_from(closure.cut, goal, heading)
        found = _solve(boxes, chain, closure, tolerance)
        heading_end = sum(found.turns.values(), whole)
        if closure.cut is not None:
            rate = boxes.rate[closure.cut]
            angle = boxes.known(heading) - heading_end
            found.times[closure.cut] = (
                unwrap_near(angle, rate.middle * times[:, closure.cut]) * rate.inverse()
            )
            heading_end = boxes.known(heading)
        kept = times.sum(axis=1) - sum(times[:, place] for place in closure.answering)
        seconds = sum(found.times.values(), boxes.fixed.shifted(kept))
        near = [
            np.abs(time.middle - times[:, place]) < CLOSE + time.radius for place, time in found.times.items()
        ]
        holds = np.logical_and.reduce([np.isfinite(seconds.reach) & found.holds, *near])
        sensitivity = np.zeros(errors.shape)
        for number, scale in found.bears:
            sensitivity += np.abs(number.slope[:, : errors.shape[1]]) / np.abs(scale)[:, None]
    return ClosureTimes(
        holds, found.times, seconds, heading_end, np.nan_to_num(sensitivity, posinf=UNBOUNDED)
    )


def _solve(boxes: AffineWalk, chain: Chain, closure: Closure, tolerance: float) -> LinkTimes:
    if closure.turn is not None:
        return close_by_turn(boxes, chain, closure.turn, closure.others[0])
    if len(closure.others) == 2:
        return close_by_straights(boxes, chain, *closure.others)
    if closure.others:
        return close_into_disc(boxes, chain, closure.others[0], tolerance)
    end = backward_sum(boxes, displacements_of(boxes, chain)[0])
    furthest = np.hypot(np.abs(end.x.middle) + end.x.reach, np.abs(end.y.middle) + end.y.reach)
    return LinkTimes(bears=[(end.x, np.full(len(furthest), tolerance))], holds=furthest <= tolerance)
