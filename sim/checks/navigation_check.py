"""Checks of the navigation filter: consistency and loss of GPS."""

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from itertools import repeat
from math import hypot, log, pi, sqrt

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2

from flight.automaton.library import Library
from flight.mission.fault import Fault
from flight.se2 import SE2
from flight.units import FOOT
from sim.loop.motion import Motion
from sim.loop.specification import CONTROL_RATE, FlightSpecification, specified_pose
from sim.navigation.filter import ESTIMATED
from sim.navigation.navigation import Navigation
from sim.navigation.sensor_errors import sensor_errors
from sim.simulated_helicopter import SimulatedHelicopter

from .check_result import CheckResult

FLIGHTS = 50
SECONDS = 200.0
SAMPLE_INTERVAL = 20.0
"""Seconds between two samples of the filter's error, long enough to be uncorrelated."""
NEES_LIMITS = (0.3, 1.5)
"""Mean normalised squared error over its number of entries; 1 for a filter with the true model."""
CLASSES = ("rtk", "gps")
"""Sensor classes checked, with vehicles of a fleet."""
_POSITION = 3
# One foot: a third of the tolerance of the thesis's missions, m and m/s.
POSITION_LIMIT = FOOT
_BEFORE, _LOSS, _AFTER = 10.0, 2.0, 15.0
_ALTITUDE = 30.0
_WINDS = ("calm", "gtmax", "light")
_COASTS = (2.0, 8.0)
# Random stream of the walks, separate from those of the flights.
_WALK_STREAM = 7


@dataclass(frozen=True, slots=True, eq=False)
class FilterErrors:
    """Errors of the navigation filter in one flight.

    Attributes:
        normalised: normalised squared errors (NEES), every `SAMPLE_INTERVAL` seconds.
        normalised_position: those of the position alone.
        position: largest horizontal position error, m.
        velocity: largest error of the forward velocity, m/s.
    """

    normalised: Float[np.ndarray, "n"]
    normalised_position: Float[np.ndarray, "n"]
    position: float
    velocity: float


class _FilterMonitor:
    """Navigation wrapper that compares estimate and truth."""

    def __init__(self, navigation: Navigation, *, interval: float) -> None:
        self._navigation, self._every = navigation, round(interval * CONTROL_RATE)
        self._truth, self._estimate = navigation.signals.truth, navigation.signals.estimate
        self._periods = 0
        self._position = self._velocity = 0.0
        self._normalised: list[float] = []
        self._normalised_position: list[float] = []

    def run(self) -> None:
        """Runs the navigation and compares estimate and truth."""
        self._navigation.run()
        self._periods += 1
        off = self._estimate[:4] - self._truth[:4]
        self._position = max(self._position, hypot(off[0], off[1]))
        self._velocity = max(self._velocity, abs(float(off[3])))
        if self._periods % self._every == 0:
            truth = Motion._make(self._truth.tolist())
            self._normalised.append(self._navigation.normalised_error(truth))
            self._normalised_position.append(self._navigation.normalised_position_error(truth))

    def standard_deviation(self) -> tuple[float, ...]:
        """Returns the standard deviations that the filter claims."""
        return self._navigation.standard_deviation()

    def move_world(self, displacement: SE2) -> None:
        """Applies a displacement of the whole world."""
        self._navigation.move_world(displacement)

    def filter_errors(self) -> FilterErrors:
        """Returns the errors so far."""
        normalised = (np.array(self._normalised), np.array(self._normalised_position))
        return FilterErrors(*normalised, self._position, self._velocity)


def check_navigation(library: Library, *, executor: Executor) -> Iterator[CheckResult]:
    """Yields the filter's consistency and its errors after GPS loss.

    Args:
        library: trims, maneuvers and the maneuver-end rule.
        executor: executor of the flights.
    """
    for sensors in CLASSES:
        yield from check_filter_consistency(
            fly_random_walks(library, sensors, flights=FLIGHTS, seconds=SECONDS, executor=executor), sensors
        )
    yield from check_gps_outages(
        fly_gps_outages(library, _LOSS, executor=executor), f"{_LOSS:g} s without GPS"
    )


def check_filter_consistency(flights: Sequence[FilterErrors], sensors: str) -> Iterator[CheckResult]:
    """Yields the consistency of the claimed errors of a sensor class."""
    number, times = len(flights), len(flights[0].normalised)
    beside = f"{number} flights of a fleet, {times} samples every {SAMPLE_INTERVAL:g} s"
    position = float(np.mean([flight.normalised_position for flight in flights])) / _POSITION
    yield CheckResult("navigation", f"{sensors}: position NEES / 3", position, "-", *NEES_LIMITS, beside)
    whole = float(np.mean([flight.normalised for flight in flights])) / ESTIMATED
    yield CheckResult("navigation", f"{sensors}: NEES / {ESTIMATED}", whole, "-", *NEES_LIMITS, beside)
    errors, _ = sensor_errors(sensors)
    worst = max(flight.position for flight in flights)
    # Of a Rayleigh distribution once in a million samples, as many as there are times.
    limit = sqrt(2.0 * log(1e6)) * errors.position_sigma
    yield CheckResult("navigation", f"{sensors}: largest position error", worst, "m", None, limit, beside)


def check_gps_outages(flights: Sequence[FilterErrors], what: str) -> Iterator[CheckResult]:
    """Yields the largest errors of flights with a GPS outage."""
    beside = f"{what} in each of {len(flights)} trims in wind class gtmax"
    worst = max(flight.position for flight in flights)
    yield CheckResult(
        "navigation", "GPS outage: largest position error", worst, "m", None, POSITION_LIMIT, beside
    )
    worst = max(flight.velocity for flight in flights)
    yield CheckResult(
        "navigation", "GPS outage: largest speed error", worst, "m/s", None, POSITION_LIMIT, beside
    )
    after = max(float(flight.normalised[-1]) for flight in flights)
    likely = float(chi2.ppf(1.0 - 0.01 / len(flights), ESTIMATED))
    beside = f"{_AFTER:g} s later, largest of {len(flights)}; limit: 99 % of consistent filters"
    yield CheckResult("navigation", "GPS outage: NEES afterwards", after, "-", None, likely, beside)


def fly_gps_outages(library: Library, seconds: float, *, executor: Executor) -> list[FilterErrors]:
    """Flies every trim with a GPS outage."""
    return list(executor.map(_fly_gps_outage, repeat(library), range(len(library.trims)), repeat(seconds)))


def _fly_gps_outage(library: Library, place: int, seconds: float) -> FilterErrors:
    loss = Fault(where="gps", what="dropout", start=_BEFORE, duration=seconds)
    flight = FlightSpecification(
        seed=place, start_trim=library.trims[place].id, wind="gtmax", faults=(loss,), altitude=_ALTITUDE
    )
    duration = _BEFORE + seconds + _AFTER
    helicopter, monitor = _monitored_helicopter(flight, library, interval=duration)
    helicopter.coast(duration)
    return monitor.filter_errors()


def fly_random_walks(
    library: Library, sensors: str, *, flights: int, seconds: float, executor: Executor
) -> list[FilterErrors]:
    """Flies random walks of a fleet with a sensor class."""
    places = range(flights)
    return list(executor.map(_fly_random_walk, repeat(library), places, repeat(sensors), repeat(seconds)))


def _fly_random_walk(library: Library, number: int, sensors: str, seconds: float) -> FilterErrors:
    """Flies one random walk along the maneuvers."""
    rng = np.random.default_rng([number, _WALK_STREAM])
    flight = FlightSpecification(
        seed=number,
        start_trim=int(rng.choice([trim.id for trim in library.trims])),
        wind=_WINDS[number % len(_WINDS)],
        altitude=float(rng.uniform(20.0, 60.0)),
        start=specified_pose(SE2(0.0, 0.0, float(rng.uniform(-pi, pi)))),
        vehicles="fleet",
        sensors=sensors,
    )
    helicopter, monitor = _monitored_helicopter(flight, library, interval=SAMPLE_INTERVAL)
    while helicopter.time < seconds:
        helicopter.coast(float(rng.uniform(*_COASTS)))
        onward = [maneuver for maneuver in library.maneuvers if maneuver.from_trim == helicopter.trim]
        helicopter.perform(onward[rng.integers(len(onward))])
    errors, kept = monitor.filter_errors(), round(seconds / SAMPLE_INTERVAL)
    return replace(
        errors,
        normalised=errors.normalised[:kept],
        normalised_position=errors.normalised_position[:kept],
    )


def _monitored_helicopter(
    flight: FlightSpecification, library: Library, *, interval: float
) -> tuple[SimulatedHelicopter, _FilterMonitor]:
    helicopter = SimulatedHelicopter(flight, library)
    navigation = helicopter.navigation
    assert isinstance(navigation, Navigation), flight
    helicopter.navigation = monitor = _FilterMonitor(navigation, interval=interval)
    return helicopter, monitor
