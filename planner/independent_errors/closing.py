"""Coasting times that close a walk on its goal for all errors of a box.

Most walks are closed by two times (`legs.py`), the others given; a wanted heading takes a turn more, whose
time makes up for it.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Complex, Float

from .affine import Affine
from .closed_chain import ErrorBoxes, Ring, backward, parts_of, turns_of, without
from .error_path import ErrorPath
from .two_link_closure import Legs, by_lines, by_turn, into_disc, wound

CLOSE = 1e-4
"""Seconds by which the middle of a box may differ from the times it was asked for."""

UNBOUNDED = 1e9
"""Blame, where a number has no bound."""


@dataclass(frozen=True, slots=True)
class Way:
    """Which times answer.

    Attributes:
        turn: place of a turn that answers by its bearing; None where there is none.
        others: places of one coast beside a turn, of two straight ones, of one that enters the disc; or none.
        cut: place of a turn that makes up for a wanted heading; None where the heading is left to itself.
    """

    turn: int | None
    others: tuple[int, ...]
    cut: int | None = None

    @property
    def answering(self) -> tuple[int, ...]:
        """All places whose times answer."""
        return tuple(one for one in (self.turn, *self.others, self.cut) if one is not None)


@dataclass(frozen=True, eq=False)
class Closed:
    """How times answer the errors of boxes.

    Attributes:
        holds: whether they close the walk for all errors of a box; times may be negative.
        times: seconds, by place.
        seconds: coasting and maneuvers.
        heading: at the end, radians from that at the start.
        blame: how far each error variable bends the ring, in shares of what it bears.
    """

    holds: Bool[np.ndarray, "n"]
    times: dict[int, Affine]
    seconds: Affine
    heading: Affine
    blame: Float[np.ndarray, "n variables"]


def ways(path: ErrorPath, *, heading: bool, tolerance: float) -> tuple[Way, ...]:
    """Returns which times may answer: with a wanted heading also those beside a turn that makes up for it."""
    trims = range(len(path.walk))
    turns = [place for place in trims if path.turns(place)]
    straights = [place for place in trims if place not in turns]
    found = [Way(turn, (other,)) for turn in turns for other in trims if other != turn]
    found += [Way(None, pair) for pair in combinations(straights, 2)]
    found.append(Way(None, ()))
    if tolerance > 0:
        found += [Way(None, (place,)) for place in trims]
    cut = [Way(way.turn, way.others, turn) for way in found for turn in turns if turn not in way.answering]
    return tuple(found + (cut if heading else []))


def close(
    path: ErrorPath,
    errors: Float[np.ndarray, "n variables"],
    width: Float[np.ndarray, "n variables"],
    times: Float[np.ndarray, "n trims"],
    *,
    goal: Complex[np.ndarray, "n"],
    tolerance: float,
    way: Way,
) -> Closed:
    """Returns how times answer the errors of boxes in one way.

    Args:
        path: the walk.
        errors: middles of the boxes.
        width: their half widths.
        times: coasting times in seconds, which lead the middles where they are to be led.
        goal: where the end is to be, north + i east in metres; for one coast alone, the middle of the disc.
        tolerance: radius of that disc in metres.
        way: the places that answer; the others keep their times.
    """
    straights = sum(not path.turns(place) for place in way.others)
    boxes = ErrorBoxes(path, errors, width, times, straights)
    with np.errstate(all="ignore"):
        ring = boxes.ring(goal)
        whole = turns_of(boxes, without(ring, way.answering))
        if way.cut is not None:
            middle = path.at(errors)
            heading = (middle.rate * times).sum(axis=1) + middle.turn.sum(axis=1)
            ring = boxes.ring_from(way.cut, goal, heading)
        found = _solved(boxes, ring, way, tolerance)
        heading_end = sum(found.turns.values(), whole)
        if way.cut is not None:
            rate = boxes.rate[way.cut]
            angle = boxes.known(heading) - heading_end
            found.times[way.cut] = wound(angle, rate.middle * times[:, way.cut]) * rate.inverse()
            heading_end = boxes.known(heading)
        kept = times.sum(axis=1) - sum(times[:, place] for place in way.answering)
        seconds = sum(found.times.values(), boxes.fixed.moved(kept))
        near = [
            np.abs(time.middle - times[:, place]) < CLOSE + time.radius for place, time in found.times.items()
        ]
        holds = np.logical_and.reduce([np.isfinite(seconds.reach) & found.holds, *near])
        blame = np.zeros(errors.shape)
        for number, scale in found.bears:
            blame += np.abs(number.slope[:, : errors.shape[1]]) / np.abs(scale)[:, None]
    return Closed(holds, found.times, seconds, heading_end, np.nan_to_num(blame, posinf=UNBOUNDED))


def _solved(boxes: ErrorBoxes, ring: Ring, way: Way, tolerance: float) -> Legs:
    if way.turn is not None:
        return by_turn(boxes, ring, way.turn, way.others[0])
    if len(way.others) == 2:
        return by_lines(boxes, ring, *way.others)
    if way.others:
        return into_disc(boxes, ring, way.others[0], tolerance)
    end = backward(boxes, parts_of(boxes, ring)[0])
    furthest = np.hypot(np.abs(end.x.middle) + end.x.reach, np.abs(end.y.middle) + end.y.reach)
    return Legs(bears=[(end.x, np.full(len(furthest), tolerance))], holds=furthest <= tolerance)
