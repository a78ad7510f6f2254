"""The maneuver automaton with its joint laws as a vehicle.

Deviations are those of one flight of the identification, drawn at random, so that what a flight shares stays
together; a maneuver's mean depends on how it was entered, and the velocity of a trim fluctuates within a
coast. The vehicle knows exactly where it is.
"""

from math import exp

import numpy as np
from jaxtyping import Float

from flight.automaton.joint_law import ManeuverLaw, Row3, TrimLaw
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.vehicle import Leg
from flight.errors import FlightError
from flight.se2 import SE2, Twist

from .automaton_vehicle import TRACK_STEP

SHORTEST = 0.1
"""Seconds: a drawn duration is not shorter."""


class NoLawError(FlightError):
    """A primitive of the library has no joint law."""

    def __init__(self, library: str, part: str) -> None:
        super().__init__(
            f"library {library}: expected a joint law for every primitive (maneuver-library/2), {part} has "
            "none; identify it anew from at least two flights"
        )


class JointLawVehicle:
    """Vehicle that moves by the joint laws of a library.

    Args:
        library: the primitives with their laws.
        start: pose at time 0.
        trim: id of the trim held at time 0.
        rng: random number generator.

    Raises:
        NoLawError: a primitive has none.
        UnknownTrimError: the library lacks the trim.
    """

    def __init__(self, library: Library, *, start: SE2, trim: int, rng: np.random.Generator) -> None:
        library.trim(trim)
        for part in library.trims:
            _law_of_trim(library, part.id)
        for row in library.maneuvers:
            _law_of_maneuver(library, row)
        self._library, self._rng = library, rng
        rows = min(len(_law_of_trim(library, part.id).deviations) for part in library.trims)
        self._flight = int(rng.integers(rows)) if rows else 0
        self._time, self._pose, self._trim = 0.0, start, trim
        self._previous: int | None = None
        self._coast = 0.0
        self._fluctuation = self._stationary()

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

    @property
    def velocity(self) -> Twist:
        """Body velocity in the trim held now."""
        law = _law_of_trim(self._library, self._trim)
        forward, side, yaw_rate = (
            np.array([law.mean.forward, law.mean.side, law.mean.yaw_rate])
            + self._row(law.deviations, 3)
            + self._fluctuation
        ).tolist()
        return Twist(forward, side, yaw_rate)

    def coast(self, duration: float) -> Leg:
        """Holds the trim for a time in seconds."""
        believed = self.velocity
        within = _law_of_trim(self._library, self._trim).within
        count = max(int(np.ceil(duration / TRACK_STEP)), 1)
        step, poses = duration / count, [self._pose]
        for _ in range(count):
            before = self._fluctuation
            keep = np.array([exp(-step / time) for time in within.correlation_time])
            fresh = self._rng.standard_normal(3) * np.array(within.standard_deviation)
            self._fluctuation = keep * before + np.sqrt(1 - keep**2) * fresh
            poses.append(poses[-1] @ SE2.exp(self.velocity, step))
        self._coast += duration
        return self._flown(duration, poses, believed)

    def perform(self, maneuver: Maneuver) -> Leg:
        """Performs a maneuver along its mean path, led to the drawn end.

        Raises:
            FlightError: the maneuver leaves another trim than the one held now.
        """
        if maneuver.from_trim != self._trim:
            raise FlightError(
                f"maneuver {maneuver.id}: expected trim {maneuver.from_trim} at its start, got {self._trim}"
            )
        law, believed = _law_of_maneuver(self._library, maneuver), self.velocity
        command = self._library.trim(self._trim).velocity
        offset: Row3 = (
            believed.forward - command.forward,
            believed.side - command.side,
            believed.yaw_rate - command.yaw_rate,
        )
        deviations = law.deviations if law.entry is None else law.entry.deviations
        mean = law.mean_after(self._previous, self._coast, offset)
        duration, *end = (np.array(mean) + self._row(deviations, 4)).tolist()
        duration = max(duration, SHORTEST)
        path = np.array([instant.mean for instant in law.path])
        shares = np.linspace(0.0, 1.0, len(path))
        # The end is the drawn one; what it is off the mean path's end grows evenly.
        path = path + shares[:, None] * (np.array(end) - path[-1])
        times = np.linspace(0.0, 1.0, max(int(np.ceil(duration / TRACK_STEP)), 1) + 1)
        columns = [np.interp(times, shares, column) for column in path.T]
        poses = [self._pose @ SE2(*row) for row in np.column_stack(columns).tolist()]
        self._trim, self._previous, self._coast = maneuver.to_trim, maneuver.id, 0.0
        self._fluctuation = self._stationary()
        return self._flown(duration, poses, believed)

    def _row(self, rows: tuple[tuple[float, ...], ...], width: int) -> Float[np.ndarray, "width"]:
        return np.array(rows[self._flight % len(rows)]) if rows else np.zeros(width)

    def _stationary(self) -> Float[np.ndarray, "3"]:
        within = _law_of_trim(self._library, self._trim).within
        return np.asarray(self._rng.standard_normal(3) * np.array(within.standard_deviation))

    def _flown(self, duration: float, poses: list[SE2], believed: Twist) -> Leg:
        times = self._time + np.linspace(0.0, duration, len(poses))
        track = np.column_stack([times, [[pose.x, pose.y, pose.heading] for pose in poses]])
        self._time += duration
        self._pose = poses[-1]
        return Leg(duration=duration, settled=True, track=track, believed=believed)


def _law_of_trim(library: Library, trim: int) -> TrimLaw:
    law = library.trim(trim).law
    if law is None:
        raise NoLawError(library.name, f"trim {trim}")
    return law


def _law_of_maneuver(library: Library, maneuver: Maneuver) -> ManeuverLaw:
    law = library.maneuver(maneuver.from_trim, maneuver.to_trim).law
    if law is None:
        raise NoLawError(library.name, f"maneuver {maneuver.id}")
    return law
