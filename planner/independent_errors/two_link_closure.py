"""Legs of a ring of displacements as long as asked, and rings closed by two of them, in boxes of errors.

About the centre of a turn the rest of a ring keeps its distance, however far it turns: so another time has to
make both sides of the ring equally long, seen from that centre, and the turn's own time follows from two
bearings. Along a straight coast the length is the hypotenuse over what lies aside of the course; about the
centre of a second turn it is the third side of a triangle. Two straight coasts meet like two lines; one coast
alone ends where it enters the disc around the goal. All of it is explicit, and is evaluated in affine
arithmetic.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi
from typing import TypeVar

import numpy as np
from jaxtyping import Bool

from .affine import Affine, Point, Row
from .closed_chain import (
    ErrorBoxes,
    Move,
    Ring,
    backward,
    forward,
    parts_of,
    places,
    steadiest,
    turns_of,
    without,
)

ROUNDS = 8
"""In which times that bend their own course are looked at before they are given up."""

ROOM = 1.3
"""By which the room for a time is made wider than it has to be, for its own effect on itself."""

LEAST_ROOM = 1e-9
"""Seconds."""

EDGE = 1e-3
"""Share of a length, squared, below which a leg counts as standing across."""

Extra = TypeVar("Extra")


@dataclass(eq=False)
class Legs:
    """Times and turns of the places that answer; what their shape rests on, and how far that may go."""

    times: dict[int, Affine] = field(default_factory=dict)
    turns: dict[int, Affine] = field(default_factory=dict)
    bears: list[tuple[Affine, Row]] = field(default_factory=list)
    holds: Bool[np.ndarray, "n"] | bool = True


def by_turn(boxes: ErrorBoxes, ring: Ring, turn: int, other: int) -> Legs:
    """Closes the ring by a turn and another coast: before + exp(i (turned + angle)) after = 0."""
    at, spoke = places(ring).index(turn), boxes.spoke(turn)
    before, after = [*ring[:at], Move(-spoke, boxes.nothing)], [Move(spoke, boxes.nothing), *ring[at + 1 :]]
    later = other in places(after)
    fixed, free = (before, after) if later else (after, before)
    point, heading = steadiest(boxes, fixed)
    length, seen = point.distance(), point.bearing() + heading
    found, bearing = _leg(boxes, free, other, length)
    found.bears.append((point.turned(np.conj(point.middle) / np.abs(point.middle)).y, length.middle))
    turned = turns_of(boxes, without(before, (other,)))
    angle = seen - bearing if later else bearing - found.turns[other] - seen
    rate = boxes.rate[turn]
    found.turns[turn] = wound((angle - turned).moved(pi), rate.middle * boxes.times[:, turn])
    found.times[turn] = found.turns[turn] * rate.inverse()
    return found


def into_disc(boxes: ErrorBoxes, ring: Ring, place: int, tolerance: float) -> Legs:
    """Holds one trim until the end enters the disc around the goal."""
    rim = boxes.known(np.full(len(boxes.times), tolerance))
    return _leg(boxes, ring, place, rim)[0]


def _leg(boxes: ErrorBoxes, side: Ring, place: int, length: Affine) -> tuple[Legs, Affine]:
    """Makes a side of the ring as long as asked by one coast; also returns its bearing from its beginning."""
    at = places(side).index(place)
    near, heading = forward(boxes, side[:at])
    far = backward(boxes, parts_of(boxes, side[at + 1 :])[0])
    held = boxes.times[:, place]
    if boxes.path.turns(place):
        return _turning_leg(boxes, (near, heading, far), place, length)

    course, speed = boxes.velocity[place].bearing(), boxes.velocity[place].distance()

    def step(guesses: list[Affine]) -> tuple[list[Affine], tuple[Legs, Affine]]:
        half = (boxes.rate[place] * guesses[0]).scaled(0.5)
        rest = (near.rotated(-half) + far.rotated(half)).rotated(-course)
        ahead = rest.x.middle + held * speed.middle * np.sinc(half.middle / pi)
        along = ((length - rest.y) * (length + rest.y)).root().scaled(np.where(ahead < 0, -1.0, 1.0))
        time = (along - rest.x) * (speed * half.sinc()).inverse()
        size, aside = length.middle, np.abs(rest.y.middle)
        square = np.maximum(size**2 - aside**2, EDGE * size**2)
        bears = [(rest.x, 3 * size), (rest.y, np.minimum(square / aside, size)), (length, square / size)]
        found = Legs({place: time}, {place: half.scaled(2.0)}, bears)
        return [time], (found, Point(along, rest.y).bearing() + course + half + heading)

    holds, (found, bearing) = _settled(boxes, (place,), step)
    found.holds = holds
    return found, bearing


def _turning_leg(
    boxes: ErrorBoxes, side: tuple[Point, Affine, Point], place: int, length: Affine
) -> tuple[Legs, Affine]:
    near, heading, far = side
    spoke, rate, held = boxes.spoke(place), boxes.rate[place], boxes.times[:, place]
    one, two = near + -spoke, spoke + far
    first, second = one.distance(), two.distance()
    x = ((length - second) * (length + second) + first * first) * first.inverse().scaled(0.5)
    left = (np.conj(one.middle) * np.exp(1j * rate.middle * held) * two.middle).imag < 0
    y = ((length - x) * (length + x)).root().scaled(np.where(left, -1.0, 1.0))
    opening = Point(x - first, y).bearing() + one.bearing() - two.bearing()
    turned = wound(opening, rate.middle * held)
    scale = np.maximum(length.middle**2 - x.middle**2, EDGE * length.middle**2) / length.middle
    bears = [(number, scale) for number in (first, second, length)]
    found = Legs({place: turned * rate.inverse()}, {place: turned}, bears)
    return found, Point(x, y).bearing() + one.bearing() + heading


def by_lines(boxes: ErrorBoxes, ring: Ring, first: int, second: int) -> Legs:
    """Closes the ring by two straight coasts, seen along the chord of the later one."""
    one, two = sorted((first, second), key=places(ring).index)
    at, then = places(ring).index(one), places(ring).index(two)
    near, _ = forward(boxes, ring[:at])
    between, turned = forward(boxes, ring[at + 1 : then])
    far = backward(boxes, parts_of(boxes, ring[then + 1 :])[0])
    course = [boxes.velocity[place].bearing() for place in (one, two)]
    speed = [boxes.velocity[place].distance() for place in (one, two)]
    ahead = boxes.place(np.ones(len(boxes.times), complex))

    def step(guesses: list[Affine]) -> tuple[list[Affine], Legs]:
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
        return times, Legs(dict(zip((one, two), times, strict=True)), turns, [(rest.x, size), (rest.y, size)])

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


def wound(angle: Affine, near: Row) -> Affine:
    """Returns an angle with the full turns that bring it closest to another."""
    return angle.moved(2 * pi * np.round((near - angle.middle) / (2 * pi)))
