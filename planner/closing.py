"""Coasting times that close a walk on its goal for all errors of a box.

With every other time given, two times close the ring of displacements like a triangle. About the centre of a
turn the rest of the ring keeps its distance, however far it turns: so another time has to make both sides of
the ring equally long, seen from that centre, and the turn's own time follows from two bearings. Along a
straight coast the length is the hypotenuse over what lies aside of the course; about the centre of a second
turn it is the third side of a triangle. Two straight coasts meet like two lines; one coast alone ends where
it enters the disc around the goal. All of it is explicit, and is evaluated in affine arithmetic.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import combinations
from math import pi
from typing import TypeVar

import numpy as np
from jaxtyping import Bool, Complex, Float

from .affine import Affine, Point, Row
from .error_box import ErrorPath
from .error_ring import ErrorBoxes, Move, Ring, backward, forward, parts_of, places, steadiest, turns_of

ROUNDS = 8
"""In which times that bend their own course are looked at before they are given up."""

ROOM = 1.3
"""By which the room for a time is made wider than it has to be, for its own effect on itself."""

LEAST_ROOM = 1e-9
"""Seconds."""

Extra = TypeVar("Extra")

CLOSE = 1e-4
"""Seconds by which the middle of a box may differ from the times it was asked for."""

EDGE = 1e-3
"""Share of a length, squared, below which a leg counts as standing across."""


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


@dataclass(eq=False)
class _Found:
    """Times and turns of the places that answer; what their shape rests on, and how far that may go."""

    times: dict[int, Affine] = field(default_factory=dict)
    turns: dict[int, Affine] = field(default_factory=dict)
    bears: list[tuple[Affine, Row]] = field(default_factory=list)
    holds: Bool[np.ndarray, "n"] | bool = True


def is_turn(path: ErrorPath, place: int) -> bool:
    """Returns whether a trim is a turn, with a centre, whatever its errors."""
    return bool(np.abs(path.rate[0][place]) > 2 * np.abs(path.rate[1][place]).sum())


def ways(path: ErrorPath, *, heading: bool, tolerance: float) -> tuple[Way, ...]:
    """Returns which times may answer: with a wanted heading also those beside a turn that makes up for it."""
    trims = range(len(path.walk))
    turns = [place for place in trims if is_turn(path, place)]
    straights = [place for place in trims if place not in turns]
    found = [Way(turn, (other,)) for turn in turns for other in trims if other != turn]
    found += [Way(None, pair) for pair in combinations(straights, 2)]
    if tolerance > 0:
        found += [Way(None, (place,)) for place in trims] + [Way(None, ())]
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
    straights = sum(not is_turn(path, place) for place in way.others)
    boxes = ErrorBoxes(path, errors, width, times, straights)
    with np.errstate(all="ignore"):
        ring = boxes.ring(goal)
        whole = turns_of(boxes, [one for one in ring if not _is_one_of(one, way.answering)])
        if way.cut is not None:
            middle = path.at(errors)
            heading = (middle.rate * times).sum(axis=1) + middle.turn.sum(axis=1)
            ring = boxes.ring_from(way.cut, goal, heading)
        found = _solved(path, boxes, ring, way, tolerance)
        heading_end = sum(found.turns.values(), whole)
        if way.cut is not None:
            rate = boxes.rate[way.cut]
            angle = boxes.known(heading) - heading_end
            found.times[way.cut] = _wound(angle, rate.middle * times[:, way.cut]) * rate.inverse()
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
    return Closed(holds, found.times, seconds, heading_end, np.nan_to_num(blame))


def _is_one_of(one: object, answering: tuple[int, ...]) -> bool:
    return getattr(one, "place", None) in answering


def _solved(path: ErrorPath, boxes: ErrorBoxes, ring: Ring, way: Way, tolerance: float) -> _Found:
    if way.turn is not None:
        return _by_turn(path, boxes, ring, way.turn, way.others[0])
    if len(way.others) == 2:
        return _by_lines(boxes, ring, *way.others)
    if way.others:
        return _into_disc(path, boxes, ring, way.others[0], tolerance)
    end = backward(boxes, parts_of(boxes, ring)[0])
    furthest = np.hypot(np.abs(end.x.middle) + end.x.reach, np.abs(end.y.middle) + end.y.reach)
    return _Found(bears=[(end.x, np.full(len(furthest), tolerance))], holds=furthest <= tolerance)


def _by_turn(path: ErrorPath, boxes: ErrorBoxes, ring: Ring, turn: int, other: int) -> _Found:
    """Closes the ring by a turn and another coast: before + exp(i (turned + angle)) after = 0."""
    at, spoke = places(ring).index(turn), boxes.spoke(turn)
    before, after = [*ring[:at], Move(-spoke, boxes.nothing)], [Move(spoke, boxes.nothing), *ring[at + 1 :]]
    later = other in places(after)
    fixed, free = (before, after) if later else (after, before)
    point, heading = steadiest(boxes, fixed)
    length, seen = point.distance(), point.bearing() + heading
    found, bearing = _leg(path, boxes, free, other, length)
    found.bears.append((point.turned(np.conj(point.middle) / np.abs(point.middle)).y, length.middle))
    turned = turns_of(boxes, [one for one in before if not _is_one_of(one, (other,))])
    angle = seen - bearing if later else bearing - found.turns[other] - seen
    rate = boxes.rate[turn]
    found.turns[turn] = _wound((angle - turned).moved(pi), rate.middle * boxes.times[:, turn])
    found.times[turn] = found.turns[turn] * rate.inverse()
    return found


def _into_disc(path: ErrorPath, boxes: ErrorBoxes, ring: Ring, place: int, tolerance: float) -> _Found:
    """Holds one trim until the end enters the disc around the goal."""
    rim = boxes.known(np.full(len(boxes.times), tolerance))
    return _leg(path, boxes, ring, place, rim)[0]


def _leg(path: ErrorPath, boxes: ErrorBoxes, side: Ring, place: int, length: Affine) -> tuple[_Found, Affine]:
    """Makes a side of the ring as long as asked by one coast; also returns its bearing from its beginning."""
    at = places(side).index(place)
    near, heading = forward(boxes, side[:at])
    far = backward(boxes, parts_of(boxes, side[at + 1 :])[0])
    held = boxes.times[:, place]
    if is_turn(path, place):
        return _turning_leg(boxes, (near, heading, far), place, length)

    course, speed = boxes.velocity[place].bearing(), boxes.velocity[place].distance()

    def step(guesses: list[Affine]) -> tuple[list[Affine], tuple[_Found, Affine]]:
        half = (boxes.rate[place] * guesses[0]).scaled(0.5)
        rest = (near.rotated(-half) + far.rotated(half)).rotated(-course)
        ahead = rest.x.middle + held * speed.middle * np.sinc(half.middle / pi)
        along = ((length - rest.y) * (length + rest.y)).root().scaled(np.where(ahead < 0, -1.0, 1.0))
        time = (along - rest.x) * (speed * half.sinc()).inverse()
        size, aside = length.middle, np.abs(rest.y.middle)
        square = np.maximum(size**2 - aside**2, EDGE * size**2)
        bears = [(rest.x, 3 * size), (rest.y, np.minimum(square / aside, size)), (length, square / size)]
        found = _Found({place: time}, {place: half.scaled(2.0)}, bears)
        return [time], (found, Point(along, rest.y).bearing() + course + half + heading)

    holds, (found, bearing) = _settled(boxes, (place,), step)
    found.holds = holds
    return found, bearing


def _turning_leg(
    boxes: ErrorBoxes, side: tuple[Point, Affine, Point], place: int, length: Affine
) -> tuple[_Found, Affine]:
    near, heading, far = side
    spoke, rate, held = boxes.spoke(place), boxes.rate[place], boxes.times[:, place]
    one, two = near + -spoke, spoke + far
    first, second = one.distance(), two.distance()
    x = ((length - second) * (length + second) + first * first) * first.inverse().scaled(0.5)
    left = (np.conj(one.middle) * np.exp(1j * rate.middle * held) * two.middle).imag < 0
    y = ((length - x) * (length + x)).root().scaled(np.where(left, -1.0, 1.0))
    opening = Point(x - first, y).bearing() + one.bearing() - two.bearing()
    turned = _wound(opening, rate.middle * held)
    scale = np.maximum(length.middle**2 - x.middle**2, EDGE * length.middle**2) / length.middle
    bears = [(number, scale) for number in (first, second, length)]
    found = _Found({place: turned * rate.inverse()}, {place: turned}, bears)
    return found, Point(x, y).bearing() + one.bearing() + heading


def _by_lines(boxes: ErrorBoxes, ring: Ring, first: int, second: int) -> _Found:
    """Closes the ring by two straight coasts, seen along the chord of the later one."""
    one, two = sorted((first, second), key=places(ring).index)
    at, then = places(ring).index(one), places(ring).index(two)
    near, _ = forward(boxes, ring[:at])
    between, turned = forward(boxes, ring[at + 1 : then])
    far = backward(boxes, parts_of(boxes, ring[then + 1 :])[0])
    course = [boxes.velocity[place].bearing() for place in (one, two)]
    speed = [boxes.velocity[place].distance() for place in (one, two)]
    ahead = boxes.place(np.ones(len(boxes.times), complex))

    def step(guesses: list[Affine]) -> tuple[list[Affine], _Found]:
        half = [
            (boxes.rate[place] * guess).scaled(0.5) for place, guess in zip((one, two), guesses, strict=True)
        ]
        aim = -(half[1] + course[1])
        back = half[0] + turned
        rest = (near.rotated(-(back + half[0])) + between).rotated(aim) + far.rotated(half[1] - course[1])
        way = ahead.rotated(course[0] - back + aim)
        crossed = -(rest.y * way.y.inverse())
        onward = -(rest.x + way.x * crossed)
        times = [
            flown * (pace * bend.sinc()).inverse()
            for flown, pace, bend in zip((crossed, onward), speed, half, strict=True)
        ]
        size = np.abs(rest.middle) * np.abs(way.y.middle)
        turns = {place: bend.scaled(2.0) for place, bend in zip((one, two), half, strict=True)}
        return times, _Found(
            dict(zip((one, two), times, strict=True)), turns, [(rest.x, size), (rest.y, size)]
        )

    holds, found = _settled(boxes, (one, two), step)
    found.holds = holds
    return found


def _settled(
    boxes: ErrorBoxes, answering: tuple[int, ...], step: Callable[[list[Affine]], tuple[list[Affine], Extra]]
) -> tuple[Bool[np.ndarray, "n"], Extra]:
    """Returns what times come to that bend their own course, and where it is sure that there are such times.

    From a guess, affine with some room, follow times; where these lie within the guess, some lie where they
    lead (Brouwer's fixed point theorem).
    """
    variables, count = boxes.variables, len(boxes.times)
    middle = [boxes.times[:, place] for place in answering]
    slope = [np.zeros((count, variables)) for _ in answering]
    room = [np.full(count, LEAST_ROOM) for _ in answering]
    for round_ in range(ROUNDS):
        guesses = []
        for at, _ in enumerate(answering):
            own = np.zeros((count, len(answering)))
            own[:, at] = room[at]
            guesses.append(Affine.exact(middle[at], np.concatenate([slope[at], own], axis=1)))
        times, found = step(guesses)
        holds, going = np.ones(count, bool), np.ones(count, bool)
        for at, time in enumerate(times):
            own_effect = np.abs(time.slope[:, variables:]).sum(axis=1) + time.radius
            if round_ < 2:
                fine = np.isfinite(own_effect)
                middle[at] = np.where(fine, time.middle, middle[at])
                slope[at] = np.where(fine[:, None], time.slope[:, :variables], slope[at])
                room[at] = np.where(fine, ROOM * own_effect + LEAST_ROOM, room[at])
                holds &= False
                going &= fine
                continue
            off = np.abs(time.middle - middle[at]) + np.abs(time.slope[:, :variables] - slope[at]).sum(axis=1)
            inside = off + own_effect <= room[at]
            holds &= inside
            going &= np.isfinite(off + own_effect)
            room[at] = np.where(inside | ~np.isfinite(off), room[at], ROOM * (off + own_effect))
        if not (going & ~holds).any():
            break
    return holds, found


def _wound(angle: Affine, near: Row) -> Affine:
    """Returns an angle with the full turns that bring it closest to another."""
    return angle.moved(2 * pi * np.round((near - angle.middle) / (2 * pi)))
