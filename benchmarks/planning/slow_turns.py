"""Exactness of plans with slow turns.

Run by `python -m benchmarks.planning.slow_turns 1 300`; arguments: seed, seconds.

Random libraries of yaw rates from 1e-9 to 0.4 rad/s, some equal, some 0; goals near the ends of random walks,
1 m to 25 km away, tolerances of 0 to 3 m, headings wanted or not. Each walk alone: random times are moved to
the goal by Newton's method, the best of them improved by SLSQP, and the results moved to the goal again. It
shares the equations of motion with the proofs, and nothing with the search.
"""

import sys
from dataclasses import replace
from math import cos, hypot, inf, pi, sin
from time import perf_counter
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize

from benchmarks.upper_limit import upper_limit
from flight.automaton.library import Library
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.se2 import SE2, Twist
from planner.kernel.exact import ExactSearch, least_costs
from planner.kernel.tables import tables
from planner.proof.dual_bound import WalkProblems
from planner.walks.kinematics import walk_motion
from planner.walks.walk import walks

STARTS, IMPROVED = 200, 8
"""Random starts of a walk, and the number improved."""

AGREEMENT = 1e-4
"""Seconds by which another plan may be faster, ..."""

INSIDE = 2e-12
"""... and radians: a heading's tolerance is used up to half of that."""

LONGEST = 1e6
"""Seconds; plans that circle for weeks are not compared."""

FURTHEST = 2.5e4
"""Metres."""

Times = Float[np.ndarray, "trims"]


def main(seed: int, seconds: float) -> int:
    """Prints the counts; returns the number of wrong walks and searches."""
    rng, began = np.random.default_rng(seed), perf_counter()
    missions = compared = reached = same = wrong = 0
    while perf_counter() - began < seconds:
        library = _library(rng)
        mission = _mission(rng, library)
        missions += 1
        least = inf
        for table in tables(library, (0.0,), mission.start_trim, mission.max_trims, None):
            costs = least_costs(table, mission)
            least = min(least, float(costs.min()))
            for walk, cost in zip(map(tuple, table.walks.tolist()), costs.tolist(), strict=True):
                other = _least(library, walk, mission, rng)
                if min(cost, other) > LONGEST:
                    continue
                compared += 1
                reached += other < inf
                same += abs(other - cost) < AGREEMENT
                if other < cost - AGREEMENT - _heading_margin(library, walk, mission):
                    wrong += 1
                    print(
                        f"{walk}: {cost} s, but {other} s do: {library.trims} {library.maneuvers} {mission}"
                    )
        answer = ExactSearch(library, (0.0,)).answer(mission)
        if answer.exhausted and least < LONGEST and max(answer.costs, default=inf) > least + AGREEMENT:
            wrong += 1
            print(f"the search: {answer.costs} s, but a walk takes {least} s: {library} {mission}")
    print(f"{missions} missions, {compared} walks; the other search reached the goal in {reached}, ")
    print(f"  at the same cost within {AGREEMENT:g} s in {same}, and was faster, or the only one, in {wrong}")
    print(f"  (at most {100 * upper_limit(wrong, compared):.2g} % with 95 % confidence)")
    return wrong


def _library(rng: np.random.Generator) -> Library:
    trims: list[Trim] = []
    for number in range(1, int(rng.integers(2, 5)) + 1):
        kind, sign = rng.random(), float(rng.choice([-1, 1]))
        size = 0.0 if kind < 0.15 else 10 ** rng.uniform(-9, -2) if kind < 0.7 else rng.uniform(0.03, 0.4)
        rate, speed = sign * float(size), float(rng.uniform(0.5, 30)) if rng.random() < 0.9 else 0.0
        side = float(rng.uniform(-1, 1)) if rng.random() < 0.15 else 0.0
        if trims and rng.random() < 0.25:
            rate = trims[-1].velocity.yaw_rate * float(rng.choice([1, 1, -1, 0.5, 1 + 1e-7]))
        if trims and rng.random() < 0.3:
            speed = trims[-1].velocity.forward
        trims.append(Trim(number, f"trim {number}", Twist(speed, side, rate), Twist(0.0, 0.0, 0.0)))
    pairs = [(one, other) for one in trims for other in trims if one is not other]
    between = [_maneuver(rng, number, *pair) for number, pair in enumerate(pairs, start=1)]
    return Library("slow turns", "at random", "", tuple(trims), tuple(between))


def _maneuver(rng: np.random.Generator, number: int, left: Trim, reached: Trim) -> Maneuver:
    one, two, duration = left.velocity, reached.velocity, float(rng.uniform(1, 5))
    turn = 0.5 * (one.yaw_rate + two.yaw_rate) if rng.random() < 0.7 else float(rng.uniform(-0.3, 0.3))
    moved = SE2.exp(Twist(0.5 * (one.forward + two.forward), 0.5 * (one.side + two.side), turn), duration)
    if rng.random() < 0.2:
        moved = SE2(moved.x, 0.0, 0.0)
    return Maneuver(number, left.id, reached.id, duration, moved, ManeuverError(0.0, 0.0, 0.0, 0.0))


def _mission(rng: np.random.Generator, library: Library) -> Mission:
    """Returns a random mission, at or near a walk's end or anywhere."""
    distance, depth = 10 ** rng.uniform(0, 4.3), int(rng.choice([1, 2, 2, 3, 3, 3, 4]))
    trim, start = (
        int(rng.choice([trim.id for trim in library.trims])),
        SE2(0.0, 0.0, float(rng.uniform(-pi, pi))),
    )
    tolerance = float(rng.choice([0.0, 0.0, 0.01, 0.3, 1.0, 3.0]))
    every = walks(library, trim, max_trims=depth)
    numbers = walk_motion(library, every[int(rng.integers(len(every)))], 0.0)
    free = rng.random(len(numbers.velocities)) < 0.75
    end = start
    for _ in range(9):
        times = tuple(
            float(
                held
                * min(
                    distance / max(hypot(twist.forward, twist.side), 0.3) * rng.exponential(),
                    rng.uniform(0, 6) / max(abs(twist.yaw_rate), 1e-12),
                )
            )
            for held, twist in zip(free, numbers.velocities, strict=True)
        )
        end = numbers.end(start, times)
        if hypot(end.x, end.y) < FURTHEST:
            break
    kind = rng.random()
    goal, heading = end.position, end.heading
    if kind > 0.85:
        bearing = rng.uniform(-pi, pi)
        goal, heading = (distance * cos(bearing), distance * sin(bearing)), float(rng.uniform(-pi, pi))
    elif kind > 0.65:
        aside = rng.normal(size=2) * (tolerance + 1e-3 * distance)
        goal = goal[0] + float(aside[0]), goal[1] + float(aside[1])
    mission = Mission("slow turns", start, trim, goal, tolerance, max_trims=depth)
    if rng.random() > 0.35:
        return mission
    return replace(mission, goal_heading=heading, heading_tolerance=float(rng.choice([0.0, 0.01, 0.3])))


def _heading_margin(library: Library, walk: tuple[int, ...], mission: Mission) -> float:
    """Returns the seconds that a heading's margin may save."""
    rates = [abs(library.trim(trim).velocity.yaw_rate) for trim in walk]
    slowest = min((rate for rate in rates if rate), default=1.0)
    return INSIDE / slowest if mission.goal_heading is not None else 0.0


class _Walk:
    """One walk to the goal, with the mission's tolerances."""

    def __init__(self, library: Library, walk: tuple[int, ...], mission: Mission) -> None:
        self.problems, self.mission = WalkProblems.of([walk_motion(library, walk, 0.0)], mission), mission
        self.distance = hypot(*mission.goal) + 1.0
        self.turned = mission.goal_heading is not None

    def propagate(self, times: Times) -> tuple[complex, np.ndarray, float]:
        """Returns the miss, its gradient and the heading error."""
        velocity, end, psi = self.problems.propagate(times[None])
        off = float(psi[0] + self.problems.turned[0]) - (self.problems.heading or 0.0)
        return complex(end[0] - self.problems.goal), velocity[0], off - 2 * pi * round(off / (2 * pi))

    def corrected(self, times: Times, rounds: int) -> Times:
        """Returns times after repeated least-norm corrections to the goal."""
        for _ in range(rounds):
            miss, velocity, off = self.propagate(times)
            tolerance, width = self.mission.tolerance, self.mission.heading_tolerance
            rows: list[np.ndarray] = []
            wrong: list[float] = []
            if abs(miss) > tolerance > 0:
                rows.append((np.conj(miss / abs(miss)) * velocity).real)
                wrong.append(abs(miss) - tolerance * (1 - 1e-9))
            elif tolerance == 0:
                rows += [velocity.real, velocity.imag]
                wrong += [miss.real, miss.imag]
            if self.turned and abs(off) > width:
                rows.append(self.problems.rate[0])
                wrong.append(off - float(np.copysign(width, off)))
            if not rows:
                break
            step = np.linalg.lstsq(np.array(rows) * (times > 0), np.array(wrong), rcond=1e-13)[0]
            times = np.clip(times - step, 0.0, None)
        return times

    def cost(self, times: Times) -> float:
        """Returns the cost of times; infinite where they miss the goal."""
        miss, _, off = self.propagate(times)
        there = abs(miss) <= (self.mission.tolerance or 1e-9)
        if self.turned:
            there &= abs(off) <= (self.mission.heading_tolerance or 1e-12)
        return float(self.problems.fixed[0] + times.sum()) if there else inf


def _least(library: Library, walk: tuple[int, ...], mission: Mission, rng: np.random.Generator) -> float:
    one = _Walk(library, walk, mission)
    speed, longest = np.abs(one.problems.velocity[0]), one.problems.longest[0]
    fastest = max(float(speed.max()), 0.3)
    scale = max(one.distance / fastest, 1.0)
    starts: list[tuple[float, Times]] = []
    for _ in range(STARTS // IMPROVED):
        times = (
            one.distance
            / np.maximum(speed, 0.3)
            * rng.exponential(size=len(walk))
            * 10 ** rng.uniform(-3, 0.3)
        )
        turn = rng.random(len(walk)) * np.where(np.isfinite(longest), longest, 0.0)
        times = np.where((longest < 50 * times) & (rng.random(len(walk)) < 0.7), turn, times)
        times = np.where(rng.random(len(walk)) < 0.75, np.minimum(times, longest), 0.0)
        times = one.corrected(times, 6)
        miss, _, off = one.propagate(times)
        away = max(abs(miss) - mission.tolerance, 0.0) + one.turned * 0.1 * one.distance * abs(off)
        starts.append((float(times.sum()) + 3 * away / fastest, times))
    best = inf
    for _, times in sorted(starts, key=lambda start: start[0])[:IMPROVED]:
        better = _improved(one, times, scale)
        for ended in (times, better, one.corrected(np.where(better > 1e-7 * scale, better, 0.0), 6)):
            best = min(best, one.cost(ended))
    return best


def _improved(one: _Walk, times: Times, scale: float) -> Times:
    mission, rate = one.mission, one.problems.rate[0] * scale
    unit = max(mission.tolerance, 1e-3 * one.distance) if mission.tolerance else one.distance

    def place(x: Times) -> np.ndarray:
        miss = one.propagate(x * scale)[0]
        if mission.tolerance:
            return np.array([(mission.tolerance - abs(miss) ** 2 / mission.tolerance) / (2 * unit)])
        return np.array([miss.real, miss.imag]) / unit

    def heading(x: Times) -> np.ndarray:
        off = one.propagate(x * scale)[2]
        width = mission.heading_tolerance
        return np.array([width - off, width + off]) if width else np.array([off])

    constraints: Any = [{"type": "ineq" if mission.tolerance else "eq", "fun": place}]
    if one.turned:
        slopes = np.stack([-rate, rate]) if mission.heading_tolerance else rate[None]
        kind = "ineq" if mission.heading_tolerance else "eq"
        constraints.append({"type": kind, "fun": heading, "jac": lambda _: slopes})
    problem: dict[str, Any] = {
        "fun": lambda x: x.sum(),
        "x0": times / scale,
        "jac": lambda _: np.ones(len(times)),
        "bounds": [(0.0, None)] * len(times),
        "constraints": constraints,
    }
    found: Any = minimize(**problem, method="SLSQP", options={"maxiter": 60, "ftol": 1e-13})
    better: Times = np.clip(np.nan_to_num(found.x), 0.0, None) * scale
    return better


if __name__ == "__main__":
    arguments = sys.argv[1:]
    sys.exit(1 if main(int(arguments[0]), float(arguments[1])) else 0)
