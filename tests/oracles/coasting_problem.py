"""Walks as arrays of free coasts with merged fixed parts."""

from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from jaxtyping import Bool, Complex, Float, Int

from flight.automaton.library import Library
from flight.mission.mission import Mission


@dataclass(frozen=True, slots=True, eq=False)
class CoastingProblem:
    """Rows of walks at one level with equally many free coasts.

    Attributes:
        walk: index of each row's walk.
        place: trims of the walk whose coasts are free.
        velocity: body velocities of these coasts, forward + i side, metres per second.
        rate: their yaw rates, radians per second.
        gap: merged displacement before each free coast, and after the last, in the frame where it begins.
        gap_turn: heading changes of the same, radians.
        fixed: seconds in maneuvers.
    """

    walk: Int[np.ndarray, "rows"]
    place: Int[np.ndarray, "rows free"]
    velocity: Complex[np.ndarray, "rows free"]
    rate: Float[np.ndarray, "rows free"]
    gap: Complex[np.ndarray, "rows gaps"]
    gap_turn: Float[np.ndarray, "rows gaps"]
    fixed: Float[np.ndarray, "rows"]

    @property
    def free(self) -> int:
        """Number of free coasts of each row."""
        return int(self.velocity.shape[1])

    def take(self, rows: Int[np.ndarray, "some"] | Bool[np.ndarray, "rows"]) -> "CoastingProblem":
        """Returns some of the rows."""
        return CoastingProblem(
            self.walk[rows],
            self.place[rows],
            self.velocity[rows],
            self.rate[rows],
            self.gap[rows],
            self.gap_turn[rows],
            self.fixed[rows],
        )

    def all_times(
        self, times: Float[np.ndarray, "rows free"], longest: int
    ) -> Float[np.ndarray, "rows longest"]:
        """Returns free times at their places in the walk, others 0."""
        every = np.zeros((len(times), longest))
        np.put_along_axis(every, self.place, times, axis=1)
        return every


def all_walks(library: Library, mission: Mission) -> list[tuple[int, ...]]:
    """Returns every walk of a mission, shorter ones first."""
    every: list[tuple[int, ...]] = []
    ends: list[tuple[int, ...]] = [(mission.start_trim,)]
    for _ in range(mission.max_trims):
        every += ends
        ends = [
            (*walk, edge.to_trim) for walk in ends for edge in library.maneuvers if edge.from_trim == walk[-1]
        ]
    return [walk for walk in every if mission.goal_trim in (None, walk[-1])]


def coasting_problems(
    library: Library, walks: list[tuple[int, ...]], gamma: float
) -> dict[int, CoastingProblem]:
    """Returns the walks for every choice of free coasts, by number.

    Coasts that neither move nor turn are never free.

    Args:
        library: the primitives.
        walks: trim ids.
        gamma: level at which the errors are added.
    """
    found: dict[int, list[CoastingProblem]] = {}
    for length in sorted({len(walk) for walk in walks}):
        index = [place for place, walk in enumerate(walks) if len(walk) == length]
        whole = whole_walks(library, [walks[place] for place in index], gamma, np.array(index))
        moves = (whole.velocity != 0) | (whole.rate != 0)
        for free in range(length + 1):
            for chosen in combinations(range(length), free):
                part = _merged(whole, chosen)
                found.setdefault(free, []).append(part.take(moves[:, list(chosen)].all(axis=1)))
    return {free: joined(parts) for free, parts in found.items()}


def whole_walks(
    library: Library, walks: list[tuple[int, ...]], gamma: float, index: Int[np.ndarray, "rows"]
) -> CoastingProblem:
    """Returns walks of one length with all coasts free."""
    trims = {
        one.id: (
            complex(
                one.velocity.forward + gamma * one.error.forward, one.velocity.side + gamma * one.error.side
            ),
            one.velocity.yaw_rate + gamma * one.error.yaw_rate,
        )
        for one in library.trims
    }
    edges = {
        (one.from_trim, one.to_trim): (
            complex(
                one.displacement.x + gamma * one.error.forward, one.displacement.y + gamma * one.error.side
            ),
            one.displacement.heading + gamma * one.error.heading_change,
            one.duration + gamma * one.error.duration,
        )
        for one in library.maneuvers
    }
    held = [[trims[trim] for trim in walk] for walk in walks]
    joints = [[edges[pair] for pair in pairwise(walk)] for walk in walks]
    count, length = len(walks), len(walks[0])
    gap, turn = np.zeros((count, length + 1), dtype=complex), np.zeros((count, length + 1))
    for row, joint in enumerate(joints):
        gap[row, 1:length] = [one[0] for one in joint]
        turn[row, 1:length] = [one[1] for one in joint]
    return CoastingProblem(
        index,
        np.tile(np.arange(length), (count, 1)),
        np.array([[one[0] for one in row] for row in held]),
        np.array([[one[1] for one in row] for row in held]),
        gap,
        turn,
        np.array([float(sum(one[2] for one in joint)) for joint in joints]),
    )


def _merged(whole: CoastingProblem, chosen: tuple[int, ...]) -> CoastingProblem:
    """Returns the walks with some coasts free and the gaps composed."""
    count = len(whole.walk)
    gap = np.zeros((count, len(chosen) + 1), dtype=complex)
    turn = np.zeros((count, len(chosen) + 1))
    for place in range(whole.free + 1):
        into = sum(place > one for one in chosen)
        gap[:, into] += np.exp(1j * turn[:, into]) * whole.gap[:, place]
        turn[:, into] += whole.gap_turn[:, place]
    columns = list(chosen)
    return CoastingProblem(
        whole.walk,
        whole.place[:, columns],
        whole.velocity[:, columns],
        whole.rate[:, columns],
        gap,
        turn,
        whole.fixed,
    )


def joined(parts: list[CoastingProblem]) -> CoastingProblem:
    """Returns the rows of several problems with as many free coasts."""
    return CoastingProblem(
        np.concatenate([one.walk for one in parts]),
        np.concatenate([one.place for one in parts]),
        np.concatenate([one.velocity for one in parts]),
        np.concatenate([one.rate for one in parts]),
        np.concatenate([one.gap for one in parts]),
        np.concatenate([one.gap_turn for one in parts]),
        np.concatenate([one.fixed for one in parts]),
    )
