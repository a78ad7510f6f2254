"""Alarm limits against the largest values of fault-free flights.

Run by `python -m benchmarks.flight.alarm_limits 200 7`.

Arguments: missions, seed. Prints, for the wind of the shipped library and for light wind, the largest of
each monitored value over random missions, beside its limit, and the flights with an alarm. The seed should
differ from those of matrices and tests.
"""

import sys
from collections.abc import Iterator, Mapping

from benchmarks.upper_limit import upper_limit
from experiments.mission.fly import mission_seed
from experiments.mission.random_missions import random_missions
from flight.mission.mission import Mission
from flightlog.alarm import AlarmKind
from planner.closed_loop.receding_horizon import fly_closed_loop
from planner.policies.worst_case import worst_case_planner
from scenarios.find import find_library
from sim.loop.specification import FlightSpecification, specified_pose
from sim.simulated_helicopter import SimulatedHelicopter
from sim.supervisor import LIMITS

LIBRARY = find_library("gtmax-sim")
WINDS = ("gtmax", "light")


def watched(missions: tuple[Mission, ...], *, wind: str, seed: int) -> Iterator[Mapping[AlarmKind, float]]:
    """Yields the largest monitored values of each fault-free flight."""
    planner = worst_case_planner(LIBRARY, 1.0)
    for mission in missions:
        helicopter = SimulatedHelicopter(
            FlightSpecification(
                kind="mission",
                seed=mission_seed(seed, mission.name, 0),
                wind=wind,
                start=specified_pose(mission.start),
                start_trim=mission.start_trim,
                supervised=True,
                vehicles="fleet",
            ),
            LIBRARY,
        )
        fly_closed_loop(helicopter, mission, planner=planner, library=LIBRARY)
        assert helicopter.supervisor is not None
        yield helicopter.supervisor.largest


def main() -> None:
    """Prints a table for each wind."""
    flights, seed = (int(word) for word in sys.argv[1:3])
    missions = random_missions(LIBRARY, count=flights, seed=seed, gamma=1.0)
    for wind in WINDS:
        found = list(watched(missions, wind=wind, seed=seed))
        alarmed = sum(any(value > LIMITS[kind] for kind, value in one.items()) for one in found)
        limit = upper_limit(alarmed, flights)
        print(f"{wind}: {alarmed} of {flights} flights with an alarm; at most {limit:.2%} of all (95 %)")
        print(f"{'monitored':<22} median   99 %  largest    limit")
        for kind, allowed in LIMITS.items():
            values = sorted(one.get(kind, 0.0) for one in found)
            half, most = values[len(values) // 2], values[int(0.99 * (len(values) - 1))]
            print(f"{kind.name.lower():<22}{half:>7.3f}{most:>7.3f}{values[-1]:>9.3f}{allowed:>9.2f}")


if __name__ == "__main__":
    main()
