"""Search for the best multipliers by linearisation at a box's middle."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np
from jaxtyping import Complex, Float, Int

from .dual_bound import Multipliers, PerBox, PerTrim, WalkProblems, dual_bound

UNBOUNDED = 10.0
"""Seconds after the beginning of an interval without an end that count as its middle."""

FLAT = 1e-3
"""Seconds per second; a time of larger weight is taken at one end of its interval."""

TILT = 1e-5
"""Radians of tilt against a line that may be followed without limit."""

BoxVectors = Complex[np.ndarray, "boxes"]
MultiplierTrial = tuple[float, BoxVectors, PerBox]
"""kappa, the vector, and the weight of turning in seconds per radian."""


class MultiplierSearch:
    """Search for multipliers over many boxes at once.

    Args:
        problems: one for each box.
        low: of the coasting times, seconds.
        high: likewise; may be infinite.
        target: lower bound in seconds to prove; infinite to prove the goal unreachable.

    Attributes:
        excess: by how much each box is refuted, in seconds (for kappa 0 in metres); negative where it is not.
        by: the multipliers found.
        middle: times inside.
    """

    def __init__(self, problems: WalkProblems, low: PerTrim, high: PerTrim, target: float) -> None:
        self._problems, self._low, self._high, self._target = problems, low, high, target
        count, trims = low.shape
        self.excess: PerBox = np.full(count, -np.inf)
        self.by = Multipliers(np.ones(count), np.zeros(count, dtype=complex), np.zeros((count, trims)))
        self._turning = np.zeros(count)
        self.middle = box_midpoint(low, high)

    def run(self, hint: BoxVectors) -> None:
        """Tries candidates until every box is refuted or none is left."""
        velocity, end, _ = self._problems.propagate(self.middle)
        for kappa, vector, turning in self._trials(velocity, end, hint):
            rows = np.flatnonzero(self.excess < 0)
            if not len(rows):
                return
            self._try(rows, (kappa, vector[rows], turning[rows]), self.middle[rows], velocity[rows])
        for _ in range(2):
            rows = np.flatnonzero((self.excess < 0) & np.isfinite(self.excess))
            if len(rows):
                self._at_corners(rows)

    def _trials(
        self, velocity: Complex[np.ndarray, "boxes trims"], end: BoxVectors, hint: BoxVectors
    ) -> Iterator[MultiplierTrial]:
        problems, none = self._problems, np.zeros(len(end))
        bounded = np.isfinite(self._target)
        off = end - problems.goal
        normal = _unit(off)
        if bounded:
            yield 1.0, hint, none
            yield from _one_free(velocity, normal)
            yield from _two_free(velocity)
        yield 0.0, normal, none
        for place in range(velocity.shape[1]):
            ahead = _unit(velocity[:, place])
            tilt = 0.0 if bounded else TILT * ahead
            yield 0.0, 1j * ahead + tilt, none
            yield 0.0, -1j * ahead + tilt, none
        if problems.heading is not None:
            if bounded:
                yield from _turning_free(velocity, problems.rate, normal)
                yield from _three_free(velocity, problems.rate)
            yield from _separating(velocity, problems.rate)

    def _try(
        self,
        rows: Int[np.ndarray, "some"],
        trial: tuple[float | PerBox, BoxVectors, PerBox],
        centre: PerTrim,
        velocity: Complex[np.ndarray, "some trims"],
    ) -> None:
        """Evaluates one trial for some boxes and records improvements."""
        some = self._problems.take(rows)
        kappa, vector, turning = np.broadcast_to(trial[0], len(rows)), trial[1], trial[2]
        worth = kappa[:, None] + (np.conj(vector)[:, None] * velocity).real + turning[:, None] * some.rate
        by = Multipliers(kappa, vector, np.where(some.rate != 0, worth, centre))
        found = dual_bound(some, self._low[rows], self._high[rows], by)
        if np.isfinite(self._target):
            found = found - kappa * self._target
        better = found > self.excess[rows]
        which = rows[better]
        self.excess[which] = found[better]
        self.by.kappa[which], self.by.vector[which] = kappa[better], vector[better]
        self.by.shares[which] = by.shares[better]
        self._turning[which] = turning[better]

    def _at_corners(self, rows: Int[np.ndarray, "some"]) -> None:
        """Repeats the best multipliers, expanded about their minimising corners."""
        some, low, high = self._problems.take(rows), self._low[rows], self._high[rows]
        kappa, vector, turning = self.by.kappa[rows], self.by.vector[rows], self._turning[rows]
        centre = self.middle[rows]
        for _ in range(2):
            velocity, _, _ = some.propagate(centre)
            worth = kappa[:, None] + (np.conj(vector)[:, None] * velocity).real + turning[:, None] * some.rate
            most = np.where(np.isfinite(high), high, centre)
            centre = np.where(worth > FLAT, low, np.where(worth < -FLAT, most, self.middle[rows]))
        velocity, _, _ = some.propagate(centre)
        self._try(rows, (kappa, vector, turning), centre, velocity)


def box_midpoint(low: PerTrim, high: PerTrim) -> PerTrim:
    """Returns interior times of boxes, also of unbounded ones."""
    ended = np.isfinite(high)
    inside: PerTrim = np.where(ended, 0.5 * (low + np.where(ended, high, 0.0)), low + UNBOUNDED)
    return inside


def _unit(vector: BoxVectors) -> BoxVectors:
    size = np.abs(vector)
    unit: BoxVectors = np.where(size > 0, vector / np.where(size > 0, size, 1.0), 1.0)
    return unit


def _one_free(velocity: Complex[np.ndarray, "boxes trims"], normal: BoxVectors) -> Iterator[MultiplierTrial]:
    """Yields trials with one free time, normal to the goal's disc."""
    for place in range(velocity.shape[1]):
        nearing = -(np.conj(normal) * velocity[:, place]).real
        some = nearing > 0
        yield 1.0, np.where(some, normal / np.where(some, nearing, 1.0), 0.0), np.zeros(len(normal))


def _two_free(velocity: Complex[np.ndarray, "boxes trims"]) -> Iterator[MultiplierTrial]:
    """Yields trials with two free times of equal weight."""
    for one, two in combinations(range(velocity.shape[1]), 2):
        first, second = velocity[:, one], velocity[:, two]
        area = (np.conj(first) * second).imag
        some = np.abs(area) > 1e-12
        vector = np.where(some, 1j * (second - first) / np.where(some, area, 1.0), 0.0)
        yield 1.0, vector, np.zeros(len(vector))


def _turning_free(
    velocity: Complex[np.ndarray, "boxes trims"], rate: PerTrim, normal: BoxVectors
) -> Iterator[MultiplierTrial]:
    """Yields trials with the heading constraint active."""
    none = np.zeros(len(normal), dtype=complex)
    away = (np.conj(normal)[:, None] * velocity).real
    for place in range(velocity.shape[1]):
        turns = rate[:, place] != 0
        yield 1.0, none, np.where(turns, -1 / np.where(turns, rate[:, place], 1.0), 0.0)
    for one, two in combinations(range(velocity.shape[1]), 2):
        area = away[:, one] * rate[:, two] - away[:, two] * rate[:, one]
        some = np.abs(area) > 1e-12
        size = np.where(some, (rate[:, one] - rate[:, two]) / np.where(some, area, 1.0), 0.0)
        turning = np.where(some, (away[:, two] - away[:, one]) / np.where(some, area, 1.0), 0.0)
        yield 1.0, np.maximum(size, 0.0) * normal, turning


def _three_free(velocity: Complex[np.ndarray, "boxes trims"], rate: PerTrim) -> Iterator[MultiplierTrial]:
    """Yields trials with three free times and the heading constraint."""
    for places in combinations(range(velocity.shape[1]), 3):
        matrix = _columns(velocity, rate)[:, places]
        solvable = np.abs(np.linalg.det(matrix)) > 1e-12
        matrix = np.where(solvable[:, None, None], matrix, np.eye(3))
        found = np.linalg.solve(matrix, -np.ones((len(matrix), 3, 1)))[..., 0]
        found = np.where(solvable[:, None], found, 0.0)
        yield 1.0, found[:, 0] + 1j * found[:, 1], found[:, 2]


def _separating(velocity: Complex[np.ndarray, "boxes trims"], rate: PerTrim) -> Iterator[MultiplierTrial]:
    """Yields separating multipliers with zero weight for two times."""
    columns = _columns(velocity, rate)
    for one, two in combinations(range(velocity.shape[1]), 2):
        across = np.cross(columns[:, one], columns[:, two])
        size = np.linalg.norm(across, axis=1, keepdims=True)
        across = across / np.where(size > 0, size, 1.0)
        for sign in (1.0, -1.0):
            yield 0.0, sign * (across[:, 0] + 1j * across[:, 1]), sign * across[:, 2]


def _columns(
    velocity: Complex[np.ndarray, "boxes trims"], rate: PerTrim
) -> Float[np.ndarray, "boxes trims 3"]:
    return np.stack([velocity.real, velocity.imag, rate], axis=2)
