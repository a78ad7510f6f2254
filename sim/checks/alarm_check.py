"""Check of the alarms: sound flights of drawn vehicles raise none."""

from collections.abc import Iterator
from concurrent.futures import Executor
from itertools import repeat
from math import pi

import numpy as np

from flight.automaton.library import Library
from flight.errors import FlightLostError
from flight.mission.campaign import VehiclePopulation
from flight.se2 import SE2
from flightlog.alarm import AlarmKind
from sim.loop.specification import FlightSpecification, specified_pose
from sim.simulated_helicopter import SimulatedHelicopter
from sim.vehicle.parameters import read_parameters
from sim.vehicle.uncertainty import CENTRE_OF_MASS, DrawnVehicle, differ

from .check_result import CheckResult

FLIGHTS = 200
SECONDS = 40.0
LARGEST_SHARE = 0.005
"""Share of sound flights with an alarm."""
WRONG_CENTRE, WRONG_FLIGHTS = 0.03, 12
"""Centre of mass off by this, m, at which alarms of turbulence would blame the wind."""
CLASSES = ("rtk", "gps")
_COASTS = (0.5, 6.0)
# Random stream of the walks, separate from those of the flights.
_WALK_STREAM = 11


def check_alarms(library: Library, *, executor: Executor) -> Iterator[CheckResult]:
    """Yields shares of flights with false alarms.

    Args:
        library: trims, maneuvers, wind class and the maneuver-end rule.
        executor: executor of the flights.
    """
    for sensors in CLASSES:
        alarms = fly_sound(library, "fleet", sensors, flights=FLIGHTS, executor=executor)
        share = sum(map(bool, alarms)) / len(alarms)
        kinds = sorted({kind.name.lower() for found in alarms for kind in found})
        beside = f"{FLIGHTS} flights of {SECONDS:g} s of a fleet; {', '.join(kinds) or 'none'}"
        yield CheckResult(
            "alarms", f"{sensors}: sound flights with an alarm", share, "-", None, LARGEST_SHARE, beside
        )
    wrong = [
        AlarmKind.TURBULENCE in found
        for found in executor.map(_fly_off_centre, repeat(library), range(WRONG_FLIGHTS))
    ]
    beside = f"centre of mass {WRONG_CENTRE:g} m ahead, {WRONG_FLIGHTS} flights"
    yield CheckResult(
        "alarms", "wind blamed for a model error", float(sum(wrong)), "flights", None, 0.0, beside
    )


def fly_sound(
    library: Library, vehicles: VehiclePopulation, sensors: str, *, flights: int, executor: Executor
) -> list[frozenset[AlarmKind]]:
    """Flies random walks without faults; returns the alarms of each."""
    places = range(flights)
    return list(executor.map(_fly_sound, repeat(library), places, repeat(vehicles), repeat(sensors)))


def _fly_sound(
    library: Library, number: int, vehicles: VehiclePopulation, sensors: str
) -> frozenset[AlarmKind]:
    return _fly_walk(library, number, vehicles=vehicles, sensors=sensors)


def _fly_off_centre(library: Library, number: int) -> frozenset[AlarmKind]:
    flown = differ(read_parameters(), {CENTRE_OF_MASS[0]: WRONG_CENTRE})
    return _fly_walk(library, number, vehicles="nominal", sensors="rtk", flown=flown)


def _fly_walk(
    library: Library,
    number: int,
    *,
    vehicles: VehiclePopulation,
    sensors: str,
    flown: DrawnVehicle | None = None,
) -> frozenset[AlarmKind]:
    """Flies a random walk; a lost flight is an alarm."""
    rng = np.random.default_rng([number, _WALK_STREAM])
    flight = FlightSpecification(
        seed=number,
        start_trim=int(rng.choice([trim.id for trim in library.trims])),
        wind=library.conditions.wind,
        start=specified_pose(SE2(0.0, 0.0, float(rng.uniform(-pi, pi)))),
        supervised=True,
        vehicles=vehicles,
        sensors=sensors,
    )
    helicopter = SimulatedHelicopter(flight, library, flown=flown)
    assert helicopter.supervisor is not None
    try:
        while helicopter.time < SECONDS:
            helicopter.coast(float(rng.uniform(*_COASTS)))
            onward = [row for row in library.maneuvers if row.from_trim == helicopter.trim]
            helicopter.perform(onward[rng.integers(len(onward))])
    except FlightLostError:
        return frozenset({AlarmKind.NO_NUMBER})
    return frozenset(alarm.kind for alarm in helicopter.supervisor.alarms)
