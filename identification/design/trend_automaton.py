"""Automata for trends: trims over speeds and yaw rates, steps between neighbours.

Two campaigns (thesis, 3.3). `straight`: straight flight in steps of 8 ft/s up to 80 ft/s. `turns`: at one
speed in steps of 0.1 rad/s, and, as a basis for interpolation, at slower and faster speeds with combined
steps of several sizes. Only the first reaches 80 ft/s, so they are separate campaigns.
"""

from collections.abc import Iterator
from itertools import combinations

from flight.automaton.conditions import Conditions
from flight.automaton.library import Library
from flight.automaton.maneuver_end import Band, ManeuverEnd
from flight.automaton.trim import Trim
from flight.se2 import Twist
from flight.units import FOOT

from .kinematic_library import kinematic_maneuver

SPEED_STEP = 8 * FOOT
"""Speed step of the thesis's Figure 8, m/s."""
FASTEST = 10
"""Fastest straight flight, in steps: 80 ft/s."""
TURNING_SPEED = 8 * FOOT
"""Speed of the yaw rate series in steps of 0.1 rad/s, m/s."""

# Largest sum of a step's parts, in units of 8 ft/s and 0.2 rad/s; combined steps are thus at most half size.
_FURTHEST = 1.25
_DWELL, _TIMEOUT = 1.0, 15.0
# Assumed duration of a maneuver before identification: the thesis's settling time, s.
_DURATION = 4.0

GridPoint = tuple[float, float]
"""Forward speed in ft/s and yaw rate in rad/s."""


def straight_automaton(*, wind: str, altitude: float) -> Library:
    """Returns the kinematic library of straight flight."""
    return _automaton("trends-straight", sorted(set(_straight_points())), wind=wind, altitude=altitude)


def turns_automaton(*, wind: str, altitude: float) -> Library:
    """Returns the kinematic library of turning flight."""
    return _automaton(
        "trends-turns", sorted(set(_turning_points()) | set(_grid())), wind=wind, altitude=altitude
    )


def _automaton(name: str, places: list[GridPoint], *, wind: str, altitude: float) -> Library:
    trims = tuple(
        Trim(number, _name(*place), _velocity(place), Twist(0.0, 0.0, 0.0))
        for number, place in enumerate(places, start=1)
    )
    joined = sorted(
        edge
        for (a, one), (b, two) in combinations(enumerate(places, start=1), 2)
        if _are_neighbours(one, two)
        for edge in ((a, b), (b, a))
    )
    by_id = {trim.id: trim for trim in trims}
    rule = ManeuverEnd({trim.id: _band(trim.velocity) for trim in trims}, _DWELL, _TIMEOUT)
    return Library(
        name=name,
        description="Trims over a range of speeds and yaw rates, joined to their neighbours, by kinematics.",
        vehicle="any",
        trims=trims,
        maneuvers=tuple(
            kinematic_maneuver(number, by_id[edge[0]], by_id[edge[1]], duration=_DURATION, duration_error=0.0)
            for number, edge in enumerate(joined, start=1)
        ),
        conditions=Conditions(wind, altitude, rule, "instantaneous"),
    )


def _straight_points() -> Iterator[GridPoint]:
    for step in range(FASTEST + 1):
        yield 8.0 * step, 0.0


def _turning_points() -> Iterator[GridPoint]:
    for tenth in range(-6, 7):
        yield 8.0, tenth / 10


def _grid() -> Iterator[GridPoint]:
    for speed in (0.0, 8.0, 16.0, 24.0):
        for tenth in (-6, -4, -2, 0, 2, 4, 6):
            if speed < 24 or abs(tenth) <= 4:
                yield speed, tenth / 10
    # Points between the grid's, for steps of half the size.
    for speed in (4.0, 12.0, 20.0):
        for tenth in (-3, -1, 1, 3):
            yield speed, tenth / 10


def _are_neighbours(one: GridPoint, two: GridPoint) -> bool:
    return abs(two[0] - one[0]) / 8 + abs(two[1] - one[1]) / 0.2 <= _FURTHEST


def _velocity(place: GridPoint) -> Twist:
    return Twist(place[0] * FOOT, 0.0, place[1])


def _name(speed: float, yaw_rate: float) -> str:
    straight = f"{speed:g} ft/s" if speed else "hover"
    if not yaw_rate:
        return straight
    return f"{straight}, {'right' if yaw_rate > 0 else 'left'} {abs(yaw_rate):g} rad/s"


def _band(velocity: Twist) -> Band:
    """Returns a trim's band, just wider than its scatter in `gtmax` wind.

    A wider band would leave a larger residual step at the start of a coast. Scatter is larger in turns, and
    grows with speed, because a gust turns the nose and with it the velocity.
    """
    turning = abs(velocity.yaw_rate * velocity.forward)
    fast = max(0.0, velocity.forward - 8.0)
    return Band(
        forward=round(0.3 + 0.05 * turning + 0.01 * fast, 4),
        side=round(0.45 + 0.08 * turning + 0.05 * fast, 4),
        yaw_rate=round(0.07 + 0.06 * abs(velocity.yaw_rate) + 0.01 * fast, 4),
    )
