"""Check of committed plans over the whole gamma interval, independent of search.

Position and heading are carried along the walk together with their slopes over the level gamma. On a piece of
levels the end is then its tangent at the middle, give or take half the largest second derivative times the
square of the half width; pieces are halved until each is decided.
"""

from cmath import exp
from math import pi, remainder

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.plan.plan import Plan

SMALL_TURN = 1e-2
"""Radians below which the chord of a turn is taken from its series."""

NARROWEST = 1e-9
"""Share of the interval below which a piece is not halved; undecided pieces count as faults."""

SAME_TIMES = "coasting_times: expected the same at every gamma of a committed plan"


def committed_problems(plan: Plan, library: Library, mission: Mission) -> list[str]:
    """Returns the faults of a committed plan between -gamma and gamma.

    Args:
        plan: with a walk that the library has.
        library: the one it was planned with.
        mission: the one it was planned for.
    """
    times = plan.coasting_times
    if any(scenario.coasting_times != times for scenario in plan.scenarios):
        return [SAME_TIMES]
    trims = [library.trim(trim) for trim in plan.sequence]
    steps = list(library.maneuvers_along(plan.sequence))
    found = []
    if plan.miss is None or plan.miss > mission.destination.reach:
        found.append(f"miss: allowed {mission.tolerance} m at every gamma, stated {plan.miss} m")
        return found
    position = complex(mission.start.x, mission.start.y)
    walk = _Flight(trims, steps, times, position, mission.start.heading)
    worst = walk.level_beyond(complex(*mission.goal), plan.miss, plan.gamma)
    if worst is not None:
        found.append(f"goal: not shown to be within {plan.miss:.9g} m near gamma {worst:.9g}")
    if mission.goal_heading is not None and mission.destination.wants_heading:
        off = walk.heading_error(mission.goal_heading, plan.gamma)
        if not off <= mission.destination.heading_reach:
            found.append(
                f"goal heading: off by {off:.6g} rad at some gamma, allowed {mission.heading_tolerance} rad"
            )
    return found


class _Flight:
    """A walk with its coasting times, from a start, at any level."""

    def __init__(
        self,
        trims: list[Trim],
        steps: list[Maneuver],
        times: tuple[float, ...],
        start: complex,
        heading: float,
    ) -> None:
        self._trims, self._steps, self._times = trims, steps, times
        self._start, self._heading = start, heading

    def level_beyond(self, goal: complex, allowed: float, gamma: float) -> float | None:
        """Returns a level that may exceed the allowed miss, or None."""
        if gamma == 0:
            return None if abs(self._end(0.0)[0] - goal) <= allowed else 0.0
        curvature = self._curvature(gamma)
        pieces = [(0.0, gamma)]
        while pieces:
            middle, half = pieces.pop()
            end, slope = self._end(middle)
            off = end - goal
            if abs(off) > allowed:
                return middle
            furthest = max(abs(off + slope * half), abs(off - slope * half))
            if furthest + 0.5 * curvature * half * half <= allowed:
                continue
            if half < NARROWEST * gamma:
                return middle
            pieces += [(middle - half / 2, half / 2), (middle + half / 2, half / 2)]
        return None

    def heading_error(self, wanted: float, gamma: float) -> float:
        """Returns the largest heading error in radians over all levels.

        The heading changes evenly from one end of the interval to the other: where it passes through more
        than a turn, every heading is met.
        """
        nominal = self._heading + sum(step.displacement.heading for step in self._steps)
        nominal += sum(trim.velocity.yaw_rate * time for trim, time in self._held)
        error = sum(step.error.heading_change for step in self._steps)
        error += sum(trim.error.yaw_rate * time for trim, time in self._held)
        return min(abs(remainder(nominal - wanted, 2 * pi)) + gamma * abs(error), pi)

    @property
    def _held(self) -> list[tuple[Trim, float]]:
        return list(zip(self._trims, self._times, strict=True))

    def _end(self, gamma: float) -> tuple[complex, complex]:
        """Returns the end and its slope over the level."""
        position, moving = self._start, 0j
        heading, turning = self._heading, 0.0
        for place, (trim, time) in enumerate(self._held):
            if place:
                step = self._steps[place - 1]
                outcome = step.at(gamma)
                moved = complex(outcome.displacement.x, outcome.displacement.y)
                error = complex(step.error.forward, step.error.side)
                facing = exp(1j * heading)
                position += facing * moved
                moving += facing * (error + 1j * turning * moved)
                heading += outcome.displacement.heading
                turning += step.error.heading_change
            held = trim.at(gamma)
            velocity = complex(held.forward, held.side)
            error = complex(trim.error.forward, trim.error.side)
            chord, bending = _mean_direction(held.yaw_rate * time)
            coast = velocity * time * chord
            bent = error * time * chord + velocity * time * bending * trim.error.yaw_rate * time
            facing = exp(1j * heading)
            position += facing * coast
            moving += facing * (bent + 1j * turning * coast)
            heading += held.yaw_rate * time
            turning += trim.error.yaw_rate * time
        return position, moving

    def _curvature(self, gamma: float) -> float:
        """Returns a bound of the end's second derivative over level, in metres.

        Every piece of the way, turned by its heading, contributes twice the heading's slope times its own
        slope, and the square of the heading's slope times itself.
        """
        total, turning = 0.0, 0.0
        for place, (trim, time) in enumerate(self._held):
            if place:
                step = self._steps[place - 1]
                error = abs(complex(step.error.forward, step.error.side))
                way = abs(complex(step.displacement.x, step.displacement.y)) + gamma * error
                total += abs(turning) * (2 * error + abs(turning) * way)
                turning += step.error.heading_change
            after = turning + trim.error.yaw_rate * time
            most = max(abs(turning), abs(after))
            error = abs(complex(trim.error.forward, trim.error.side))
            speed = abs(complex(trim.velocity.forward, trim.velocity.side)) + gamma * error
            total += time * most * (2 * error + most * speed)
            turning = after
        return total


def _mean_direction(turn: float) -> tuple[complex, complex]:
    """Returns the mean of exp(i s) over a turn and its slope."""
    if abs(turn) < SMALL_TURN:
        x = 1j * turn
        value = 1 + x / 2 + x**2 / 6 + x**3 / 24 + x**4 / 120 + x**5 / 720
        slope = 1j * (1 / 2 + x / 3 + x**2 / 8 + x**3 / 30 + x**4 / 144 + x**5 / 840)
        return value, slope
    value = (exp(1j * turn) - 1) / (1j * turn)
    return value, (exp(1j * turn) - value) / turn
