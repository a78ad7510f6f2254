"""What to fly for trends: trims over the range of speeds and yaw rates, and steps between neighbours.

Two campaigns (thesis, 3.3). `straight`: straight flight in steps of 8 ft/s up to 80 ft/s. `turns`: at one
speed in steps of 0.1 rad/s, and, for a library to be grown from, at slower and faster speeds with steps of
both kinds at once and of several sizes. Only the first goes to 80 ft/s: they are flown apart.
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
"""Of the thesis's Figure 8, m/s."""
FASTEST = 10
"""The fastest straight flight, in steps: 80 ft/s."""
TURNING_SPEED = 8 * FOOT
"""At which the yaw rate rises in steps of 0.1 rad/s, m/s."""

# A step is flown where its parts, of 8 ft/s and of 0.2 rad/s, sum to no more than this: both at once in half.
_FURTHEST = 1.25
_DWELL, _TIMEOUT = 1.0, 15.0
# Of a maneuver, where it has not been flown: the thesis's settling time, s.
_DURATION = 4.0

GridPoint = tuple[float, float]
"""Forward speed in feet per second and yaw rate in rad/s: round numbers."""


def straight_automaton(*, wind: str, altitude: float) -> Library:
    """Returns trims and maneuvers of straight flight with their maneuver-end rule; numbers by kinematics."""
    return _automaton("trends-straight", sorted(set(_straight_points())), wind=wind, altitude=altitude)


def turns_automaton(*, wind: str, altitude: float) -> Library:
    """Returns trims and maneuvers of turning flight with their maneuver-end rule; numbers by kinematics."""
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
    # Between the grid's points, so that steps of half the size are flown as well.
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
    """Returns the half widths around a trim, wider than its scatter in wind class `gtmax`.

    No wider than that, because a coast begins with whatever step is left inside the band. Turns are held less
    firmly; and the faster the flight, the more a gust turns the nose and, with it, the
    velocity.
    """
    turning = abs(velocity.yaw_rate * velocity.forward)
    fast = max(0.0, velocity.forward - 8.0)
    return Band(
        forward=round(0.3 + 0.05 * turning + 0.01 * fast, 4),
        side=round(0.45 + 0.08 * turning + 0.05 * fast, 4),
        yaw_rate=round(0.07 + 0.06 * abs(velocity.yaw_rate) + 0.01 * fast, 4),
    )
