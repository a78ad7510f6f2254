"""Estimated against true turbulence: `python -m benchmarks.flight.turbulence 20 3`.

First the vertical velocities in each trim per m/s of wind at 20 ft, the input of `sim.wind.turbulence_meter`,
and the filter's innovations, for comparison; then the estimates at the ends of random missions in each wind
class.
"""

import sys
from collections.abc import Iterator
from math import sqrt
from statistics import mean, quantiles

import numpy as np

from experiments.mission.fly import mission_seed
from experiments.mission.random_missions import random_missions
from flightlog.topics import ESTIMATE
from planner.closed_loop.receding_horizon import fly_closed_loop
from planner.policies.worst_case import worst_case_planner
from scenarios.find import find_library
from sim.loop.specification import FlightSpecification, specified_pose
from sim.navigation.navigation import Navigation
from sim.simulated_helicopter import SimulatedHelicopter
from sim.wind.turbulence_meter import ERROR_PER_WIND, ERROR_PER_WIND_IN_TURNS, STILL_AIR_ERROR
from sim.wind.wind_class import WIND_CLASSES, wind_class

LIBRARY = find_library("gtmax-sim")
FLYABLE = ("calm", "gtmax", "light")
"""Wind classes that the vehicle can hold."""
HOLD_TIME = 40.0
"""Seconds for which a trim is held."""
FIX_INTERVAL = 0.2
"""Seconds between two samples of the innovations, each of the last fix."""


def velocity_error(trim: int, wind: str, seed: int) -> float:
    """Returns the mean square vertical velocity in a trim, m2/s2."""
    helicopter = SimulatedHelicopter(FlightSpecification(seed=seed, start_trim=trim, wind=wind), LIBRARY)
    helicopter.coast(HOLD_TIME)
    log = helicopter.log()
    return float((log[ESTIMATE]["descent"] ** 2).mean())


def innovations(wind: str, seed: int) -> tuple[float, float]:
    """Returns mean squared normalised innovations in position and velocity."""
    seen = []
    for trim in LIBRARY.trims:
        specification = FlightSpecification(seed=seed, start_trim=trim.id, wind=wind)
        helicopter = SimulatedHelicopter(specification, LIBRARY)
        assert isinstance(helicopter.navigation, Navigation)
        for _ in range(round(HOLD_TIME / FIX_INTERVAL)):
            helicopter.coast(FIX_INTERVAL)
            seen.append(helicopter.navigation.fix_tests**2)
    position, velocity = np.split(np.nanmean(seen, axis=0), 2)
    return float(position.mean()), float(velocity.mean())


def reported_turbulence(wind: str, count: int, seed: int) -> Iterator[float]:
    """Yields the estimated turbulence at the end of each mission, m/s."""
    planner = worst_case_planner(LIBRARY, 1.0)
    for mission in random_missions(LIBRARY, count=count, seed=seed, gamma=1.0):
        number = mission_seed(seed, mission.name, 0)
        specification = FlightSpecification(
            seed=number,
            wind=wind,
            start=specified_pose(mission.start),
            start_trim=mission.start_trim,
            supervised=True,
        )
        helicopter = SimulatedHelicopter(specification, LIBRARY)
        fly_closed_loop(helicopter, mission, planner=planner, library=LIBRARY)
        assert helicopter.supervisor is not None
        if (turbulence := helicopter.supervisor.turbulence) is not None:
            yield turbulence


def main() -> None:
    """Prints both tables."""
    count, seed = (int(word) for word in sys.argv[1:3])
    wind = wind_class(LIBRARY.conditions.wind)
    print(f"velocity error, m/s, and per m/s of wind at 20 ft; model: {STILL_AIR_ERROR} in still air")
    for trim in LIBRARY.trims:
        still, blown = (
            mean(velocity_error(trim.id, name, seed + n) for n in range(4)) for name in ("calm", wind.name)
        )
        taken = ERROR_PER_WIND + ERROR_PER_WIND_IN_TURNS * trim.velocity.yaw_rate**2
        share = sqrt(max(blown - still, 0.0)) / wind.wind_at_20_ft
        print(f"{trim.name:<18}still {sqrt(still):.4f}  {wind.name} {share:.4f}  model {taken:.4f}")
    print("\nwind class     innovations, mean square in variances: position   velocity")
    for name in FLYABLE:
        position, velocity = (
            mean(parts) for parts in zip(*(innovations(name, seed + n) for n in range(4)), strict=True)
        )
        print(f"{name:<15}{position:>48.3f}{velocity:>11.3f}")
    print("\nwind class        true   estimated: 10 %   median   90 %, m/s")
    for name in FLYABLE:
        low, *_, high = quantiles(found := list(reported_turbulence(name, count, seed)), n=10)
        half = sorted(found)[len(found) // 2]
        print(f"{name:<15}{WIND_CLASSES[name].wind_at_20_ft:>7.1f}{low:>13.1f}{half:>9.1f}{high:>9.1f}")


if __name__ == "__main__":
    main()
