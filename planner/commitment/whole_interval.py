"""Verified enclosure of the largest miss over a gamma interval.

Between two levels the end of a walk strays from the straight line between its ends there by at most
K (b - a)^2 / 8, K a bound of its second derivative with respect to the level; and on a straight line nothing
is further from the goal than its two ends. Pieces that may hold the largest miss are halved until that is
known.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex, Float

from flight.automaton.library import Library
from planner.walks.flow import fly_walks, fold_turns
from planner.walks.walk import Walk

FIRST_PIECES = 8

ROUNDING = 1e-11
"""Metres that positions of some hundred metres are rounded by, generously."""


@dataclass(frozen=True, slots=True)
class WorstMiss:
    """The largest miss over an interval of levels.

    Attributes:
        gamma: the level at which the largest miss was found.
        found: largest miss found, in metres.
        bound: metres that no level of the interval exceeds.
    """

    gamma: float
    found: float
    bound: float


@dataclass(frozen=True, slots=True, eq=False)
class LinearWalk:
    """One walk with coefficients linear in gamma: value + gamma * slope.

    Attributes:
        velocity: forward + i side in metres per second, and its slope.
        rate: yaw rate in radians per second, and its slope.
        displacement: of the maneuver before each trim, in the body frame at entry, metres, and its slope.
        turn: of that maneuver in radians, and its slope.
    """

    velocity: Complex[np.ndarray, "two trims"]
    rate: Float[np.ndarray, "two trims"]
    displacement: Complex[np.ndarray, "two trims"]
    turn: Float[np.ndarray, "two trims"]

    @classmethod
    def of(cls, library: Library, walk: Walk) -> "LinearWalk":
        """Returns the coefficients of a walk.

        Raises:
            NoManeuverError: the library does not join two trims of it.
        """
        trims = [library.trim(trim) for trim in walk]
        steps = library.maneuvers_along(walk)
        speeds = [[one.velocity for one in trims], [one.error for one in trims]]
        moves = [
            [complex(one.displacement.x, one.displacement.y) for one in steps],
            [complex(one.error.forward, one.error.side) for one in steps],
        ]
        turns = [[one.displacement.heading for one in steps], [one.error.heading_change for one in steps]]
        return cls(
            velocity=np.array([[complex(one.forward, one.side) for one in row] for row in speeds]),
            rate=np.array([[one.yaw_rate for one in row] for row in speeds], dtype=float),
            displacement=np.array([[0j, *row] for row in moves]),
            turn=np.array([[0.0, *row] for row in turns]),
        )

    def ends(
        self, times: Float[np.ndarray, "trims"], gammas: Float[np.ndarray, "n"]
    ) -> Complex[np.ndarray, "n"]:
        """Returns the ends for coasting times at every level."""
        level = gammas[:, None]
        velocity, rate = self.velocity[0] + level * self.velocity[1], self.rate[0] + level * self.rate[1]
        turn = self.turn[0] + level * self.turn[1]
        moved = self.displacement[0] + level * self.displacement[1]
        velocity, moved, _ = fold_turns(velocity, moved, turn)
        return fly_walks(velocity, rate, moved, times).end

    def curvature_bound(self, times: Float[np.ndarray, "trims"], gamma: float) -> float:
        """Returns a bound of the end's second derivative, in metres."""
        swung = np.cumsum(self.turn[1] + self.rate[1] * times)
        before = np.abs(swung - self.rate[1] * times)
        entry = np.abs(swung - self.rate[1] * times - self.turn[1])
        coasting = np.maximum(before, np.abs(swung))
        speed, moved = (np.abs(one[0]) + gamma * np.abs(one[1]) for one in (self.velocity, self.displacement))
        coasts = times * coasting * (2 * np.abs(self.velocity[1]) + coasting * speed)
        maneuvers = entry * (2 * np.abs(self.displacement[1]) + entry * moved)
        return float(coasts.sum() + maneuvers.sum())


def worst_miss(
    lines: LinearWalk,
    times: Float[np.ndarray, "trims"],
    goal: complex,
    gamma: float,
    *,
    resolution: float,
    enough: float = np.inf,
) -> WorstMiss:
    """Returns the largest miss over all levels from -gamma to gamma.

    Args:
        lines: the walk.
        times: coasting times in seconds.
        goal: north + i east in metres, from a start at the origin that heads north.
        gamma: the largest level.
        resolution: metres by which the bound may exceed the miss found.
        enough: metres; a miss found beyond it ends the search, the bound is then of no use.
    """
    bend = lines.curvature_bound(times, gamma)
    low = np.linspace(-gamma, gamma, FIRST_PIECES + 1)
    low, high = low[:-1], low[1:]
    found, at = -1.0, 0.0
    while True:
        misses = np.abs(lines.ends(times, np.concatenate([low, high])) - goal)
        best = int(misses.argmax())
        if misses[best] > found:
            found, at = float(misses[best]), float(np.concatenate([low, high])[best])
        bounds = np.maximum(misses[: len(low)], misses[len(low) :]) + bend * (high - low) ** 2 / 8
        open_ = bounds > found + resolution
        if not open_.any() or found > enough:
            return WorstMiss(at, found, found + resolution + ROUNDING)
        low, high = low[open_], high[open_]
        middle = 0.5 * (low + high)
        low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
