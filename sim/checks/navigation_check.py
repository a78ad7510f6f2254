"""Whether the navigation filter's claims about its own error are true, and what it bears."""

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from itertools import repeat
from math import exp, hypot, pi

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2

from flight.automaton.library import Library
from flight.mission.fault import Fault
from flight.se2 import SE2
from flight.units import FOOT
from sim.loop.motion import Motion
from sim.loop.specification import CONTROL_RATE, FlightSpecification, pose
from sim.navigation.filter import ESTIMATED
from sim.navigation.navigation import Navigation
from sim.simulated_helicopter import SimulatedHelicopter

from .check import Figure

FLIGHTS = 50
SECONDS = 200.0
APART = 20.0
"""Seconds between two looks at the filter; its error is another by then."""
# An error's memory is taken as lost where its correlation is below this.
_CORRELATION_BAR = exp(-1.0)
# One foot: a third of the tolerance with which the thesis's missions are judged, m and m/s.
POSITION_BAR = FOOT
_BEFORE, _LOSS, _AFTER = 10.0, 2.0, 15.0
_ALTITUDE = 30.0
_WINDS = ("calm", "gtmax", "light")
_COASTS = (2.0, 8.0)
# Keeps the chance of the walks apart from that of the flights.
_WALK_STREAM = 7


@dataclass(frozen=True, slots=True, eq=False)
class Watched:
    """What the filter of one flight was worth.

    Attributes:
        normalised: squared errors in units of the covariance that the filter claims, every `APART` seconds.
        position: largest distance between belief and truth, horizontally, m.
        velocity: largest difference of forward velocities, m/s.
    """

    normalised: Float[np.ndarray, "n"]
    position: float
    velocity: float


class _Watch:
    """Stands where a flight has its navigation, and compares belief and truth."""

    def __init__(self, navigation: Navigation, *, apart: float) -> None:
        self._navigation, self._every = navigation, round(apart * CONTROL_RATE)
        self._truth, self._estimate = navigation.signals.truth, navigation.signals.estimate
        self._periods = 0
        self._position = self._velocity = 0.0
        self._normalised: list[float] = []

    def run(self) -> None:
        """Believes, and looks."""
        self._navigation.run()
        self._periods += 1
        off = self._estimate[:4] - self._truth[:4]
        self._position = max(self._position, hypot(off[0], off[1]))
        self._velocity = max(self._velocity, abs(float(off[3])))
        if self._periods % self._every == 0:
            truth = Motion._make(self._truth.tolist())
            self._normalised.append(self._navigation.normalised_error(truth))

    def spread(self) -> tuple[float, ...]:
        """Returns what the filter claims of its error."""
        return self._navigation.spread()

    def move(self, displacement: SE2) -> None:
        """Follows a motion of the whole world."""
        self._navigation.move(displacement)

    def watched(self) -> Watched:
        """Returns what was seen."""
        return Watched(np.array(self._normalised), self._position, self._velocity)


def check_navigation(library: Library, *, executor: Executor) -> Iterator[Figure]:
    """Yields how honest the filter is over many flights, and what a loss of GPS in every trim does.

    Args:
        library: trims, maneuvers and the rule by which they end.
        executor: flies.
    """
    yield from judge_consistency(list(executor.map(_wander, repeat(library), range(FLIGHTS))))
    yield from judge_losses(lose_gps(library, _LOSS, executor=executor), f"{_LOSS:g} s without GPS")


def judge_consistency(flights: Sequence[Watched]) -> Iterator[Figure]:
    """Yields whether normalised errors are as the filter claims, at times that are not correlated."""
    normalised = np.array([flight.normalised for flight in flights])
    number, times = normalised.shape
    mean = normalised.mean(axis=0)
    low, high = (chi2.ppf(share, ESTIMATED * number) / number for share in (0.025, 0.975))
    inside = float(((mean >= low) & (mean <= high)).mean())
    beside = f"{number} flights, {times} times {APART:g} s apart, band {low:.2f} to {high:.2f}"
    yield Figure(
        "navigation", "share of times with the mean NEES in its 95 % band", inside, "-", 0.9, None, beside
    )
    yield Figure("navigation", "mean NEES", float(mean.mean()), "-", beside=f"{ESTIMATED} expected")
    apart = normalised - ESTIMATED
    correlation = float((apart[:, 1:] * apart[:, :-1]).mean() / (apart**2).mean())
    beside = f"of one time with the next, {APART:g} s later"
    yield Figure("navigation", "NEES, correlation", correlation, "-", None, _CORRELATION_BAR, beside)
    position = max(flight.position for flight in flights)
    beside = f"{number} flights of {times * APART:g} s"
    yield Figure("navigation", "largest position error", position, "m", None, POSITION_BAR, beside)


def judge_losses(flights: Sequence[Watched], what: str) -> Iterator[Figure]:
    """Yields the worst of flights, one a trim, that lost their GPS for a while."""
    beside = f"{what} in each of {len(flights)} trims in wind class gtmax"
    worst = max(flight.position for flight in flights)
    yield Figure("navigation", "GPS lost: largest position error", worst, "m", None, POSITION_BAR, beside)
    worst = max(flight.velocity for flight in flights)
    yield Figure("navigation", "GPS lost: largest error of speed", worst, "m/s", None, POSITION_BAR, beside)
    after = max(float(flight.normalised[-1]) for flight in flights)
    likely = float(chi2.ppf(1.0 - 0.01 / len(flights), ESTIMATED))
    beside = f"{_AFTER:g} s later, largest of {len(flights)}; bar: 99 % of honest filters"
    yield Figure("navigation", "GPS lost: normalised error after", after, "-", None, likely, beside)


def lose_gps(library: Library, seconds: float, *, executor: Executor) -> list[Watched]:
    """Flies every trim, each with a loss of GPS."""
    return list(executor.map(_lose, repeat(library), range(len(library.trims)), repeat(seconds)))


def _lose(library: Library, place: int, seconds: float) -> Watched:
    loss = Fault(where="gps", what="dropout", start=_BEFORE, duration=seconds)
    flight = FlightSpecification(
        seed=place, start_trim=library.trims[place].id, wind="gtmax", faults=(loss,), altitude=_ALTITUDE
    )
    duration = _BEFORE + seconds + _AFTER
    helicopter, watch = _watched(flight, library, apart=duration)
    helicopter.coast(duration)
    return watch.watched()


def _wander(library: Library, number: int) -> Watched:
    """Flies one walk of chance along the maneuvers, in air and with sensors of its own."""
    rng = np.random.default_rng([number, _WALK_STREAM])
    flight = FlightSpecification(
        seed=number,
        start_trim=int(rng.choice([trim.id for trim in library.trims])),
        wind=_WINDS[number % len(_WINDS)],
        altitude=float(rng.uniform(20.0, 60.0)),
        start=pose(SE2(0.0, 0.0, float(rng.uniform(-pi, pi)))),
    )
    helicopter, watch = _watched(flight, library, apart=APART)
    while helicopter.time < SECONDS:
        helicopter.coast(float(rng.uniform(*_COASTS)))
        onward = [maneuver for maneuver in library.maneuvers if maneuver.from_trim == helicopter.trim]
        helicopter.perform(onward[rng.integers(len(onward))])
    watched = watch.watched()
    return replace(watched, normalised=watched.normalised[: round(SECONDS / APART)])


def _watched(
    flight: FlightSpecification, library: Library, *, apart: float
) -> tuple[SimulatedHelicopter, _Watch]:
    helicopter = SimulatedHelicopter(flight, library)
    navigation = helicopter.navigation
    assert isinstance(navigation, Navigation), flight
    helicopter.navigation = watch = _Watch(navigation, apart=apart)
    return helicopter, watch
