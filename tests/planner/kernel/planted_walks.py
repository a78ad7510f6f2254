"""Random walks with goals at which known times are stationary."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import cos, inf, pi

import numpy as np

from .walk_problem import Times, WalkProblem

LONGEST = 60.0
"""Seconds of a straight coast."""

CONSISTENT = 1e-7
"""Seconds a second by which multipliers may be inconsistent."""

HALVINGS = 60


@dataclass(frozen=True, slots=True)
class Planted:
    """A walk, stationary times, and the size of their multiplier in s/m."""

    walk: WalkProblem
    times: Times
    worth: float


def planted(rng: np.random.Generator, *, slow: float = 0.1) -> Planted | None:
    """Returns a random walk with candidate times, or None.

    Args:
        rng: of everything.
        slow: share of coasts that turn slowly.
    """
    walk = random_walk(rng, slow=slow)
    useful = [k for k in range(len(walk.rates)) if walk.velocities[k] or walk.rates[k]]
    if not useful:
        return None
    count = min(len(useful), int(rng.integers(1, 5)))
    on = sorted(rng.choice(useful, count, replace=False).tolist())
    bound = bool(rng.random() < 0.35) and any(walk.rates[k] for k in on)
    if rng.random() < 0.1 and count >= 2:
        return _at_the_edge_of_reach(rng, walk, on[:2])
    return _stationary(rng, walk, on, bound)


def random_walk(rng: np.random.Generator, *, slow: float) -> WalkProblem:
    """Returns a walk of one to seven coasts.

    Rates may be equal, slow or 0; velocities may be sideways; maneuvers may lead nowhere.
    """
    count = int(rng.integers(1, 6)) if rng.random() < 0.9 else int(rng.integers(5, 8))
    base = float(rng.choice([-1, 1]) * rng.uniform(0.05, 0.8))
    rates = [_rate(rng, base, slow) for _ in range(count)]
    velocities = [_velocity(rng) for _ in range(count)]
    if rng.random() < 0.2:
        rates[-1], velocities[-1] = rates[0], velocities[0]
    if count > 1 and rng.random() < 0.1:
        # Turns that lead into straight lines at equal speed, with nothing between.
        rates = [rate if place % 2 == count % 2 else 0.0 for place, rate in enumerate(rates)]
        velocities = velocities[:1] * count
        if rng.random() < 0.5:
            velocities[0] = _velocity(rng)
        return WalkProblem(tuple(velocities), tuple(rates))
    kind = rng.random()
    moved = [complex(*rng.uniform(-3, 3, 2)) if kind > 0.3 else 0j for _ in range(count - 1)]
    turned = [float(rng.uniform(-1, 1)) if kind > 0.45 else 0.0 for _ in range(count - 1)]
    return WalkProblem(tuple(velocities), tuple(rates), tuple(moved), tuple(turned))


def _rate(rng: np.random.Generator, base: float, slow: float) -> float:
    kind, sign = rng.random(), float(rng.choice([-1, 1]))
    if kind < 0.35:
        return 0.0
    if kind < 0.6:
        return float(base if kind < 0.55 else -base)
    if kind < 0.6 + slow:
        return float(sign * 10.0 ** float(rng.uniform(-7, -2)))
    return sign * float(rng.uniform(0.03, 0.8))


def _velocity(rng: np.random.Generator) -> complex:
    kind = rng.random()
    if kind < 0.5:
        return complex(rng.uniform(0.5, 6), 0)
    if kind < 0.75:
        return complex(rng.uniform(-4, 6), rng.uniform(-3, 3))
    if kind < 0.8:
        return 0j
    return complex(3, 0) if kind < 0.92 else complex(-rng.uniform(0.5, 3), 0)


def _random_times(rng: np.random.Generator, walk: WalkProblem, on: list[int]) -> list[float]:
    times = [0.0] * len(walk.rates)
    for k in on:
        times[k] = min(
            float(rng.exponential(rng.choice([1, 5, 20]))), _longest(walk, k) * float(rng.random())
        )
    return times


def _longest(walk: WalkProblem, place: int) -> float:
    return min(2 * pi / abs(walk.rates[place]) if walk.rates[place] else inf, LONGEST)


def _stationary(rng: np.random.Generator, walk: WalkProblem, on: list[int], bound: bool) -> Planted | None:
    """Moves one time until multipliers exist for all of them."""
    equations = 2 + bound
    on = on[: equations + 1]
    times = _random_times(rng, walk, on)
    if len(on) > equations:
        moved = int(rng.choice(on))

        def excess(time: float) -> float:
            times[moved] = time
            return float(np.linalg.det(np.column_stack([_rows(walk, times, on, bound), np.ones(len(on))])))

        if not _move_to_root(rng, times, moved, _longest(walk, moved), excess):
            return None
    rows = _rows(walk, times, on, bound)
    found = np.linalg.lstsq(rows, -np.ones(len(on)), rcond=None)[0]
    if np.abs(rows @ found + 1).max() > CONSISTENT:
        return None
    if len(on) < equations:
        beside = np.linalg.svd(rows)[2][len(on) :]
        found = found + np.linalg.norm(found) * rng.normal(size=len(beside)) @ beside
    return _goal_at(rng, walk, times, complex(found[0], found[1]), bound)


def _at_the_edge_of_reach(rng: np.random.Generator, walk: WalkProblem, on: list[int]) -> Planted | None:
    """Moves one of two times until both move the end in parallel."""
    times, moved = _random_times(rng, walk, on), int(rng.choice(on))

    def aside(time: float) -> float:
        times[moved] = time
        one, two = walk.end_velocities(tuple(times))[on]
        return float((np.conj(one) * two).imag)

    if not _move_to_root(rng, times, moved, _longest(walk, moved), aside):
        return None
    outward = 1j * complex(walk.end_velocities(tuple(times))[on[0]])
    found = _goal_at(rng, walk, times, outward * float(rng.choice([-1, 1])), False)
    return found and replace(found, worth=inf)


def _rows(walk: WalkProblem, times: list[float], on: list[int], bound: bool) -> np.ndarray:
    velocity = walk.end_velocities(tuple(times))[on]
    columns = [velocity.real, velocity.imag] + ([np.array(walk.rates)[on]] if bound else [])
    return np.column_stack(columns)


def _move_to_root(
    rng: np.random.Generator, times: list[float], moved: int, longest: float, f: Callable[[float], float]
) -> bool:
    samples = np.linspace(0, longest, 20)
    values = [f(sample) for sample in samples]
    changes = [k for k in range(len(samples) - 1) if values[k] * values[k + 1] < 0]
    if not changes:
        return False
    k = int(rng.choice(changes))
    low, high = samples[k], samples[k + 1]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if f(middle) * values[k] > 0:
            low = middle
        else:
            high = middle
    times[moved] = float(0.5 * (low + high))
    return True


def _goal_at(
    rng: np.random.Generator, walk: WalkProblem, times: list[float], multiplier: complex, bound: bool
) -> Planted | None:
    """Places the goal a tolerance from the end, along the multiplier."""
    tolerance = 0.0 if rng.random() < 0.4 else 10.0 ** float(rng.uniform(-4, 0.7))
    end, heading = walk.end(tuple(times))
    if tolerance:
        if not abs(multiplier):
            return None
        end -= tolerance * multiplier / abs(multiplier)
    asked = replace(walk, goal=complex(end), tolerance=tolerance)
    if bound:
        width = 0.0 if rng.random() < 0.5 else 10.0 ** float(rng.uniform(-3, 0))
        side = float(rng.choice([-1, 1])) * width
        asked = replace(asked, heading=heading + side, heading_tolerance=width)
    elif rng.random() < 0.2:
        width = float(rng.uniform(0.01, 1))
        off = 0.9 * width * cos(float(rng.uniform(0, pi)))
        asked = replace(asked, heading=heading + off, heading_tolerance=width)
    return Planted(asked, tuple(times), abs(multiplier))
