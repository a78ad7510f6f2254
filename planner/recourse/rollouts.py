"""Rollouts of the policy with feedback by the full law.

What a flight shares is shared: all its coasts in a trim have one mean velocity, and the first performance of
each maneuver has the deviations of one identified flight. Further performances have those of other flights.
"""

from dataclasses import dataclass
from math import inf

import numpy as np
from jaxtyping import Bool, Float, Int

from flight.automaton.joint_law import TrimLaw
from flight.automaton.library import Library

from .law import CoastDistribution, ManeuverDistribution, transition_law
from .policy import DECISION_INTERVAL, FeedbackPolicy, States, entry_shift

GIVEN_UP = 600.0
"""Seconds after which a rollout counts as never arriving."""

_CHORDS = 5


@dataclass(frozen=True, slots=True, eq=False)
class Rollouts:
    """Arrival times of many rollouts of one mission.

    Attributes:
        times: seconds to the arrival; infinite where it was not reached.
        walks: ids of the trims held, in order.
        tracks: forward and side of the way at every decision, as seen from the start; kept of the first ones.
    """

    times: Float[np.ndarray, "n"]
    walks: tuple[tuple[int, ...], ...]
    tracks: tuple[Float[np.ndarray, "points 2"], ...]

    def quantile(self, share: float) -> float:
        """Returns the seconds within which a share arrives; infinite where fewer do."""
        return float(np.sort(self.times)[min(int(np.ceil(share * len(self.times))), len(self.times)) - 1])


def roll_out(
    policy: FeedbackPolicy,
    *,
    trim: int,
    goal: tuple[float, float],
    count: int,
    rng: np.random.Generator,
    latency: float = 0.0,
    tracks: int = 0,
) -> Rollouts:
    """Returns rollouts from one state.

    Args:
        policy: flown.
        trim: id of the trim held.
        goal: forward and side of the goal as seen from the vehicle, in metres.
        count: number of rollouts.
        rng: of all chance.
        latency: seconds of a coast at the start and after every maneuver, before the decision is acted on.
        tracks: number of rollouts of which the way is kept.

    Raises:
        UnknownTrimError: the library lacks the trim.
    """
    policy.library.trim(trim)
    fleet = _Fleet(policy, trim, goal, count, rng=rng, latency=latency, tracks=tracks)
    while len(fleet.flying):
        fleet.step()
    return fleet.rollouts()


class _Fleet:
    """Rollouts under way."""

    def __init__(
        self,
        policy: FeedbackPolicy,
        trim: int,
        goal: tuple[float, float],
        count: int,
        *,
        rng: np.random.Generator,
        latency: float,
        tracks: int,
    ) -> None:
        problem = policy.table.problem
        self._policy, self._latency, self._problem = policy, latency, problem
        self._law = _FlightLaw(policy.library, count, rng)
        place = problem.trims.index(trim)
        self._trims = np.full(count, place)
        self._goals = np.tile(np.array(goal, dtype=float), (count, 1))
        self._heading = np.zeros(count)
        self._start = np.array(goal, dtype=float)
        self._times, self._coasted = np.zeros(count), np.zeros(count)
        self._previous = np.full(count, -1)
        self._velocity = self._law.velocities(place, np.arange(count))
        self._walks = [[trim] for _ in range(count)]
        self._tracks = [[(0.0, 0.0)] for _ in range(tracks)]
        self._reached = (np.hypot(*self._goals.T) <= problem.tolerance) & problem.ends[place]
        self.flying = np.flatnonzero(~self._reached)
        if latency and len(self.flying):
            self._coast(self.flying, latency)
            self.flying = np.flatnonzero(~self._reached)

    def step(self) -> None:
        """Flies one decision of every rollout under way."""
        states = self._states(self.flying)
        chosen, _ = self._policy.choices(states)
        keys = states.trims * self._policy.table.most_actions + chosen
        for key in np.unique(keys):
            rows = self.flying[keys == key]
            action = self._policy.action(
                int(self._trims[rows[0]]), int(key) % self._policy.table.most_actions
            )
            if action.maneuver is None:
                self._coast(rows, DECISION_INTERVAL)
            else:
                self._perform(rows, action.maneuver, action.to, arrives=action.arrives)
        for number in self.flying[self.flying < len(self._tracks)].tolist():
            self._tracks[number].append(self._position(number))
        done = self._reached[self.flying] | (self._times[self.flying] >= GIVEN_UP)
        self.flying = self.flying[~done]

    def rollouts(self) -> Rollouts:
        """Returns what was flown."""
        times = np.where(self._reached, self._times, inf)
        return Rollouts(times, tuple(map(tuple, self._walks)), tuple(np.array(one) for one in self._tracks))

    def _states(self, rows: Int[np.ndarray, "m"]) -> States:
        trims = self._trims[rows]
        offset = self._velocity[rows] - self._law.commands[trims]
        return States(trims, self._goals[rows], self._coasted[rows], self._previous[rows], offset)

    def _coast(self, rows: Int[np.ndarray, "m"], time: float) -> None:
        place = int(self._trims[rows[0]])
        velocity = self._velocity[rows]
        path = _arcs(velocity, np.linspace(0.0, time, _CHORDS + 1))
        duration = np.full(len(rows), time)
        self._move(rows, duration, path, velocity[:, 2] * time, arrives=self._problem.ends[place])
        self._coasted[rows] += time
        self._velocity[rows] = self._law.later_velocities(place, rows, velocity, time)

    def _perform(self, rows: Int[np.ndarray, "m"], number: int, to: int, *, arrives: bool) -> None:
        values, path = self._law.outcomes(number, rows, self._states(rows))
        self._trims[rows] = to
        self._coasted[rows], self._previous[rows] = 0.0, number
        self._velocity[rows] = self._law.velocities(to, rows)
        self._move(rows, values[:, 0], path, values[:, 3], arrives=arrives)
        for row in rows.tolist():
            self._walks[row].append(self._problem.trims[to])
        left = rows[~self._reached[rows]]
        if self._latency and len(left):
            self._coast(left, self._latency)

    def _move(
        self,
        rows: Int[np.ndarray, "m"],
        duration: Float[np.ndarray, "m"],
        path: Float[np.ndarray, "m points 2"],
        turn: Float[np.ndarray, "m"],
        *,
        arrives: bool,
    ) -> None:
        """Moves rollouts along paths; judges the passage and the end."""
        share = (
            _entries(path, self._goals[rows], self._problem.tolerance) if arrives else np.full(len(rows), inf)
        )
        self._times[rows] += duration * np.minimum(share, 1.0)
        left = self._goals[rows] - path[:, -1]
        cosine, sine = np.cos(turn), np.sin(turn)
        self._goals[rows] = np.column_stack(
            [cosine * left[:, 0] + sine * left[:, 1], cosine * left[:, 1] - sine * left[:, 0]]
        )
        self._heading[rows] += turn
        inside = np.hypot(*self._goals[rows].T) <= self._problem.tolerance
        ends = np.array(self._problem.ends)[self._trims[rows]]
        self._reached[rows] = (share <= 1.0) | (inside & ends)

    def _position(self, number: int) -> tuple[float, float]:
        """Returns where a rollout is, as seen from its start."""
        cosine, sine = np.cos(self._heading[number]), np.sin(self._heading[number])
        x, y = self._goals[number]
        return float(self._start[0] - cosine * x + sine * y), float(self._start[1] - sine * x - cosine * y)


class _FlightLaw:
    """The full law of a library for a number of flights."""

    def __init__(self, library: Library, flights: int, rng: np.random.Generator) -> None:
        law = transition_law(library)
        self._rng, self._library = rng, library
        self._coasts = law.trims
        self._maneuvers = dict(zip((one.id for one in library.maneuvers), law.maneuvers, strict=True))
        self._identified = {one.id: one for one in library.maneuvers}
        self._flight = rng.integers(0, 2**31, size=flights)
        self._performed: dict[int, Bool[np.ndarray, "flights"]] = {
            one.id: np.zeros(flights, dtype=bool) for one in library.maneuvers
        }
        self.commands = np.array(
            [[one.velocity.forward, one.velocity.side, one.velocity.yaw_rate] for one in library.trims]
        )
        self._shared = [
            self._shared_velocity(one.law, coast) for one, coast in zip(library.trims, law.trims, strict=True)
        ]

    def velocities(self, place: int, rows: Int[np.ndarray, "m"]) -> Float[np.ndarray, "m 3"]:
        """Returns velocities at the beginning of coasts."""
        coast, shared = self._coasts[place], self._shared[place]
        if shared is None:
            return self._rng.multivariate_normal(coast.mean, coast.covariance, len(rows))
        return np.asarray(shared[rows] + coast.within * self._rng.standard_normal((len(rows), 3)))

    def later_velocities(
        self, place: int, rows: Int[np.ndarray, "m"], velocity: Float[np.ndarray, "m 3"], duration: float
    ) -> Float[np.ndarray, "m 3"]:
        """Returns velocities later in the same coasts."""
        coast, shared = self._coasts[place], self._shared[place]
        if shared is None:
            return velocity
        kept = np.exp(-duration / coast.correlation_time)
        fresh = coast.within * np.sqrt(1 - kept**2) * self._rng.standard_normal(velocity.shape)
        return np.asarray(shared[rows] + kept * (velocity - shared[rows]) + fresh)

    def outcomes(
        self, number: int, rows: Int[np.ndarray, "m"], states: States
    ) -> tuple[Float[np.ndarray, "m 4"], Float[np.ndarray, "m points 2"]]:
        """Returns values and paths of a maneuver."""
        moved, law = self._maneuvers[number], self._identified[number].law
        if law is None:
            values = self._rng.multivariate_normal(moved.mean, moved.covariance, len(rows))
        else:
            known = np.array(law.deviations if law.entry is None else law.entry.deviations)
            again = self._performed[number][rows]
            row = np.where(
                again, self._rng.integers(0, len(known), len(rows)), self._flight[rows] % len(known)
            )
            shift = entry_shift(self._identified[number], states, np.arange(len(rows)))
            values = moved.mean + shift + known[row]
            self._performed[number][rows] = True
        values[:, 0] = np.maximum(values[:, 0], 0.0)
        return values, _paths(moved, values)

    def _shared_velocity(
        self, law: TrimLaw | None, coast: CoastDistribution
    ) -> Float[np.ndarray, "flights 3"] | None:
        if law is None:
            return None
        known = np.array(law.deviations)
        return np.asarray(coast.mean + known[self._flight % len(known)])


def _paths(moved: ManeuverDistribution, values: Float[np.ndarray, "m 4"]) -> Float[np.ndarray, "m points 2"]:
    share = np.linspace(0.0, 1.0, len(moved.path))[None, :, None]
    return np.asarray(moved.path[None, :, :2] + share * (values[:, None, 1:3] - moved.mean[1:3]))


def _arcs(
    velocity: Float[np.ndarray, "m 3"], times: Float[np.ndarray, "points"]
) -> Float[np.ndarray, "m points 2"]:
    """Returns positions on arcs of constant velocity."""
    turn = velocity[:, 2:3] * times
    along = times * np.sinc(turn / np.pi)
    across = times * np.sin(0.5 * turn) * np.sinc(0.5 * turn / np.pi)
    forward = velocity[:, 0:1] * along - velocity[:, 1:2] * across
    return np.stack([forward, velocity[:, 0:1] * across + velocity[:, 1:2] * along], axis=2)


def _entries(
    path: Float[np.ndarray, "m points 2"], goals: Float[np.ndarray, "m 2"], tolerance: float
) -> Float[np.ndarray, "m"]:
    """Returns the share of each path at its entry into the tolerance."""
    offset, way = path[:, :-1] - goals[:, None], np.diff(path, axis=1)
    a, b = (way**2).sum(axis=2), (offset * way).sum(axis=2)
    c = (offset**2).sum(axis=2) - tolerance**2
    meets = (b < 0) & (b * b >= a * c)
    share = np.where(meets, (-b - np.sqrt(np.maximum(b * b - a * c, 0.0))) / np.where(a > 0, a, 1.0), inf)
    share = np.where(c <= 0, 0.0, np.where(share <= 1, share, inf))
    chord = np.arange(share.shape[1])
    return np.asarray(((chord + share) / share.shape[1]).min(axis=1))
