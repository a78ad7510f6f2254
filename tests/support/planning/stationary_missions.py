"""Missions around plans that satisfy the first-order conditions of least time.

With a multiplier m every coast k has Re(conj(m) e_k) = -1 - mu r_k, where e_k is the velocity with which its
time moves the end, and mu the worth of a radian at a heading limit. Straight coasts meet it by their heading,
turns by where the maneuver after them leads. Many of these plans are the best ones there are.
"""

from cmath import exp, phase
from dataclasses import replace
from math import acos, inf, pi

import numpy as np

from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.se2 import SE2

EXACT = ManeuverError(0.0, 0.0, 0.0, 0.0)

Built = tuple[Library, Mission, tuple[int, ...], tuple[float, ...]]
"""Library, mission, and the walk and times of the plan."""


def stationary_case(library: Library, rng: np.random.Generator) -> Built | None:
    """Returns the library with maneuvers along a path through its trims, and a mission; None where none fits.

    Args:
        library: what is drawn.
        rng: for the rest.
    """
    path = _path(library, rng)
    if len(path) < 2:
        return None
    speeds = [trim.velocity.speed for trim in path]
    slowest = min(speed for trim, speed in zip(path, speeds, strict=True) if _needs_speed(trim, path))
    worth = 1 / (slowest * float(rng.uniform(0.3, 0.999)))
    vector = worth * exp(1j * float(rng.uniform(-pi, pi)))
    fastest = max(abs(trim.velocity.yaw_rate) for trim in path)
    radian = float(rng.normal()) / fastest if fastest and rng.random() < 0.3 else 0.0
    scale = 1 / fastest if fastest > 1e-3 * max(speeds) else float(rng.uniform(1, 10)) / max(speeds)
    times = [_time(trim, scale * float(rng.choice([0.5, 2.0, 5.0])), rng) for trim in path]
    headings = _headings(path, vector, radian, rng)
    if headings is None:
        return None
    steps, rest = _steps(path, times, headings, (vector, radian), library, rng)
    size = max(max(speeds) * sum(times), 1e-300)
    if max(abs(complex(one.displacement.x, one.displacement.y)) for one in steps) > 20 * size:
        return None
    return _mission(library, path, times, steps, headings, (vector, radian), abs(rest), rng)


def _path(library: Library, rng: np.random.Generator) -> list[Trim]:
    useful = [trim for trim in library.trims if trim.velocity.speed > 0]
    order = [useful[place] for place in rng.permutation(len(useful))]
    return order[: int(rng.integers(2, 6))]


def _needs_speed(trim: Trim, path: list[Trim]) -> bool:
    """Returns True where a coast meets its condition by heading alone."""
    return trim is path[-1] or trim.velocity.yaw_rate == 0


def _time(trim: Trim, scale: float, rng: np.random.Generator) -> float:
    rate = abs(trim.velocity.yaw_rate)
    full = 2 * pi / rate if rate else inf
    return min(scale * float(rng.uniform(0.1, 2.0)), full * float(rng.uniform(0.05, 0.9)))


def _headings(
    path: list[Trim], vector: complex, radian: float, rng: np.random.Generator
) -> list[float] | None:
    """Returns the headings after each coast."""
    headings = []
    for trim in path:
        if not _needs_speed(trim, path):
            headings.append(float(rng.uniform(-pi, pi)))
            continue
        velocity = complex(trim.velocity.forward, trim.velocity.side)
        cosine = -(1 + radian * trim.velocity.yaw_rate) / (abs(vector) * abs(velocity))
        if abs(cosine) > 1:
            return None
        side = float(rng.choice([-1, 1]))
        headings.append(phase(vector) - phase(velocity) + side * acos(cosine))
    return headings


def _steps(
    path: list[Trim],
    times: list[float],
    headings: list[float],
    worth: tuple[complex, float],
    library: Library,
    rng: np.random.Generator,
) -> tuple[list[Maneuver], complex]:
    """Returns the maneuvers along the path, and the way from the end of the first coast to the end."""
    vector, radian = worth
    unit, rest = vector / abs(vector), 0j
    steps: list[Maneuver] = []
    for place in range(len(path) - 2, -1, -1):
        trim, after = path[place], path[place + 1]
        size = after.velocity.speed * times[place + 1]
        moved = complex(*rng.normal(0, 0.5 * size, 2)) if rng.random() < 0.7 else 0j
        entry = headings[place + 1] - after.velocity.yaw_rate * times[place + 1]
        chord = SE2.exp(after.velocity, times[place + 1])
        rest += exp(1j * entry) * complex(chord.x, chord.y) + exp(1j * headings[place]) * moved
        rate = trim.velocity.yaw_rate
        if rate:
            own = exp(1j * headings[place]) * complex(trim.velocity.forward, trim.velocity.side)
            needed = (-(1 + radian * rate) - (vector.conjugate() * own).real) / rate
            aside = 1j * unit * ((vector.conjugate() * 1j * rest).real - needed) / abs(vector)
            rest += aside
            moved += exp(-1j * headings[place]) * aside
        duration = float(rng.choice([0.0, 1.0])) * float(rng.uniform(0.5, 2)) * times[place]
        turn = entry - headings[place] + 2 * pi * float(rng.choice([0, 0, 0, -1, 1]))
        displacement = SE2(moved.real, moved.imag, turn)
        steps.append(Maneuver(place + 1, trim.id, after.id, duration, displacement, EXACT))
    return steps[::-1], rest


def _mission(
    library: Library,
    path: list[Trim],
    times: list[float],
    steps: list[Maneuver],
    headings: list[float],
    worth: tuple[complex, float],
    size: float,
    rng: np.random.Generator,
) -> Built:
    vector, radian = worth
    walk = tuple(trim.id for trim in path)
    kept: list[Maneuver] = []
    if rng.random() < 0.4:
        taken = {(one.from_trim, one.to_trim) for one in steps}
        kept = [one for one in library.maneuvers if (one.from_trim, one.to_trim) not in taken]
    errors = {(one.from_trim, one.to_trim): one.error for one in library.maneuvers}
    every = [
        replace(one, error=replace(errors.get((one.from_trim, one.to_trim), EXACT), duration=0.0), id=number)
        for number, one in enumerate((*steps, *(replace(one, id=0) for one in kept)), start=1)
    ]
    start = SE2(0.0, 0.0, headings[0] - path[0].velocity.yaw_rate * times[0])
    end = start
    for place, (trim, time) in enumerate(zip(path, times, strict=True)):
        if place:
            end = end @ steps[place - 1].displacement
        end = end @ SE2.exp(trim.velocity, time)
    tolerance = size * float(rng.choice([0.0, 0.01, 0.1])) if rng.random() < 0.8 else 0.0
    goal = complex(end.x, end.y) - tolerance * vector / abs(vector)
    mission = Mission("odd", start, walk[0], (goal.real, goal.imag), tolerance, max_trims=len(walk))
    if radian:
        width = float(rng.choice([0.0, 0.1, 0.5]))
        side = 1.0 if radian > 0 else -1.0
        mission = replace(mission, goal_heading=end.heading - side * width, heading_tolerance=width)
    elif rng.random() < 0.15:
        mission = replace(mission, goal_heading=end.heading, heading_tolerance=float(rng.choice([0.0, 0.3])))
    if rng.random() < 0.5:
        mission = replace(mission, goal_trim=walk[-1])
    return replace(library, maneuvers=tuple(every)), mission, walk, tuple(times)
