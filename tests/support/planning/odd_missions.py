"""Missions drawn by chance whose goals were placed where some plan ends, often on the very edge."""

from dataclasses import dataclass, replace
from math import cos, inf, pi, sin

import numpy as np

from flight.automaton.library import Library
from flight.mission.mission import Mission
from flight.se2 import SE2

from .odd_libraries import odd_library
from .stationary_missions import stationary_case

MOST_WALKS = 60
"""Walks of a mission."""

STATIONARY = 0.35
"""Share of missions that are built around a plan without a small change that saves time."""

FARTHEST = 9e5
"""Metres north or east, as files allow."""


@dataclass(frozen=True, slots=True)
class OddCase:
    """A library and a mission, and a plan that is known to end at the goal at level 0.

    Attributes:
        library: the primitives.
        mission: from where to where.
        gamma: level to plan for.
        walk: trim ids of the known plan.
        times: its seconds in each trim.
    """

    library: Library
    mission: Mission
    gamma: float
    walk: tuple[int, ...]
    times: tuple[float, ...]


def odd_case(seed: int, number: int) -> OddCase:
    """Returns a library, a mission and a level by chance; the same for the same seed and number."""
    rng = np.random.default_rng([seed, number])
    while True:
        library = odd_library(rng)
        case = _case(library, rng)
        if max(map(abs, (*case.mission.goal, case.mission.tolerance))) <= FARTHEST:
            return case


def _case(library: Library, rng: np.random.Generator) -> OddCase:
    if rng.random() < STATIONARY:
        built = stationary_case(library, rng)
        if built is not None and walks_up_to(built[0], built[1].start_trim, built[1].max_trims) <= MOST_WALKS:
            return OddCase(built[0], built[1], _gamma(rng), *built[2:])
    wanted = int(rng.choice([1, 2, 3, 4, 5], p=[0.1, 0.15, 0.35, 0.3, 0.1]))
    trims = [trim.id for trim in library.trims]
    deepest = max(_reaches(library, trim, wanted) for trim in trims)
    if rng.random() < 0.7:
        trims = [trim for trim in trims if _reaches(library, trim, wanted) == deepest]
    start_trim = int(rng.choice(trims))
    most = _depth(library, start_trim, wanted)
    walk = _walk(library, start_trim, most, rng)
    times = _times(library, walk, rng)
    start = SE2.identity()
    if rng.random() < 0.6:
        size = max(abs(value) for trim in library.trims for value in (trim.velocity.forward, 1e-4))
        start = SE2(float(rng.normal(0, 5 * size)), float(rng.normal(0, 5 * size)), float(rng.uniform(-7, 7)))
    if rng.random() < 0.2:
        times = tuple(float(round(time)) for time in times)
    end = start
    for place, (trim, time) in enumerate(zip(walk, times, strict=True)):
        if place:
            end = end @ library.maneuver(walk[place - 1], trim).displacement
        end = end @ SE2.exp(library.trim(trim).velocity, time)
    gamma = _gamma(rng)
    mission = Mission("odd", start, start_trim, end.position, max_trims=most)
    mission = _placed(mission, end, library, walk, rng)
    mission = _headed(mission, end, rng)
    if rng.random() < 0.3:
        mission = replace(mission, goal_trim=walk[-1])
    elif rng.random() < 0.05:
        mission = replace(mission, goal_trim=int(rng.choice([trim.id for trim in library.trims])))
    return OddCase(library, mission, gamma, walk, times)


def _reaches(library: Library, start_trim: int, wanted: int) -> int:
    """Returns the trims in the longest walk from a trim, up to so many."""
    ends, depth = {start_trim}, 1
    while depth < wanted:
        ends = {onward for trim in ends for onward in library.successors(trim)}
        if not ends:
            break
        depth += 1
    return depth


def _gamma(rng: np.random.Generator) -> float:
    return float(rng.choice([0.1, 0.5, 1.0])) if rng.random() < 0.7 else float(rng.uniform(0, 1))


def walks_up_to(library: Library, start_trim: int, depth: int) -> int:
    """Returns how many walks of at most so many trims there are."""
    ends, walks = {start_trim: 1}, 1
    for _ in range(1, depth):
        after: dict[int, int] = {}
        for trim, many in ends.items():
            for onward in library.successors(trim):
                after[onward] = after.get(onward, 0) + many
        ends, walks = after, walks + sum(after.values())
    return walks


def _depth(library: Library, start_trim: int, wanted: int) -> int:
    """Returns the depth wanted, or the largest that has few enough walks."""
    while walks_up_to(library, start_trim, wanted) > MOST_WALKS:
        wanted -= 1
    return wanted


def _walk(library: Library, start_trim: int, most: int, rng: np.random.Generator) -> tuple[int, ...]:
    walk = [start_trim]
    while len(walk) < most and library.successors(walk[-1]) and rng.random() < 0.94:
        walk.append(int(rng.choice(library.successors(walk[-1]))))
    return tuple(walk)


def _times(library: Library, walk: tuple[int, ...], rng: np.random.Generator) -> tuple[float, ...]:
    """Returns times of which some are 0, and none is more than a full turn."""
    scale = _seconds(library) * float(rng.choice([0.5, 3.0, 10.0]))
    times = []
    for trim in walk:
        rate = abs(library.trim(trim).velocity.yaw_rate)
        time = scale * float(rng.exponential())
        full = 2 * pi / rate if rate else inf
        times.append(0.0 if rng.random() < 0.2 else min(time, 0.97 * full * float(rng.random())))
    return tuple(times)


def _seconds(library: Library) -> float:
    """Returns the seconds in which the fastest turn turns by a radian; else those of a maneuver."""
    fastest = max(abs(trim.velocity.yaw_rate) for trim in library.trims)
    longest = max((one.duration for one in library.maneuvers), default=0.0)
    if fastest > 1e-3:
        return 1 / fastest
    return longest or 1.0


def _placed(
    mission: Mission, end: SE2, library: Library, walk: tuple[int, ...], rng: np.random.Generator
) -> Mission:
    """Returns the mission with a tolerance, and the goal on its edge, inside, or at the end itself."""
    away = mission.start.distance_to(end.position) or 1.0
    kind = rng.random()
    if kind < 0.3:
        return mission
    if kind < 0.45:
        tolerance = away * 10.0 ** float(rng.uniform(-9, -2))
    elif kind < 0.9:
        tolerance = away * float(rng.choice([0.01, 0.05, 0.1]))
    else:
        tolerance = float(rng.choice([0.5, 1.0, 2.0]))
    bearing, share = float(rng.uniform(-pi, pi)), 1.0
    kind = rng.random()
    if kind < 0.3:
        # Abeam of the last coast: the disc is touched from the side.
        velocity = library.trim(walk[-1]).velocity
        drift = np.angle(complex(velocity.forward, velocity.side))
        bearing = end.heading + float(drift) + float(rng.choice([-1, 1])) * pi / 2
    elif kind < 0.6:
        share = float(rng.random())
    goal = end.x + share * tolerance * cos(bearing), end.y + share * tolerance * sin(bearing)
    if rng.random() < 0.06:
        # The start is inside, or on the edge.
        share = float(rng.choice([0.0, 0.5, 1.0]))
        goal = mission.start.x + share * tolerance, mission.start.y
    return replace(mission, goal=goal, tolerance=tolerance)


def _headed(mission: Mission, end: SE2, rng: np.random.Generator) -> Mission:
    """Returns the mission with a heading wanted, sometimes: that of the end, or another."""
    if rng.random() > 0.35:
        return mission
    width = (
        float(rng.choice([0.0, 0.0, 0.1, 0.5, 3.0]))
        if rng.random() < 0.8
        else 10.0 ** float(rng.uniform(-9, -1))
    )
    kind = rng.random()
    if kind < 0.4:
        heading = end.heading
    elif kind < 0.6:
        heading = end.heading + width * float(rng.choice([-1, 1]))
    elif kind < 0.85:
        heading = end.heading + width * float(rng.uniform(-1, 1))
    else:
        heading = float(rng.uniform(-pi, pi))
    if rng.random() < 0.2:
        heading += 2 * pi * float(rng.integers(-3, 4))
    return replace(mission, goal_heading=heading, heading_tolerance=width)
