"""Solves two coasting times that close the chain, over error boxes.

A turn keeps the rest of the chain at one distance from its centre: so another time has to make both sides of
the chain equally long, seen from that centre, and the turn's own time follows from two bearings. Along a
straight coast the length is the hypotenuse over what lies aside of the course; about the centre of a second
turn it is the third side of a triangle. Two straight coasts meet like two lines; one coast alone ends where
it enters the disc around the goal. All of it is explicit, and is evaluated in affine arithmetic.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi
from typing import TypeVar

import numpy as np
from jaxtyping import Bool

from .affine import AffineForm, AffinePoint, BoxValues
from .closed_chain import (
    AffineWalk,
    Chain,
    ChainDisplacement,
    backward_sum,
    coast_places,
    displacements_of,
    forward_sum,
    least_sensitive_sum,
    remove_coasts,
    total_turn,
)

ROUNDS = 8
"""Iterations for times that depend on themselves."""

ROOM = 1.3
"""Factor by which a time's interval is widened for its effect on itself."""

LEAST_ROOM = 1e-9
"""Seconds."""

EDGE = 1e-3
"""Share of a length, squared, below which a leg counts as standing across."""

Extra = TypeVar("Extra")


@dataclass(eq=False)
class LinkTimes:
    """Times and turns of the adjusted coasts, with their validity limits."""

    times: dict[int, AffineForm] = field(default_factory=dict)
    turns: dict[int, AffineForm] = field(default_factory=dict)
    bears: list[tuple[AffineForm, BoxValues]] = field(default_factory=list)
    holds: Bool[np.ndarray, "n"] | bool = True


def close_by_turn(boxes: AffineWalk, chain: Chain, turn: int, other: int) -> LinkTimes:
    """Closes the chain by a turn and another coast."""
    at, turn_radius = coast_places(chain).index(turn), boxes.turn_radius(turn)
    before, after = (
        [*chain[:at], ChainDisplacement(-turn_radius, boxes.nothing)],
        [ChainDisplacement(turn_radius, boxes.nothing), *chain[at + 1 :]],
    )
    later = other in coast_places(after)
    fixed, free = (before, after) if later else (after, before)
    point, heading = least_sensitive_sum(boxes, fixed)
    length, seen = point.distance(), point.bearing() + heading
    found, bearing = _straight_link(boxes, free, other, length)
    found.bears.append((point.turned(np.conj(point.middle) / np.abs(point.middle)).y, length.middle))
    turned = total_turn(boxes, remove_coasts(before, (other,)))
    angle = seen - bearing if later else bearing - found.turns[other] - seen
    rate = boxes.rate[turn]
    found.turns[turn] = unwrap_near((angle - turned).shifted(pi), rate.middle * boxes.times[:, turn])
    found.times[turn] = found.turns[turn] * rate.inverse()
    return found


def close_into_disc(boxes: AffineWalk, chain: Chain, place: int, tolerance: float) -> LinkTimes:
    """Holds one trim until the end enters the disc around the goal."""
    rim = boxes.known(np.full(len(boxes.times), tolerance))
    return _straight_link(boxes, chain, place, rim)[0]


def _straight_link(
    boxes: AffineWalk, side: Chain, place: int, length: AffineForm
) -> tuple[LinkTimes, AffineForm]:
    """Solves one straight coast for a chain side's length; returns its bearing."""
    at = coast_places(side).index(place)
    near, heading = forward_sum(boxes, side[:at])
    far = backward_sum(boxes, displacements_of(boxes, side[at + 1 :])[0])
    held = boxes.times[:, place]
    if boxes.path.turns(place):
        return _turning_link(boxes, (near, heading, far), place, length)

    course, speed = boxes.velocity[place].bearing(), boxes.velocity[place].distance()

    def step(guesses: list[AffineForm]) -> tuple[list[AffineForm], tuple[LinkTimes, AffineForm]]:
        half = (boxes.rate[place] * guesses[0]).scaled(0.5)
        rest = (near.rotated(-half) + far.rotated(half)).rotated(-course)
        ahead = rest.x.middle + held * speed.middle * np.sinc(half.middle / pi)
        along = ((length - rest.y) * (length + rest.y)).root().scaled(np.where(ahead < 0, -1.0, 1.0))
        time = (along - rest.x) * (speed * half.sinc()).inverse()
        size, aside = length.middle, np.abs(rest.y.middle)
        square = np.maximum(size**2 - aside**2, EDGE * size**2)
        bears = [(rest.x, 3 * size), (rest.y, np.minimum(square / aside, size)), (length, square / size)]
        found = LinkTimes({place: time}, {place: half.scaled(2.0)}, bears)
        return [time], (found, AffinePoint(along, rest.y).bearing() + course + half + heading)

    holds, (found, bearing) = _iterate(boxes, (place,), step)
    found.holds = holds
    return found, bearing


def _turning_link(
    boxes: AffineWalk, side: tuple[AffinePoint, AffineForm, AffinePoint], place: int, length: AffineForm
) -> tuple[LinkTimes, AffineForm]:
    near, heading, far = side
    turn_radius, rate, held = boxes.turn_radius(place), boxes.rate[place], boxes.times[:, place]
    one, two = near + -turn_radius, turn_radius + far
    first, second = one.distance(), two.distance()
    x = ((length - second) * (length + second) + first * first) * first.inverse().scaled(0.5)
    left = (np.conj(one.middle) * np.exp(1j * rate.middle * held) * two.middle).imag < 0
    y = ((length - x) * (length + x)).root().scaled(np.where(left, -1.0, 1.0))
    opening = AffinePoint(x - first, y).bearing() + one.bearing() - two.bearing()
    turned = unwrap_near(opening, rate.middle * held)
    scale = np.maximum(length.middle**2 - x.middle**2, EDGE * length.middle**2) / length.middle
    bears = [(number, scale) for number in (first, second, length)]
    found = LinkTimes({place: turned * rate.inverse()}, {place: turned}, bears)
    return found, AffinePoint(x, y).bearing() + one.bearing() + heading


def close_by_straights(boxes: AffineWalk, chain: Chain, first: int, second: int) -> LinkTimes:
    """Closes the chain by two straight coasts, along the later's chord."""
    one, two = sorted((first, second), key=coast_places(chain).index)
    at, then = coast_places(chain).index(one), coast_places(chain).index(two)
    near, _ = forward_sum(boxes, chain[:at])
    between, turned = forward_sum(boxes, chain[at + 1 : then])
    far = backward_sum(boxes, displacements_of(boxes, chain[then + 1 :])[0])
    course = [boxes.velocity[place].bearing() for place in (one, two)]
    speed = [boxes.velocity[place].distance() for place in (one, two)]
    ahead = boxes.place(np.ones(len(boxes.times), complex))

    def step(guesses: list[AffineForm]) -> tuple[list[AffineForm], LinkTimes]:
        half = [
            (boxes.rate[place] * guess).scaled(0.5) for place, guess in zip((one, two), guesses, strict=True)
        ]
        aim = -(half[1] + course[1])
        back = half[0] + turned
        rest = (near.rotated(-(back + half[0])) + between).rotated(aim) + far.rotated(half[1] - course[1])
        closure = ahead.rotated(course[0] - back + aim)
        crossed = -(rest.y * closure.y.inverse())
        onward = -(rest.x + closure.x * crossed)
        times = [
            flown * (pace * bend.sinc()).inverse()
            for flown, pace, bend in zip((crossed, onward), speed, half, strict=True)
        ]
        size = np.abs(rest.middle) * np.abs(closure.y.middle)
        turns = {place: bend.scaled(2.0) for place, bend in zip((one, two), half, strict=True)}
        return times, LinkTimes(
            dict(zip((one, two), times, strict=True)), turns, [(rest.x, size), (rest.y, size)]
        )

    holds, found = _iterate(boxes, (one, two), step)
    found.holds = holds
    return found


def _iterate(
    boxes: AffineWalk,
    answering: tuple[int, ...],
    step: Callable[[list[AffineForm]], tuple[list[AffineForm], Extra]],
) -> tuple[Bool[np.ndarray, "n"], Extra]:
    """Iterates self-consistent times; returns where their existence is proved.

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
            guesses.append(AffineForm.exact(middle[at], np.concatenate([slope[at], own], axis=1)))
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


def unwrap_near(angle: AffineForm, near: BoxValues) -> AffineForm:
    """Returns an angle with the full turns nearest to another."""
    return angle.shifted(2 * pi * np.round((near - angle.middle) / (2 * pi)))
