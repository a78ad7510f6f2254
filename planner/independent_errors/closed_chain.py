"""A walk and its goal as a closed chain of displacements.

Each displacement is rotated by the headings before it; with the way back from the goal to the start they sum
to zero. A wanted heading cuts the chain at a turn that restores it, and joins it at the goal.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from .affine import AffineForm, AffinePoint, BoxValues, affine_coast
from .error_path import ErrorPath


@dataclass(frozen=True, eq=False)
class ChainCoast:
    """A coast of the chain, at a place of the walk."""

    place: int


@dataclass(frozen=True, eq=False)
class ChainDisplacement:
    """A displacement and the turn after it."""

    by: AffinePoint
    turn: AffineForm


Chain = Sequence[ChainCoast | ChainDisplacement]


class AffineWalk:
    """Coefficients of a walk for all errors in boxes.

    Args:
        path: the walk.
        errors: middles of the boxes.
        width: half widths of the boxes.
        times: coasting times in seconds at the middles; those not adjusted keep them.
        own: symbols beside those of the errors.
    """

    def __init__(
        self,
        path: ErrorPath,
        errors: Float[np.ndarray, "n variables"],
        width: Float[np.ndarray, "n variables"],
        times: Float[np.ndarray, "n trims"],
        own: int,
    ) -> None:
        self.path = path
        self._own, self._width = own, width
        numbers = path.at(errors)
        trims, steps = range(len(path.walk)), range(len(path.walk) - 1)
        self.velocity = [self._point(numbers.velocity[:, k], path.velocity[1][k]) for k in trims]
        self.rate = [self._number(numbers.rate[:, k], path.rate[1][k]) for k in trims]
        self.displacement = [self._point(numbers.displacement[:, k], path.displacement[1][k]) for k in steps]
        self.turn = [self._number(numbers.turn[:, k], path.turn[1][k]) for k in steps]
        self.fixed = self._number(numbers.fixed, path.fixed[1])
        self.times = times
        self.nothing = self.known(np.zeros(len(errors)))

    def _slope(self, change: np.ndarray) -> np.ndarray:
        return np.concatenate([self._width * change, np.zeros((len(self._width), self._own))], axis=1)

    def _number(self, value: BoxValues, change: Float[np.ndarray, "variables"]) -> AffineForm:
        return AffineForm.exact(value, self._slope(change))

    def _point(
        self, value: Complex[np.ndarray, "n"], change: Complex[np.ndarray, "variables"]
    ) -> AffinePoint:
        return AffinePoint.exact(value, self._slope(change))

    @property
    def variables(self) -> int:
        """Number of error variables."""
        return int(self._width.shape[1])

    def known(self, value: BoxValues) -> AffineForm:
        """Returns numbers independent of the errors."""
        return AffineForm.exact(value, np.zeros((len(value), self.variables + self._own)))

    def place(self, value: Complex[np.ndarray, "n"]) -> AffinePoint:
        """Returns points independent of the errors."""
        return AffinePoint(self.known(value.real), self.known(value.imag))

    def turn_radius(self, place: int) -> AffinePoint:
        """Returns the entry of a turn from its centre, body frame."""
        return (self.velocity[place] * self.rate[place].inverse()).rotated_left()

    def coast(self, place: int) -> tuple[AffinePoint, AffineForm] | None:
        """Returns displacement and turn of a fixed coast; None if 0."""
        held = self.times[:, place]
        return affine_coast(self.velocity[place], self.rate[place], self.known(held)) if held.any() else None

    def chain(self, goal: Complex[np.ndarray, "n"]) -> Chain:
        """Returns the chain of the path from goal to start, then walk."""
        chain: list[ChainCoast | ChainDisplacement] = [
            ChainDisplacement(self.place(-goal), self.nothing),
            ChainCoast(0),
        ]
        for place, (by, turn) in enumerate(zip(self.displacement, self.turn, strict=True), start=1):
            chain += [ChainDisplacement(by, turn), ChainCoast(place)]
        return chain

    def chain_from(self, turn: int, goal: Complex[np.ndarray, "n"], heading: BoxValues) -> Chain:
        """Returns the chain cut at a turn, from centre to centre."""
        chain = list(self.chain(goal))
        at = coast_places(chain).index(turn)
        turn_radius, back = (
            self.turn_radius(turn),
            ChainDisplacement(self.place(np.zeros(len(goal), complex)), self.known(-heading)),
        )
        return [
            ChainDisplacement(turn_radius, self.nothing),
            *chain[at + 1 :],
            back,
            *chain[:at],
            ChainDisplacement(-turn_radius, self.nothing),
        ]


def coast_places(chain: Chain) -> list[int]:
    """Returns the places of a chain's coasts; -1 for fixed displacements."""
    return [one.place if isinstance(one, ChainCoast) else -1 for one in chain]


def displacements_of(
    boxes: AffineWalk, chain: Chain
) -> tuple[list[tuple[AffinePoint, AffineForm]], AffineForm]:
    """Returns displacements with the turn before each, and the last turn."""
    parts, turned = [], boxes.nothing
    for one in chain:
        moved = (one.by, one.turn) if isinstance(one, ChainDisplacement) else boxes.coast(one.place)
        if moved is not None:
            parts.append((moved[0], turned))
            turned = moved[1]
    return parts, turned


def forward_sum(boxes: AffineWalk, chain: Chain) -> tuple[AffinePoint, AffineForm]:
    """Returns the sum of a chain in its final frame, and turn."""
    parts, turned = displacements_of(boxes, chain)
    heading = boxes.nothing
    point = boxes.place(np.zeros(len(turned.middle), complex))
    for by, turn in parts:
        point, heading = point.rotated(-turn) + by, heading + turn
    return point.rotated(-turned), heading + turned


def backward_sum(boxes: AffineWalk, parts: Sequence[tuple[AffinePoint, AffineForm]]) -> AffinePoint:
    """Returns the sum of displacements in the frame before them."""
    point = boxes.place(np.zeros(len(boxes.times), complex))
    for by, turn in reversed(parts):
        point = (by + point).rotated(turn)
    return point


def least_sensitive_sum(boxes: AffineWalk, chain: Chain) -> tuple[AffinePoint, AffineForm]:
    """Returns the sum in the frame least sensitive to errors, and heading.

    Turning what comes before a frame into it sways that by what the joints between are unsure, and likewise
    what comes after.
    """
    parts, _ = displacements_of(boxes, chain)
    by = [one.middle[0] for one, _ in parts]
    turn = [np.exp(1j * one.middle[0]) for _, one in parts]
    unsure = [one.reach[0] for _, one in parts]
    swept = []
    for frame in range(len(parts)):
        before, after, sum_ = 0j, 0j, 0.0
        for k in range(1, frame + 1):
            before = (before + by[k - 1]) / turn[k]
            sum_ += unsure[k] * abs(before)
        for k in range(len(parts) - 1, frame, -1):
            after = (after + by[k]) * turn[k]
            sum_ += unsure[k] * abs(after)
        swept.append(sum_)
    frame = int(np.argmin(swept))
    point, heading = parts[0]
    for moved, turned in parts[1 : frame + 1]:
        point, heading = point.rotated(-turned) + moved, heading + turned
    return point + backward_sum(boxes, parts[frame + 1 :]), heading


def total_turn(boxes: AffineWalk, chain: Chain) -> AffineForm:
    """Returns the heading change over a part of the chain."""
    sum_ = boxes.nothing
    for one in chain:
        if isinstance(one, ChainDisplacement):
            sum_ = sum_ + one.turn
        elif boxes.times[:, one.place].any():
            sum_ = sum_ + boxes.rate[one.place].scaled(boxes.times[:, one.place])
    return sum_


def remove_coasts(chain: Chain, answering: tuple[int, ...]) -> Chain:
    """Returns a part of the chain without some of its coasts."""
    return [one for one in chain if isinstance(one, ChainDisplacement) or one.place not in answering]
