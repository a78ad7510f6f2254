"""Statement of the stochastic shortest path to a goal.

The state is a trim and the goal as seen from the vehicle. An action is a coast of a fixed time or a maneuver;
its outcomes are points of equal weight of the transition law. An outcome that passes through the tolerance
ends there.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import ceil, inf

import numpy as np
from jaxtyping import Float, Int

from flight.automaton.library import Library
from flight.errors import FlightError
from flight.se2 import SE2, Twist

from .grid import RATIO, REACH, NestedGrid
from .law import CoastDistribution, ManeuverDistribution, TransitionLaw, transition_law
from .normal_points import normal_points, unit_vector

COASTS = (0.5, 1.0, 2.0, 4.0, 8.0)
"""Seconds of the coasts to choose from."""

STRAIGHT = 1e-2
"""Radians per second, or to the side per metre ahead, below which a trim flies straight."""

_MANEUVER_POINTS, _COAST_POINTS = 48, 8
# Steps of a grid that a straight coast leads on, at least; on the finest one any will do.
_FEWEST_STEPS = 10
# Seconds and radians of a path that one chord stands for, at most.
_CHORD_TIME, _CHORD_TURN = 0.5, 0.1


class ZeroDurationLoopError(FlightError):
    """Maneuvers that take no time lead back to where they began."""

    def __init__(self, trims: Iterable[int]) -> None:
        super().__init__(
            f"expected every loop of maneuvers to take time, got one of 0 s through trims {sorted(trims)}"
        )


class ZeroToleranceError(FlightError):
    """A goal without a tolerance cannot be reached by chance."""

    def __init__(self) -> None:
        super().__init__("expected a goal tolerance > 0 m for feedback, got 0 m")


@dataclass(frozen=True, slots=True, eq=False)
class Action:
    """A coast or maneuver with its possible outcomes, equally likely.

    Attributes:
        trim: place of the trim it begins in.
        to: place of the trim it ends in.
        maneuver: id of the maneuver; None for a coast.
        mean: seconds that it takes on average.
        duration: seconds, one for each outcome.
        displacement: forward, side, cosine and sine of the heading change, one row for each outcome.
        path: forward and side at equal shares of the duration, start and end included.
        coarsest: last grid on which it is considered.
        arrives: whether passing through the tolerance on the way ends the flight.
    """

    trim: int
    to: int
    maneuver: int | None
    mean: float
    duration: Float[np.ndarray, "n"]
    displacement: Float[np.ndarray, "n 4"]
    path: Float[np.ndarray, "n points 2"]
    coarsest: int
    arrives: bool


@dataclass(frozen=True, slots=True, eq=False)
class ShortestPathProblem:
    """All states, actions and outcomes of flights to one goal.

    Attributes:
        trims: ids.
        tolerance: radius around the goal in metres.
        ends: whether a flight in each trim ends inside the tolerance.
        actions: grouped by the trim they begin in; coasts first, the shortest first.
        best_speed: metres per second, in the asymptote.
        grid: nodes of the goal positions.
    """

    trims: tuple[int, ...]
    tolerance: float
    ends: tuple[bool, ...]
    actions: tuple[Action, ...]
    best_speed: float
    grid: NestedGrid

    @property
    def first(self) -> Int[np.ndarray, "one_more"]:
        """First action of each trim, and one past the last of all."""
        counts = np.bincount([one.trim for one in self.actions], minlength=len(self.trims))
        return np.concatenate([[0], np.cumsum(counts)]).astype(np.intc)


def state_problem(
    library: Library,
    *,
    tolerance: float,
    goal_trim: int | None = None,
    error_scale: float = 1.0,
    reach: float = REACH,
    refined: bool = False,
) -> ShortestPathProblem:
    """Returns the problem of a library and a goal.

    Args:
        library: the primitives.
        tolerance: radius around the goal in metres.
        goal_trim: id of the trim wanted at the goal; None leaves it free.
        error_scale: factor of all standard deviations.
        reach: metres that the grids cover.
        refined: whether the grid is three times finer, for studies of its error.

    Raises:
        ZeroToleranceError: the tolerance is 0.
        UnknownTrimError: the library lacks the goal trim.
        ZeroDurationLoopError: a loop of maneuvers takes no time.
    """
    if not tolerance > 0:
        raise ZeroToleranceError
    if goal_trim is not None:
        library.trim(goal_trim)
    law = transition_law(library, error_scale=error_scale)
    trims = tuple(trim.id for trim in library.trims)
    _check_loops(library, law)
    place = {trim: index for index, trim in enumerate(trims)}
    longest = max((float(np.hypot(*one.mean[1:3])) for one in law.maneuvers), default=0.0)
    grid = NestedGrid.around(tolerance, longest=longest, reach=reach, refined=refined)
    actions: list[Action] = []
    for trim, coast in zip(library.trims, law.trims, strict=True):
        arrives = goal_trim in {None, trim.id}
        actions += [_coast(place[trim.id], coast, time, grid, arrives=arrives) for time in COASTS]
        actions += [
            _maneuver(
                place[one.from_trim], place[one.to_trim], one.id, moved, grid, arrives=goal_trim is None
            )
            for one, moved in zip(library.maneuvers, law.maneuvers, strict=True)
            if one.from_trim == trim.id
        ]
    return ShortestPathProblem(
        trims=trims,
        tolerance=tolerance,
        ends=tuple(goal_trim in {None, trim} for trim in trims),
        actions=tuple(actions),
        best_speed=_best_speed(law),
        grid=grid,
    )


def _coast(trim: int, law: CoastDistribution, duration: float, grid: NestedGrid, *, arrives: bool) -> Action:
    velocities = normal_points(law.mean, law.averaged(duration), _COAST_POINTS)
    turn = float(np.abs(velocities[:, 2]).max()) * duration
    pieces = max(ceil(duration / _CHORD_TIME), ceil(turn / _CHORD_TURN))
    times = np.linspace(0.0, duration, pieces + 1)
    poses = [[SE2.exp(Twist(*row), float(time)) for time in times] for row in velocities.tolist()]
    path = np.round([[pose.position for pose in row] for row in poses], 10)
    cosine, sine = unit_vector(velocities[:, 2] * duration)
    return Action(
        trim=trim,
        to=trim,
        maneuver=None,
        mean=duration,
        duration=np.full(len(velocities), duration),
        displacement=np.column_stack([path[:, -1], cosine, sine]),
        path=path,
        coarsest=_coarsest(law, duration, grid),
        arrives=arrives,
    )


def _maneuver(
    trim: int, to: int, number: int, law: ManeuverDistribution, grid: NestedGrid, *, arrives: bool
) -> Action:
    rows = normal_points(law.mean, law.covariance, _MANEUVER_POINTS)
    duration = np.maximum(rows[:, 0], 0.0)
    share = np.linspace(0.0, 1.0, len(law.path))[None, :, None]
    # What an outcome is off at its end it is off in proportion on the way.
    path = law.path[None, :, :2] + share * (rows[:, None, 1:3] - law.mean[1:3])
    cosine, sine = unit_vector(rows[:, 3])
    return Action(
        trim=trim,
        to=to,
        maneuver=number,
        mean=float(np.mean(duration)),
        duration=duration,
        displacement=np.column_stack([rows[:, 1:3], cosine, sine]),
        path=np.round(path, 10),
        coarsest=grid.levels - 1,
        arrives=arrives,
    )


def _coarsest(law: CoastDistribution, duration: float, grid: NestedGrid) -> int:
    """Returns the last grid on which a coast is considered.

    Each look-up errs by what it interpolates, and the best of many actions is one that errs to the good side:
    where flight is straight, decisions a few nodes apart would add up such errors.
    """
    if duration == COASTS[-1] or not _flies_straight(law):
        return grid.levels - 1
    steps = float(np.hypot(*law.mean[:2])) * duration / grid.step
    return max((level for level in range(grid.levels) if steps >= _FEWEST_STEPS * RATIO**level), default=0)


def _flies_straight(law: CoastDistribution) -> bool:
    forward, side, yaw_rate = law.mean
    return bool(abs(yaw_rate) < STRAIGHT and abs(side) < STRAIGHT * forward)


def _best_speed(law: TransitionLaw) -> float:
    """Returns the fastest straight speed, or else the fastest of all."""
    speeds = [float(np.hypot(*one.mean[:2])) for one in law.trims]
    straight = [speed for speed, one in zip(speeds, law.trims, strict=True) if _flies_straight(one)]
    return max(straight, default=0.0) or max(speeds) or inf


def _check_loops(library: Library, law: TransitionLaw) -> None:
    """Checks that no loop of maneuvers takes no time."""
    onward: dict[int, set[int]] = {trim.id: set() for trim in library.trims}
    for one, moved in zip(library.maneuvers, law.maneuvers, strict=True):
        if moved.mean[0] <= 0:
            onward[one.from_trim].add(one.to_trim)
    # Trims without a way on take part in no loop, nor do those that only lead to such.
    while dead := [trim for trim, to in onward.items() if not to & onward.keys()]:
        for trim in dead:
            del onward[trim]
    if onward:
        raise ZeroDurationLoopError(onward)
