"""Tracks and tubes of plans, as lines to draw."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from flight.se2 import SE2, Twist

POINTS = 40
"""Points drawn for each primitive."""

TUBE_GAMMAS = 5
"""Lines of a tube."""

Line = Float[np.ndarray, "_ 2"]


def planned_track(
    library: Library,
    sequence: Sequence[int],
    coasting_times: Sequence[float],
    *,
    start: SE2,
    gamma: float = 0.0,
) -> tuple[tuple[Line, ...], tuple[Line, ...]]:
    """Returns coasts and maneuvers of a walk as lines in metres.

    Coasts are the exact flow (thesis, eq. 17-18). A library knows of a maneuver where it leads, not how: it
    is drawn as the cubic that leaves and arrives with the velocities of its two trims.

    Args:
        library: of the primitives.
        sequence: trim ids.
        coasting_times: seconds in each trim.
        start: pose at the beginning.
        gamma: uncertainty level of every primitive.
    """
    pieces = _pieces(library, sequence, coasting_times, start=start, gamma=gamma)
    return pieces[::2], pieces[1::2]


def planned_tube(
    library: Library,
    sequence: Sequence[int],
    coasting_times: Sequence[float],
    *,
    start: SE2,
    level: float,
) -> Float[np.ndarray, "gammas n 2"]:
    """Returns the tracks of a walk at gammas from -level to level.

    A line of north and east for each level, in metres; points of one place among the lines belong to the same
    part of the same primitive, so that the area between neighbours is what the walk sweeps.

    Args:
        library: of the primitives.
        sequence: trim ids.
        coasting_times: seconds in each trim.
        start: pose at the beginning.
        level: largest uncertainty level, >= 0.
    """
    levels = np.linspace(-level, level, TUBE_GAMMAS)
    return np.array(
        [
            np.concatenate(_pieces(library, sequence, coasting_times, start=start, gamma=float(gamma)))
            for gamma in levels
        ]
    )


def _pieces(
    library: Library, sequence: Sequence[int], coasting_times: Sequence[float], *, start: SE2, gamma: float
) -> tuple[Line, ...]:
    """Returns coasts and maneuvers in turn, as flown."""
    pieces, pose = [], start
    trims = [library.trim(number) for number in sequence]
    joints = [library.maneuver(a.id, b.id) for a, b in pairwise(trims)]
    for place, (trim, coasting_time) in enumerate(zip(trims, coasting_times, strict=True)):
        pieces.append(_coast(pose, trim.at(gamma), coasting_time))
        pose = pose @ SE2.exp(trim.at(gamma), coasting_time)
        if place < len(joints):
            pieces.append(_maneuver(pose, joints[place], (trim, trims[place + 1]), gamma))
            pose = pose @ joints[place].at(gamma).displacement
    return tuple(pieces)


def _coast(pose: SE2, velocity: Twist, duration: float) -> Line:
    poses = [pose @ SE2.exp(velocity, float(time)) for time in np.linspace(0.0, duration, POINTS)]
    return np.array([point.position for point in poses])


def _maneuver(pose: SE2, maneuver: Maneuver, trims: tuple[Trim, Trim], gamma: float) -> Line:
    outcome = maneuver.at(gamma)
    end = pose @ outcome.displacement
    leaving = _velocity_world(pose, trims[0].at(gamma)) * outcome.duration
    arriving = _velocity_world(end, trims[1].at(gamma)) * outcome.duration
    s = np.linspace(0.0, 1.0, POINTS)[:, None]
    first, last = np.array(pose.position), np.array(end.position)
    # Hermite's cubic on [0, 1].
    return np.asarray(
        first * (2 * s**3 - 3 * s**2 + 1)
        + leaving * (s**3 - 2 * s**2 + s)
        + last * (3 * s**2 - 2 * s**3)
        + arriving * (s**3 - s**2)
    )


def _velocity_world(pose: SE2, velocity: Twist) -> Float[np.ndarray, "2"]:
    rotation = SE2(0.0, 0.0, pose.heading)
    return np.array((rotation @ SE2(velocity.forward, velocity.side, 0.0)).position)
