"""The maneuver automaton with errors as a vehicle.

This is the plant of the thesis's closed loop (chapter 7): it moves by the errors of the library at one level
that the planner does not know, or at another level for every primitive, and it knows exactly where it is.
"""

from collections.abc import Iterator
from itertools import repeat

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.vehicle import Leg
from flight.errors import FlightError
from flight.se2 import SE2
from planner.walks.kinematics import check_durations

TRACK_STEP = 0.05
"""Seconds between the points of a track."""


class TrueGammaError(FlightError):
    """The vehicle's true gamma is outside its range."""

    def __init__(self, gamma: float) -> None:
        super().__init__(f"the true gamma must be between -1 and 1, got {gamma}")


def independent_gammas(rng: np.random.Generator) -> Iterator[float]:
    """Yields independent levels, uniform between -1 and 1."""
    while True:
        yield float(rng.uniform(-1.0, 1.0))


class AutomatonVehicle:
    """Vehicle with the library's motion at one or several gamma levels.

    Args:
        library: the primitives.
        start: pose at time 0.
        trim: id of the trim held at time 0.
        gamma: the level of every primitive, from -1 to 1; or where each primitive takes its own from.

    Raises:
        TrueGammaError: the level is outside [-1, 1].
        UnknownTrimError: the library lacks the trim.
    """

    def __init__(self, library: Library, *, start: SE2, trim: int, gamma: float | Iterator[float]) -> None:
        library.trim(trim)
        self._library = library
        self._gammas = gamma if isinstance(gamma, Iterator) else repeat(gamma)
        self._held = self._next_gamma()
        self._time = 0.0
        self._pose = start
        self._trim = trim

    @property
    def time(self) -> float:
        """Seconds since the start."""
        return self._time

    @property
    def trim(self) -> int:
        """Id of the trim held now."""
        return self._trim

    @property
    def pose(self) -> SE2:
        """Pose in the world; the estimate equals the truth."""
        return self._pose

    def coast(self, duration: float) -> Leg:
        """Holds the trim for a time in seconds."""
        velocity = self._library.trim(self._trim).at(self._held)
        poses = [self._pose @ SE2.exp(velocity, float(time)) for time in _sample_times(duration)]
        return self._flown(duration, poses)

    def perform(self, maneuver: Maneuver) -> Leg:
        """Performs a maneuver, at constant velocity and yaw rate.

        Raises:
            FlightError: the maneuver leaves another trim than the one held now.
        """
        if maneuver.from_trim != self._trim:
            raise FlightError(
                f"maneuver {maneuver.id}: expected trim {maneuver.from_trim} at its start, got {self._trim}"
            )
        outcome = maneuver.at(self._next_gamma())
        moved = outcome.displacement
        shares = (
            _sample_times(outcome.duration) / outcome.duration if outcome.duration else np.array([0.0, 1.0])
        )
        poses = [self._pose @ SE2(s * moved.x, s * moved.y, s * moved.heading) for s in shares.tolist()]
        self._trim = maneuver.to_trim
        self._held = self._next_gamma()
        return self._flown(outcome.duration, poses)

    def _next_gamma(self) -> float:
        gamma = next(self._gammas)
        if not -1 <= gamma <= 1:
            raise TrueGammaError(gamma)
        check_durations(self._library, gamma)
        return gamma

    def _flown(self, duration: float, poses: list[SE2]) -> Leg:
        times = self._time + np.linspace(0.0, duration, len(poses))
        track = np.column_stack([times, [[pose.x, pose.y, pose.heading] for pose in poses]])
        self._time += duration
        self._pose = poses[-1]
        return Leg(duration=duration, settled=True, track=track)


def _sample_times(duration: float) -> Float[np.ndarray, "n"]:
    return np.linspace(0.0, duration, max(int(np.ceil(duration / TRACK_STEP)), 1) + 1)
