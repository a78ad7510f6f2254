"""Climb towards missions that take long to plan.

Run by `python -m benchmarks.planning.slow_missions 1 300`; arguments: seed, CPU seconds, a folder in which
the slowest are left.

Libraries of 3 to 10 trims and at most 60 maneuvers: rates that are equal, opposite, nearly equal or tiny,
maneuvers that cost next to nothing, are all alike, or by the kinematic equations; at most six trims in a
sequence, nominal or worst case. Missions that took long are changed a little, again and again.
"""

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import cos, pi, sin
from pathlib import Path
from time import process_time

import numpy as np

from flight.automaton.library import Library
from flight.automaton.library_file import library_text
from flight.automaton.maneuver import Maneuver, ManeuverError
from flight.automaton.trim import Trim
from flight.mission.mission import Mission
from flight.se2 import SE2, Twist
from planner.policies.worst_case import worst_case_planner

from .planning_missions import synthetic_library

MOST_TRIMS, MOST_MANEUVERS, DEPTH = 10, 60, 6

KEPT = 12
"""Missions that are climbed from."""

LIMIT = 1.0
"""CPU seconds that a mission may take."""

PATIENCE = 60.0
"""Seconds after which a search is stopped."""

SIZES = (0.0, 0.0, 1e-9, 1e-6, 1e-4, 1e-2, 0.1, 1.0)
"""Of durations, displacements and turns of maneuvers, in shares of what the kinds have."""


@dataclass(frozen=True, slots=True)
class Case:
    """A mission in a library, and the level to plan for.

    Attributes:
        kind: of library that it was drawn as.
        library: the primitives.
        mission: from where to where.
        gamma: uncertainty level; 0 is nominal.
    """

    kind: str
    library: Library
    mission: Mission
    gamma: float


def main(seed: int, seconds: float, folder: Path | None) -> int:
    """Prints the slowest; returns how many took longer than the limit."""
    rng, spent, planned, over = np.random.default_rng(seed), 0.0, 0, 0
    pool: list[tuple[float, str, Case]] = []
    while spent < seconds:
        fresh = not pool or rng.random() < 0.3
        case = drawn(rng) if fresh else changed(pool[int(rng.integers(len(pool)))][2], rng)
        taken, status = cpu_seconds(case)
        spent, planned = spent + taken, planned + 1
        if taken > LIMIT:
            over += 1
            print(f"  {taken:6.2f} s {status:<10} {case.kind}, {described(case)}", flush=True)
        pool = sorted([*pool, (taken, status, case)], key=lambda one: -one[0])[:KEPT]
    print(f"{planned} missions in {spent:.0f} CPU s, {over} took more than {LIMIT:g} s; the slowest:")
    for place, (taken, status, case) in enumerate(pool):
        print(f"  {taken:6.3f} s {status:<10} {case.kind}, {described(case)}")
        if folder is not None:
            write_case(case, folder / f"slow-{seed}-{place}")
    return over


def cpu_seconds(case: Case) -> tuple[float, str]:
    """Returns the CPU seconds of a plan, and its status."""
    planner = worst_case_planner(case.library, case.gamma, deadline=PATIENCE)
    began = process_time()
    plan = planner.plan(case.mission)
    return process_time() - began, plan.status


def described(case: Case) -> str:
    """Returns a line about a case."""
    mission = case.mission
    wanted = "" if mission.goal_heading is None else f", heading +-{mission.heading_tolerance:g}"
    return (
        f"{len(case.library.trims)} trims, {len(case.library.maneuvers)} maneuvers, gamma {case.gamma:g}, "
        f"tolerance {mission.tolerance:.3g} m{wanted}"
    )


def write_case(case: Case, path: Path) -> None:
    """Writes the library, and the mission as a line."""
    path.mkdir(parents=True, exist_ok=True)
    (path / "lib.json").write_text(library_text(case.library))
    (path / "mission.json").write_text(json.dumps({"gamma": case.gamma, "mission": repr(case.mission)}))


def drawn(rng: np.random.Generator) -> Case:
    """Returns a case of a kind by chance."""
    kind = str(rng.choice(sorted(KINDS)))
    count = int(rng.integers(3, MOST_TRIMS + 1))
    if kind == "kinematic":
        library = synthetic_library(
            count, min(MOST_MANEUVERS, count * (count - 1) // 2), seed=int(rng.integers(10**6))
        )
    else:
        library = Library(
            kind, "", "", *_primitives(KINDS[kind](rng, count), rng, mirrored=kind == "mirrored")
        )
    return Case(kind, library, _mission(rng, library), float(rng.choice([0.0, 0.1, 0.5, 1.0])))


def _equal(rng: np.random.Generator, count: int) -> list[float]:
    return [float(rng.choice([0.1, 0.3, 1.0]))] * count


def _few(rng: np.random.Generator, count: int) -> list[float]:
    rate = float(rng.choice([0.2, 0.5, 1.5]))
    return [rate * float(rng.choice([-1, 0, 1, 0.7])) for _ in range(count)]


def _nearly_equal(rng: np.random.Generator, count: int) -> list[float]:
    apart = 10.0 ** float(rng.uniform(-13, -1))
    return [0.3 * (1 + apart * float(rng.normal())) for _ in range(count)]


def _tiny(rng: np.random.Generator, count: int) -> list[float]:
    return [float(rng.choice([-1, 1])) * 10.0 ** float(rng.uniform(-9, -1)) for _ in range(count)]


def _mirrored(rng: np.random.Generator, count: int) -> list[float]:
    rates = rng.uniform(0.1, 1, count // 2)
    return [*rates.tolist(), *(-rates).tolist(), *[0.0] * (count % 2)]


def _straight(rng: np.random.Generator, count: int) -> list[float]:
    return [0.0 if rng.random() < 0.7 else float(rng.choice([-0.3, 0.3])) for _ in range(count)]


KINDS: dict[str, Callable[[np.random.Generator, int], list[float]]] = {
    "equal rates": _equal,
    "few rates": _few,
    "nearly equal rates": _nearly_equal,
    "tiny rates": _tiny,
    "mirrored": _mirrored,
    "straight": _straight,
    "kinematic": _few,
}


def _primitives(
    rates: list[float], rng: np.random.Generator, *, mirrored: bool
) -> tuple[tuple[Trim, ...], tuple[Maneuver, ...]]:
    """Returns trims of some rates, and maneuvers between pairs of them."""
    one_speed, errors = rng.random() < 0.4, rng.random() < 0.6
    trims = []
    for number, rate in enumerate(rates, start=1):
        speed = 2.0 if one_speed else float(rng.choice([0.5, 1, 2, 5]))
        side = 0.0 if mirrored or rng.random() < 0.7 else float(rng.normal())
        off = 0.1 * rng.normal(size=3) if errors else np.zeros(3)
        error = Twist(
            *(float(value) * size for value, size in zip(off, (speed, 1.0, abs(rate)), strict=True))
        )
        trims.append(Trim(number, f"trim {number}", Twist(speed, side, rate), error))
    every = [(one.id, other.id) for one in trims for other in trims]
    pairs = [every[int(place)] for place in rng.permutation(len(every))[:MOST_MANEUVERS]]
    size, same = float(rng.choice(SIZES)), rng.random() < 0.3
    shared = rng.random(), rng.normal(size=3)
    maneuvers = []
    for number, pair in enumerate(sorted(pairs), start=1):
        duration, moved = shared if same else (rng.random(), rng.normal(size=3))
        displacement = SE2(*(size * moved).tolist())
        maneuvers.append(
            Maneuver(number, *pair, size * float(duration), displacement, ManeuverError(0.0, 0.0, 0.0, 0.0))
        )
    return tuple(trims), tuple(maneuvers)


def _mission(rng: np.random.Generator, library: Library) -> Mission:
    bearing, distance = rng.uniform(-pi, pi), 10 ** rng.uniform(-1, 2.5)
    goal = float(distance * cos(bearing)), float(distance * sin(bearing))
    start_trim = int(rng.choice([trim.id for trim in library.trims]))
    tolerance = float(rng.choice([0.0, 0.01, 0.1])) * float(distance)
    mission = Mission("slow", SE2.identity(), start_trim, goal, tolerance, max_trims=DEPTH)
    if rng.random() > 0.4:
        return mission
    width = float(rng.choice([0.0, 0.1, 1.0]))
    return replace(mission, goal_heading=float(rng.uniform(-pi, pi)), heading_tolerance=width)


def changed(case: Case, rng: np.random.Generator) -> Case:
    """Returns a case that differs a little."""
    return _CHANGES[int(rng.integers(len(_CHANGES)))](case, rng)


def _other_goal(case: Case, rng: np.random.Generator) -> Case:
    scale, turn = float(np.exp(rng.normal(0, 0.5))), float(rng.normal(0, 0.5))
    x, y = case.mission.goal
    goal = scale * (x * cos(turn) - y * sin(turn)), scale * (x * sin(turn) + y * cos(turn))
    return replace(case, mission=replace(case.mission, goal=goal))


def _other_mission(case: Case, rng: np.random.Generator) -> Case:
    return replace(case, mission=_mission(rng, case.library))


def _other_gamma(case: Case, rng: np.random.Generator) -> Case:
    return replace(case, gamma=float(rng.choice([0.0, 0.05, 0.3, 1.0])))


def _other_rate(case: Case, rng: np.random.Generator) -> Case:
    trims = list(case.library.trims)
    one, other = (int(place) for place in rng.integers(len(trims), size=2))
    like = trims[other].velocity.yaw_rate
    rate = float(rng.choice([0.0, like, -like, like * (1 + 10.0 ** float(rng.uniform(-13, -1)))]))
    velocity = replace(trims[one].velocity, yaw_rate=rate)
    trims[one] = replace(trims[one], velocity=velocity)
    return replace(case, library=replace(case.library, trims=tuple(trims)))


def _other_speed(case: Case, rng: np.random.Generator) -> Case:
    trims = list(case.library.trims)
    one, other = (int(place) for place in rng.integers(len(trims), size=2))
    forward = float(
        rng.choice([trims[other].velocity.forward, trims[one].velocity.forward * rng.uniform(0.5, 2)])
    )
    trims[one] = replace(trims[one], velocity=replace(trims[one].velocity, forward=forward))
    return replace(case, library=replace(case.library, trims=tuple(trims)))


def _other_maneuvers(case: Case, rng: np.random.Generator) -> Case:
    """Scales durations, displacements or turns of all maneuvers, or of some."""
    scale, some = float(rng.choice([0.0, 0.1, 0.5, 2.0])), float(rng.choice([0.1, 1.0]))
    what = int(rng.integers(3))
    found = []
    for one in case.library.maneuvers:
        moved, duration = one.displacement, one.duration
        if rng.random() < some:
            if what == 0:
                duration *= scale
            elif what == 1:
                moved = SE2(scale * moved.x, scale * moved.y, moved.heading)
            else:
                moved = SE2(moved.x, moved.y, scale * moved.heading)
        error = one.error if duration == one.duration else replace(one.error, duration=0.0)
        found.append(replace(one, displacement=moved, duration=duration, error=error))
    return replace(case, library=replace(case.library, maneuvers=tuple(found)))


_CHANGES = (_other_goal, _other_mission, _other_gamma, _other_rate, _other_speed, _other_maneuvers)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), float(sys.argv[2]), Path(sys.argv[3]) if len(sys.argv) > 3 else None) > 0)
