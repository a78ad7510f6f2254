"""Independent rollouts of a policy, one flight at a time.

They share nothing with the planner but the decisions that they are handed.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, inf, sqrt

import numpy as np
from jaxtyping import Float

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from flight.mission.destination import first_arrival
from flight.mission.mission import Mission
from flight.plan.policy_statement import PolicyStatement
from flight.se2 import SE2, Twist

COAST = 0.5
"""Seconds of a coast between two decisions."""

_GIVEN_UP = 600.0
_POINTS = 9
# Standard deviations of an error where a library has no statistics.
_ERROR_DEVIATIONS = 2.0
# Standard errors that a mean, or a share, may be off.
_LIMIT = 4.0
# Share of the mean that it may be off beside, for what the two codes take otherwise.
_MODEL_SHARE = 0.01


@dataclass(frozen=True, slots=True)
class Situation:
    """State of a flight in which a policy decides.

    Attributes:
        pose: in the world.
        trim: id of the trim held.
        coasted: seconds since the trim was entered.
        previous: id of the maneuver before; None where there was none.
        offset: velocity less the trim's command.
    """

    pose: SE2
    trim: int
    coasted: float
    previous: int | None
    offset: tuple[float, float, float]


Decide = Callable[[Situation], Maneuver | None]
"""A policy: the maneuver to perform, None to coast."""


def arrival_times(
    decide: Decide,
    library: Library,
    mission: Mission,
    *,
    count: int,
    rng: np.random.Generator,
    latency: float = 0.0,
) -> Float[np.ndarray, "count"]:
    """Returns the arrival times of rollouts; infinite without arrival."""
    return np.array([_Flight(library, mission, rng, latency).fly(decide) for _ in range(count)])


def statement_problems(statement: PolicyStatement, times: Float[np.ndarray, "n"]) -> tuple[str, ...]:
    """Returns where rollouts contradict stated times, beyond chance.

    Args:
        statement: of the planner.
        times: of rollouts of the same mission and policy.
    """
    problems = []
    arrived = times[np.isfinite(times)]
    if statement.mean is None or not len(arrived):
        reached = "none" if not len(arrived) else f"{len(arrived)} of {len(times)}"
        return () if statement.mean is None and not len(arrived) else (f"mean: {reached} arrived anew",)
    error = float(arrived.std()) * sqrt(1 / len(arrived) + 1 / statement.rollouts)
    if abs(statement.mean - arrived.mean()) > _LIMIT * error + _MODEL_SHARE * arrived.mean():
        problems.append(f"mean: expected {arrived.mean():.2f} s +- {error:.2f} s, got {statement.mean:.2f} s")
    for name, share in (("median", 0.5), ("within_90", 0.9), ("within_95", 0.95), ("within_999", 0.999)):
        stated = getattr(statement, name)
        slow = inf if stated is None else (1 + _MODEL_SHARE) * stated
        chance = sqrt(share * (1 - share) * (1 / len(times) + 1 / statement.rollouts))
        kept = float(np.mean(times <= slow))
        if kept < share - _LIMIT * chance:
            problems.append(
                f"{name}: expected {100 * share:g} % within {stated:.2f} s, got {100 * kept:.1f} %"
            )
    return tuple(problems)


class _Flight:
    def __init__(self, library: Library, mission: Mission, rng: np.random.Generator, latency: float) -> None:
        self._library, self._mission, self._rng, self._latency = library, mission, rng, latency
        self._number = int(rng.integers(0, 2**31))
        self._performed: set[int] = set()
        self._fluctuation = np.zeros(3)
        self._pose, self._trim, self._time = mission.start, mission.start_trim, 0.0
        self._coasted, self._previous = 0.0, None
        self._fixed: Float[np.ndarray, "3"] | None = None

    _previous: int | None

    def fly(self, decide: Decide) -> float:
        if self._ends(self._mission.start_trim) and self._mission.destination.reached(self._pose):
            return 0.0
        self._enter()
        arrived = self._wait()
        if arrived is not None:
            return arrived
        while self._time < _GIVEN_UP:
            velocity = self._velocity()
            command = _components(self._library.trim(self._trim).velocity)
            off = velocity - command
            offset = (float(off[0]), float(off[1]), float(off[2]))
            chosen = decide(Situation(self._pose, self._trim, self._coasted, self._previous, offset))
            arrived = self._coast(velocity, COAST) if chosen is None else self._perform(chosen, offset)
            if arrived is not None:
                return arrived
        return inf

    def _wait(self) -> float | None:
        return self._coast(self._velocity(), self._latency) if self._latency else None

    def _coast(self, velocity: Float[np.ndarray, "3"], time: float) -> float | None:
        twist = Twist(*velocity.tolist())
        poses = [self._pose @ SE2.exp(twist, time * share) for share in np.linspace(0, 1, _POINTS)]
        arrived = self._moved(poses, time, counts=self._ends(self._trim))
        self._coasted += time
        law = self._library.trim(self._trim).law
        if law is not None:
            spread, memory = np.array(law.within.standard_deviation), np.array(law.within.correlation_time)
            kept = np.exp(-time / memory)
            fresh = self._rng.standard_normal(3) * spread * np.sqrt(1 - kept**2)
            self._fluctuation = kept * self._fluctuation + fresh
        return arrived

    def _perform(self, maneuver: Maneuver, offset: tuple[float, float, float]) -> float | None:
        mean, values = self._outcome(maneuver, offset)
        path = _mean_path(maneuver, self._library, mean)
        off = values[1:] - mean[1:]
        shares = np.linspace(0, 1, len(path))
        poses = [self._pose @ SE2(*(point + share * off)) for point, share in zip(path, shares, strict=True)]
        counts = self._mission.goal_trim is None
        arrived = self._moved(poses, float(values[0]), counts=counts)
        self._trim, self._previous, self._coasted = maneuver.to_trim, maneuver.id, 0.0
        self._enter()
        if arrived is None and self._ends(self._trim) and self._mission.destination.reached(self._pose):
            return self._time
        return self._wait() if arrived is None else arrived

    def _moved(self, poses: list[SE2], duration: float, *, counts: bool) -> float | None:
        times = self._time + np.linspace(0, duration, len(poses))
        track = np.column_stack([times, [[pose.x, pose.y, pose.heading] for pose in poses]])
        self._pose, self._time = poses[-1], self._time + duration
        return first_arrival([track], self._mission.destination).time if counts else None

    def _ends(self, trim: int) -> bool:
        return self._mission.goal_trim in {None, trim}

    def _enter(self) -> None:
        trim = self._library.trim(self._trim)
        if trim.law is None:
            mean, spread = _trim_moments(trim)
            self._fixed = mean + spread * self._rng.standard_normal(3)
        else:
            self._fluctuation = np.array(trim.law.within.standard_deviation) * self._rng.standard_normal(3)

    def _velocity(self) -> Float[np.ndarray, "3"]:
        law = self._library.trim(self._trim).law
        if law is None:
            assert self._fixed is not None
            return self._fixed
        row = np.array(law.deviations[self._number % len(law.deviations)])
        return np.asarray(_components(law.mean) + row + self._fluctuation)

    def _outcome(
        self, maneuver: Maneuver, offset: tuple[float, float, float]
    ) -> tuple[Float[np.ndarray, "4"], Float[np.ndarray, "4"]]:
        """Returns mean and drawn values: duration, forward, side, heading change."""
        law = maneuver.law
        if law is None:
            mean, spread = _maneuver_moments(maneuver)
            values = mean + spread * self._rng.standard_normal(4)
        else:
            mean = np.array(law.mean)
            rows = law.deviations if law.entry is None else law.entry.deviations
            again = maneuver.id in self._performed
            number = int(self._rng.integers(0, len(rows))) if again else self._number % len(rows)
            self._performed.add(maneuver.id)
            values = np.array(self._entered(maneuver, offset)) + np.array(rows[number])
        values[0] = max(values[0], 0.0)
        return mean, values

    def _entered(self, maneuver: Maneuver, offset: tuple[float, float, float]) -> list[float]:
        """Returns the mean values of a maneuver as entered."""
        law = maneuver.law
        assert law is not None
        if law.entry is None:
            return list(law.mean)
        shifts = {row.maneuver: row.shift for row in law.entry.previous}
        shift = shifts.get(self._previous or 0, (0.0, 0.0, 0.0, 0.0))
        faded = exp(-self._coasted / law.entry.fade_time)
        return [
            base + faded * by + sum(slope * part for slope, part in zip(slopes, offset, strict=True))
            for base, by, slopes in zip(law.entry.base, shift, law.entry.velocity, strict=True)
        ]


def _components(twist: Twist) -> Float[np.ndarray, "3"]:
    return np.array([twist.forward, twist.side, twist.yaw_rate])


def _trim_moments(trim: Trim) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    mean, spread = _components(trim.velocity), np.abs(_components(trim.error)) / _ERROR_DEVIATIONS
    for scalar in () if trim.statistics is None else trim.statistics.scalars:
        place = ("forward", "side", "yaw_rate").index(scalar.name)
        mean[place], spread[place] = scalar.mean, scalar.standard_deviation
    return mean, spread


def _maneuver_moments(maneuver: Maneuver) -> tuple[Float[np.ndarray, "4"], Float[np.ndarray, "4"]]:
    moved, error = maneuver.displacement, maneuver.error
    mean = np.array([maneuver.duration, moved.x, moved.y, moved.heading])
    spread = np.abs([error.duration, error.forward, error.side, error.heading_change]) / _ERROR_DEVIATIONS
    for scalar in () if maneuver.statistics is None else maneuver.statistics.scalars:
        place = ("duration", "forward", "side", "heading_change").index(scalar.name)
        mean[place], spread[place] = scalar.mean, scalar.standard_deviation
    return mean, spread


def _mean_path(
    maneuver: Maneuver, library: Library, mean: Float[np.ndarray, "4"]
) -> Float[np.ndarray, "points 3"]:
    """Returns the identified mean path, or else a cubic one."""
    if maneuver.law is not None:
        return np.array([instant.mean for instant in maneuver.law.path])
    start = _mean_velocity(library.trim(maneuver.from_trim))
    end = _mean_velocity(library.trim(maneuver.to_trim))
    turned = SE2(0.0, 0.0, float(mean[3])) @ SE2(float(end[0]), float(end[1]), 0.0)
    final = np.array([turned.x, turned.y, end[2]])
    rows = []
    for s in np.linspace(0, 1, _POINTS):
        h01, h10, h11 = 3 * s**2 - 2 * s**3, s**3 - 2 * s**2 + s, s**3 - s**2
        rows.append(h01 * mean[1:] + h10 * mean[0] * start + h11 * mean[0] * final)
    return np.array(rows)


def _mean_velocity(trim: Trim) -> Float[np.ndarray, "3"]:
    return _trim_moments(trim)[0] if trim.law is None else _components(trim.law.mean)
