"""Tests that nothing which decides reads the truth: flights with the truth set to not-a-number for it."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import experiments.mission.fly as mission_flights
import sim.simulated_helicopter as simulator
from experiments.mission.mission_task import MissionTask
from experiments.mission.policies import FlownPolicy
from flight.automaton.maneuver import Maneuver
from flight.automaton.vehicle import Leg
from flight.mission.fault import parse_fault
from flightlog.attachment_names import PLANS_ATTACHMENT
from flightlog.log import FlightLog
from scenarios.find import find_library, find_mission
from sim.control.controller import Controller
from sim.control.maneuver_generator import ManeuverGenerator
from sim.loop.bound_function import Array, Recursion
from sim.loop.signals import Signals
from sim.loop.specification import FlightOptions
from sim.navigation.navigation import Navigation
from sim.simulated_helicopter import SimulatedHelicopter
from sim.supervisor import Supervisor

LIBRARY = find_library("gtmax-sim")
FLEET = FlightOptions(vehicles="fleet", supervised=True)
FAILING = replace(FLEET, faults=(parse_fault("magnetometer bias 2 inf 0.3"),))


@contextmanager
def poison(truth: Array) -> Iterator[None]:
    """Sets the truth to not-a-number for a while."""
    kept = truth.copy()
    truth[:] = np.nan
    try:
        yield
    finally:
        truth[:] = kept


class PoisonedController(Controller):
    """The controller without the truth."""

    def run(self) -> None:
        """Computes the controls."""
        with poison(self.signals.truth):
            super().run()


class PoisonedGenerator(ManeuverGenerator):
    """The maneuver generator without the truth."""

    def __init__(self, *arguments: Any, signals: Signals, **options: Any) -> None:
        self._truth = signals.truth
        super().__init__(*arguments, signals=signals, **options)
        # Bound in the constructor for speed.
        generate = self.run
        self.run = lambda: _poisoned(generate, self._truth)


class PoisonedSupervisor(Supervisor):
    """The supervisor without the truth."""

    def __init__(self, signals: Signals, *arguments: Any, **options: Any) -> None:
        self._truth = signals.truth
        super().__init__(signals, *arguments, **options)

    def run(self) -> None:
        """Checks a control period."""
        with poison(self._truth):
            super().run()


class PoisonedFilter(Navigation):
    """The sensors see the truth, the filter does not."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        for part in (self._predict, self._correct_fix, self._correct_slow):
            _poison_steps(part, self.signals.truth)


def _poisoned(run: Callable[[], None], truth: Array) -> None:
    with poison(truth):
        run()


def _poison_steps(part: Recursion, truth: Array) -> None:
    step = part.step
    part.step = lambda: _poisoned(step, truth)


class PoisonedLegs(SimulatedHelicopter):
    """Planner and closed loop get true tracks of not-a-number."""

    def coast(self, duration: float) -> Leg:
        """Holds the trim."""
        return _without_truth(super().coast(duration))

    def perform(self, maneuver: Maneuver) -> Leg:
        """Performs a maneuver."""
        return _without_truth(super().perform(maneuver))


def _without_truth(leg: Leg) -> Leg:
    track = leg.track.copy()
    track[:, 1:] = np.nan
    return replace(leg, track=track)


def fly(policy: FlownPolicy, mission: str, seed: int, options: FlightOptions) -> FlightLog:
    task = MissionTask(find_mission(mission), LIBRARY, policy, 1.0, "gtmax", seed, flight_options=options)
    return mission_flights.fly_helicopter(task)[1]


def poison_everything(patch: pytest.MonkeyPatch) -> None:
    for name, part in (
        ("Controller", PoisonedController),
        ("ManeuverGenerator", PoisonedGenerator),
        ("Supervisor", PoisonedSupervisor),
        ("Navigation", PoisonedFilter),
    ):
        patch.setattr(simulator, name, part)
    patch.setattr(mission_flights, "SimulatedHelicopter", PoisonedLegs)


def content(log: FlightLog) -> dict[str, bytes]:
    """Returns all that was flown and decided, bit by bit."""
    series = {name: part.time.tobytes() + part.values.tobytes() for name, part in log.series.items()}
    return {**series, PLANS_ATTACHMENT: log.attachments[PLANS_ATTACHMENT]}


CASES: tuple[tuple[FlownPolicy, str, int, FlightOptions], ...] = (
    ("worst-case", "gtmax-1", 1, FLEET),
    ("nominal", "gtmax-2", 2, FLEET),
    ("adaptive-gamma", "gtmax-2", 3, FLEET),
    ("worst-case", "kinematic-1-flown", 4, FAILING),
)


@pytest.mark.parametrize(("policy", "mission", "seed", "options"), CASES)
def test_flights_without_the_truth_are_the_same_flights(
    policy: FlownPolicy, mission: str, seed: int, options: FlightOptions, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = content(fly(policy, mission, seed, options))
    poison_everything(monkeypatch)
    assert content(fly(policy, mission, seed, options)) == plain


def leak_into_controller(patch: pytest.MonkeyPatch) -> None:
    run = Controller.run

    def leaking(self: Controller) -> None:
        # One part in a thousand of the true error.
        self.signals.estimate[3] += 1e-3 * (self.signals.truth[3] - self.signals.estimate[3])
        run(self)

    patch.setattr(Controller, "run", leaking)


def leak_into_supervisor(patch: pytest.MonkeyPatch) -> None:
    run = Supervisor.run

    def leaking(self: Supervisor) -> None:
        self._estimate = simulator_truth[0]
        run(self)

    patch.setattr(Supervisor, "run", leaking)


def leak_into_arrival(patch: pytest.MonkeyPatch) -> None:
    """The closed loop judges its arrival by the true track."""
    leg = SimulatedHelicopter._leg

    def leaking(self: SimulatedHelicopter, first: int, *, settled: bool) -> Leg:
        return replace(leg(self, first, settled=settled), estimated_track=None)

    patch.setattr(SimulatedHelicopter, "_leg", leaking)


simulator_truth: list[Array] = []


@pytest.mark.parametrize("leak", [leak_into_controller, leak_into_supervisor, leak_into_arrival])
def test_a_planted_leak_of_the_truth_is_caught(
    leak: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Negative control."""

    def remember(self: Signals, made: Callable[[Signals], None] = Signals.__init__) -> None:
        made(self)
        simulator_truth[:] = [self.truth]

    monkeypatch.setattr(Signals, "__init__", remember)
    leak(monkeypatch)
    plain = content(fly(*CASES[0]))
    poison_everything(monkeypatch)
    assert content(fly(*CASES[0])) != plain
